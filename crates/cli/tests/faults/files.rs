//! Names that stand for no file to read from or write to are refused at once, and before rendering.

use crate::command::{BALL, Folder};
use crate::refused;

/// A script that would render for hours.
const LONG: &str = "exec tyndall render scene.toml --spp 100000000";

#[test]
fn outputs_that_cannot_be_made_are_refused_before_rendering() {
    let folder = Folder::new();
    folder.write("kept.exr", "old");
    let mut permissions = folder.path("kept.exr").metadata().unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(folder.path("kept.exr"), permissions).unwrap();
    std::os::unix::fs::symlink(folder.path("scene.toml"), folder.path("link.acc")).unwrap();
    std::fs::create_dir(folder.path("0001")).unwrap();
    for (options, words) in [
        ("-o kept.exr", "kept.exr: is there and read-only"),
        ("-o a.exr -o ./a.exr", "./a.exr: is to be written twice"),
        ("-o a.acc --checkpoint a.acc", "a.acc: is to be written twice"),
        ("-o link.acc", "link.acc: is read as well"),
        ("-o a.exr --checkpoint link.acc --resume", "link.acc: is read as well"),
        ("--set render.seed=# --frames 1..3 -o '####/a.exr'", "0002/a.exr: its folder does not exist"),
        ("--set render.seed=# --frames 1..2 -o a.exr --checkpoint no/c.acc", "its folder does not exist"),
    ] {
        let error = refused(&folder, &format!("{LONG} {options}"));
        assert!(error.contains(words), "{options}: {error}");
    }
    assert_eq!(folder.read("kept.exr"), b"old");
    assert!(folder.names().iter().all(|name| !name.starts_with('.')), "{:?}", folder.names());
}

#[test]
fn a_volume_is_not_converted_into_itself_nor_rendered_over() {
    let folder = Folder::new();
    folder.write("v_8x8x8_uint8.raw", [1; 512]);
    folder.done("convert v_8x8x8_uint8.raw v.npy");
    let error = refused(&folder, "exec tyndall convert v.npy ./v.npy");
    assert!(error.contains("./v.npy: is read as well"), "{error}");
    folder.write("light.exr", "a picture");
    folder.write("scene.toml", BALL.replace("\"constant\", radiance = 1", "\"image\", file = \"light.exr\""));
    let error = refused(&folder, &format!("{LONG} -o light.exr"));
    assert!(error.contains("light.exr: is read as well"), "{error}");
}

#[test]
fn pipes_devices_and_folders_are_refused_and_never_waited_for() {
    let folder = Folder::new();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap();
    assert!(made.success());
    std::fs::create_dir(folder.path("folder")).unwrap();
    for (target, words) in
        [("pipe", "a pipe or a device"), ("/dev/zero", "a pipe or a device"), ("folder", "is a folder")]
    {
        for extension in
            ["vdb", "nvdb", "npy", "raw", "toml", "pbrt", "xml", "acc", "exr", "ply", "obj", "png"]
        {
            let link = folder.path(&format!("in.{extension}"));
            std::os::unix::fs::symlink(target, &link).unwrap();
        }
        let ball = |key: &str| BALL.replace("sphere = { center = [0, 0, 0], radius = 1 }", key);
        let shape = |mesh: &str| {
            format!("{BALL}shape = [{{ mesh = {{ file = '{mesh}' }}, material = {{ type = 'diffuse' }} }}]\n")
        };
        folder.write("volume.toml", ball("file = 'in.vdb'"));
        folder.write("light.toml", BALL.replace("\"constant\", radiance = 1", "\"image\", file = 'in.exr'"));
        folder.write("ply.toml", shape("in.ply"));
        folder.write("obj.toml", shape("in.obj"));
        folder.write(
            "phase.toml",
            BALL.replace("mu_t = 4", "mu_t = 4, phase = { type = 'tabulated', file = 'in.acc' }"),
        );
        folder.write("include.pbrt", "Include \"in.pbrt\"\n");
        folder.write("include.xml", "<scene version='3.0.0'><include filename='in.xml'/></scene>");
        for line in [
            "render in.vdb",
            "render in.toml",
            "render in.pbrt",
            "render in.xml",
            "render volume.toml",
            "render light.toml",
            "render ply.toml",
            "render obj.toml",
            "render phase.toml",
            "render include.pbrt",
            "inspect in.nvdb",
            "inspect in.npy",
            "convert in.raw a.vdb",
            "merge in.acc -o a.exr",
            "diff in.exr in.exr",
        ] {
            let error = refused(&folder, &format!("exec tyndall {line}"));
            assert!(error.contains(words), "{target}, {line}: {error}");
        }
        // Mitsuba looks for files in several folders, and passes by what is none.
        assert!(refused(&folder, "exec tyndall render include.xml").contains("there is no file `in.xml`"));
        for name in folder.names().iter().filter(|name| name.starts_with("in.")) {
            std::fs::remove_file(folder.path(name)).unwrap();
        }
    }
}

#[test]
fn files_that_include_each_other_are_told_in_a_row() {
    let folder = Folder::new();
    folder.write("a.pbrt", "Include \"b.pbrt\"\n");
    folder.write("b.pbrt", "\nInclude \"c.pbrt\"\n");
    folder.write("c.pbrt", "Import \"./b.pbrt\"\n");
    let error = refused(&folder, "exec tyndall render a.pbrt");
    assert!(error.contains("c.pbrt:1: b.pbrt -> c.pbrt -> b.pbrt: the file includes itself"), "{error}");
    let scene = |file: &str| format!("<scene version='3.0.0'>\n<include filename='{file}'/>\n</scene>");
    folder.write("a.xml", scene("b.xml"));
    folder.write("b.xml", scene("a.xml"));
    let error = refused(&folder, "exec tyndall render a.xml");
    assert!(error.contains("b.xml:2: a.xml -> b.xml -> a.xml: the file includes itself"), "{error}");
}

#[test]
fn a_file_is_looked_for_where_the_scene_says_and_nowhere_else() {
    let folder = Folder::new();
    for name in ["inner", "other"] {
        std::fs::create_dir(folder.path(name)).unwrap();
    }
    folder.write("v_8x8x8_uint8.raw", [1; 512]);
    folder.done("convert v_8x8x8_uint8.raw other/v.npy");
    let scene =
        |file: &str| BALL.replace("sphere = { center = [0, 0, 0], radius = 1 }", &format!("file = '{file}'"));
    folder.write("inner/up.toml", scene("../other/v.npy"));
    folder.write("inner/absolute.toml", scene(folder.path("other/v.npy").to_str().unwrap()));
    folder.done("inspect inner/up.toml");
    folder.done("inspect inner/absolute.toml");
    for name in ["v.npy", "~/v.npy", "$HOME/v.npy", "other/v.npy", "../other/*.npy"] {
        folder.write("inner/scene.toml", scene(name));
        let script = format!("HOME={} exec tyndall render inner/scene.toml", folder.path("other").display());
        let error = refused(&folder, &script);
        assert!(error.contains("no such file"), "{name}: {error}");
    }
}
