//! Wrong input ends with code 1, wrong usage with 2, and the first line says what is wrong, where, and the mend.

mod command;

use command::{Folder, SCENE, shared_volumes};

/// Runs, and checks the exit code 1, that nothing but the error is said, and the words of its one line.
fn refused(folder: &Folder, line: &str, words: &[&str]) {
    let run = folder.run(line);
    assert_eq!(run.code, Some(1), "{line}: {}", run.err);
    assert_eq!(run.out, "", "{line}");
    for word in words {
        assert!(run.error().contains(word), "{line}: `{word}` is not in: {}", run.error());
    }
}

fn is_one_line(folder: &Folder, line: &str) {
    let err = folder.run(line).err;
    assert_eq!(err.lines().count(), 1, "{line}: {err}");
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = Folder::new();
    folder.write("empty.vdb", "");
    folder.write("empty.acc", "");
    folder.write("empty.exr", "");
    folder.write("notes.txt", "not a volume");
    folder.write("wrong.pbrt", "Camera\n\"perspective\" \"float fov\" [1\n");
    folder.write("wrong.xml", "<scene>\n<sensor>\n</scene>");
    folder.write("latin1.toml", b"unit = \"\xb5m\"");
    std::fs::create_dir(folder.path("folder.vdb")).unwrap();
    for (line, words) in [
        ("render nosuch.vdb", ["nosuch.vdb", "no such file"]),
        ("render nosuch.toml", ["nosuch.toml", "no such file"]),
        ("inspect nosuch.vdb", ["nosuch.vdb", "no such file"]),
        ("convert nosuch.vdb a.vdb", ["nosuch.vdb", "no such file"]),
        ("merge nosuch.acc -o a.exr", ["nosuch.acc", "no such file"]),
        ("diff nosuch.exr nosuch.exr", ["nosuch.exr", "no such file"]),
        ("render folder.vdb", ["folder.vdb", "folder"]),
        ("inspect folder.vdb", ["folder.vdb", "folder"]),
        ("render empty.vdb", ["empty.vdb", "empty"]),
        ("merge empty.acc -o a.exr", ["empty.acc", "no .acc file"]),
        ("diff empty.exr empty.exr", ["empty.exr", "OpenEXR"]),
        ("render notes.txt", ["notes.txt", "not a volume file"]),
        ("render empty.exr", ["empty.exr", "give a .toml scene"]),
        ("render scene.pbrt", ["scene.pbrt", "no such file"]),
        ("render latin1.toml", ["latin1.toml", "UTF-8"]),
        ("render wrong.pbrt", ["wrong.pbrt:", ""]),
        ("inspect wrong.xml", ["wrong.xml:", ""]),
        ("measure wrong.pbrt", ["wrong.pbrt:", ""]),
        ("render wrong.pbrt -D a=1", ["wrong.pbrt", "--define is for Mitsuba scenes"]),
        ("render scene.toml --strict", ["scene.toml", "--strict is for scenes of other renderers"]),
        ("inspect notes.txt -D a=1", ["notes.txt", "--define is for scenes of other renderers"]),
        ("convert nosuch.pbrt a.toml", ["nosuch.pbrt", "no such file"]),
        ("convert wrong.xml a.vdb", ["wrong.xml", "become scene files (.toml)"]),
        ("convert scene.toml a.toml", ["scene.toml", "--print-scene"]),
        ("convert wrong.pbrt a.toml --half", ["wrong.pbrt", "--half"]),
        ("inspect scene.toml --grid density", ["scene.toml", "--grid"]),
        ("render scene.toml --raw-shape 1x1x1 --raw-type uint8", ["scene.toml", "--raw-shape"]),
        ("render wrong.xml --raw-shape 1x1x1 --raw-type uint8", ["wrong.xml", "--raw-shape"]),
    ] {
        refused(&folder, line, &words);
        is_one_line(&folder, line);
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_rendering() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.exr")).unwrap();
    folder.write("a.acc", "");
    let long = "render scene.toml --spp 1000000";
    for (line, words) in [
        (format!("{long} -o no/such.exr"), ["no/such.exr", "create it"]),
        (format!("{long} -o folder.exr"), ["folder.exr", "name of a file"]),
        (format!("{long} -o a.exr --checkpoint no/such.acc"), ["no/such.acc", "create it"]),
        (format!("{long} -o a.exr --checkpoint a.acc"), ["a.acc", "--resume"]),
        ("merge a.acc -o folder.exr".into(), ["folder.exr", "name of a file"]),
        ("convert a.vdb no/such.vdb".into(), ["no/such.vdb", "create it"]),
    ] {
        refused(&folder, &line, &words);
    }
}

#[test]
fn wrong_usage_ends_with_code_2() {
    let folder = Folder::new();
    for line in [
        "rendr scene.toml",
        "render scene.toml --spp 0",
        "render scene.toml --spp 99999999999",
        "render scene.toml --samples 5..2",
        "render scene.toml --samples 0..4 --spp 4",
        "render scene.toml --resolution 0x9",
        "render scene.toml --resolution 9",
        "render scene.toml --error 0",
        "render scene.toml --time 3parsecs",
        "render scene.toml --threads 0",
        "render scene.toml --exposure nan",
        "render scene.toml --resume",
        "render scene.xml -D spp",
        "render scene.toml -o a.jpg",
        "merge -o a.exr",
        "merge a.acc",
        "diff a.exr",
        "inspect a.vdb --probe 1,2",
    ] {
        let run = folder.run(line);
        assert_eq!(run.code, Some(2), "{line}");
        assert!(run.err.starts_with("error: "), "{line}: {}", run.err);
    }
}

#[test]
fn pictures_beyond_all_memory_are_refused_before_anything_else() {
    let folder = Folder::new();
    // Such a cloud would take minutes to make.
    let long = "render scene.toml --set volume.0.procedural.resolution=2048";
    refused(&folder, &format!("{long} --resolution 65536x65536"), &["65536x65536", "268435456"]);
    refused(&folder, &format!("{long} --set film.resolution=[65536,65536]"), &["65536x65536"]);
    let cropped = "render scene.toml --set film.crop=[0,0,8,8] --resolution 64x48";
    refused(&folder, cropped, &["--resolution", "film.crop"]);
}

#[test]
fn mistakes_in_a_scene_are_shown_with_line_column_and_mend() {
    let folder = Folder::new();
    for (from, to, words) in [
        ("albedo", "albdeo", ["wrong.toml:12:1: ", "`albdeo`", "did you mean `albedo`?"]),
        ("0.9", "1.5", ["wrong.toml:12:10: ", "`albedo`", "from 0 to 1"]),
        ("mu_t = 20", "mu_t = '20'", ["wrong.toml:11:8: ", "`mu_t`", "not a string"]),
        (
            "albedo = 0.9",
            "albedo = 0.9\nmu_s = 1",
            ["wrong.toml:13:1: ", "`mu_s`", "exactly one of the pairs"],
        ),
        ("[camera]", "[camera", ["wrong.toml:2:8: ", "not TOML", "`]`"]),
        ("target = [0, 0, 0]", "target = [0, 0, 4]", ["wrong.toml:4:1: ", "`target`", "move one"]),
        ("constant", "constnat", ["wrong.toml:14:8: ", "constnat", "did you mean `constant`?"]),
    ] {
        folder.write("wrong.toml", SCENE.replacen(from, to, 1));
        refused(&folder, "render wrong.toml", &words);
        refused(&folder, "inspect wrong.toml", &words);
    }
    folder.write("wrong.toml", "[film]\nspp = 3\n");
    refused(&folder, "render wrong.toml", &["wrong.toml:"]);
    folder.write("wrong.toml", SCENE.replace("albedo", "albdeo").replace("radiance", "radience"));
    let run = folder.run("render wrong.toml");
    let errors: Vec<&str> = run.err.lines().filter(|line| line.starts_with("error: ")).collect();
    assert!(errors.len() == 2 && errors[1].contains("`radience`"), "{}", run.err);
    assert!(run.err.contains("\n  12 | albdeo = 0.9\n     | ^^^^^^\n"), "{}", run.err);
}

#[test]
fn mistakes_in_set_options_are_shown_with_the_option() {
    let folder = Folder::new();
    for (set, words) in [
        ("volume.0.mu_tt=3", ["--set volume.0.mu_tt=3", "did you mean `mu_t`?"]),
        ("camera.verticalfov=30", ["--set camera.verticalfov=30", "did you mean `vertical_fov`?"]),
        ("volume.5.mu_t=1", ["--set volume.5.mu_t=1", "counted from 0"]),
        ("volume.0.albedo=1.5", ["--set volume.0.albedo=1.5", "from 0 to 1"]),
        ("volume.0.mu_t=nan", ["--set volume.0.mu_t=nan", "finite"]),
        ("volume.0.mu_t", ["--set volume.0.mu_t", "path.to.key=value"]),
        ("=3", ["--set =3", "path.to.key=value"]),
        ("film.crop=[30,0,3,3]", ["--set film.crop=[30,0,3,3]", "no part of the 32x24 pixels"]),
        ("film.resolution=[0,9]", ["--set film.resolution=[0,9]", "from 1"]),
    ] {
        refused(&folder, &format!("render scene.toml --set {set}"), &words);
        is_one_line(&folder, &format!("render scene.toml --set {set}"));
    }
}

#[test]
fn volumes_that_a_scene_cannot_use_are_named() {
    let folder = Folder::new();
    let base = SCENE.split("[[volume]]").next().unwrap();
    let scene = |file: &str| format!("{base}\n[[volume]]\nfile = '{file}'\nmu_t = 1\nalbedo = 1\n");
    folder.write("scene.toml", scene("nosuch.vdb"));
    refused(&folder, "render scene.toml", &["nosuch.vdb", "no such file", "`file`"]);
    let Some(volumes) = shared_volumes() else { return };
    for (name, words) in [
        ("variants/vec3.vdb", ["vec3.vdb", "vectors `v`"]),
        ("arnold_pointgrid.vdb", ["arnold_pointgrid.vdb", "points"]),
        ("variants/xform_frustum.vdb", ["xform_frustum.vdb", "frustum"]),
        ("variants/bad_truncated_half.vdb", ["bad_truncated_half.vdb", "truncated"]),
        ("buckyball.raw", ["buckyball.raw", "shape"]),
    ] {
        let path = volumes.join(name);
        folder.write("scene.toml", scene(path.to_str().unwrap()));
        refused(&folder, "render scene.toml", &words);
        refused(&folder, &format!("render {}", path.display()), &words);
        is_one_line(&folder, &format!("render {}", path.display()));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_listener_that_has_gone_is_no_error_and_a_full_disk_is_one() {
    let folder = Folder::new();
    let ended = |line: &str, out: std::process::Stdio| {
        let output = folder.command(line).stdout(out).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for line in ["schema", "completions bash", "inspect scene.toml", "render scene.toml --print-scene"] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        assert_eq!(ended(line, writer.into()), (Some(0), String::new()), "{line}");
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let (code, err) = ended(line, full.into());
        assert!(code == Some(1) && err.starts_with("error: ") && err.lines().count() == 1, "{line}: {err}");
    }
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut render = folder.command("render scene.toml -o a.png --progress json");
    let writer_too = writer.try_clone().unwrap();
    assert!(render.stdout(writer).stderr(writer_too).status().unwrap().success());
    assert!(folder.path("a.png").exists());
}
