//! What is said of shapes that are wrong.

use tyndall_scene::SceneDocument;

fn problems(text: &str) -> Vec<String> {
    let camera = "camera = { position = [0, 0, 5], target = [0, 0, 0] }\n";
    let material =
        "[[material]]\nname = 'grey'\ntype = 'diffuse'\n[[material]]\nname = 'nothing'\ntype = 'null'\n";
    let document = SceneDocument::parse("scene.toml", &format!("{camera}{material}{text}")).unwrap();
    document.description().unwrap_err().problems().iter().map(ToString::to_string).collect()
}

/// Text after the eight lines above and the beginning of a shape, and the one problem that it has.
#[test]
fn every_mistake_in_a_shape_is_named_with_its_place_and_mend() {
    let ball = "sphere = { center = [0, 0, 0], radius = 1 }";
    let cases = [
        (
            "".to_owned(),
            "8:1: the shape is nowhere: give one of `mesh`, `sphere`, `box`, `rectangle`, `disc`, `cylinder`, `plane`",
        ),
        (
            format!("{ball}\nbox = {{ min = [0, 0, 0], max = [1, 1, 1] }}"),
            "11:1: the shape has both `sphere` and `box`: keep one, or write two [[shape]] tables",
        ),
        (
            "sphere = { center = [0, 0, 0] }".to_owned(),
            "10:10: `sphere` lacks `radius`: give a number above 0",
        ),
        ("shpere = 1".to_owned(), "10:1: unknown key `shpere` in [[shape]], did you mean `sphere`?"),
        (
            "box = { min = [0, 0, 0], max = [1, 0, 1] }".to_owned(),
            "10:1: `box` is empty: each number of `min` must be less than that of `max`",
        ),
        (
            "rectangle = { corner = [0, 0, 0], u = [1, 2, 3], v = [2, 4, 6] }".to_owned(),
            "10:1: `rectangle` has no area: `u` and `v` must point different ways",
        ),
        (
            "disc = { center = [0, 0, 0], normal = [0, 0, 0], radius = 1 }".to_owned(),
            "10:30: `normal` is a direction and must not be [0, 0, 0]",
        ),
        (
            "disc = { center = [0, 0, 0], normal = [0, 0, 1], radius = 1, inner_radius = 1 }".to_owned(),
            "10:62: `inner_radius` must be less than `radius`",
        ),
        (
            "cylinder = { from = [0, 0, 1], to = [0, 0, 1], radius = 1 }".to_owned(),
            "10:1: `cylinder` has no length: `from` and `to` must differ",
        ),
        (
            "plane = { point = [0, 0, 1], normal = [0, 0, 0] }".to_owned(),
            "10:30: `normal` is a direction and must not be [0, 0, 0]",
        ),
        (
            "mesh = { flat = true }".to_owned(),
            "10:1: the mesh has no triangles: give a `file`, or `vertices` and `triangles`",
        ),
        (
            "mesh = { file = 'a.ply', vertices = [[0, 0, 0]] }".to_owned(),
            "10:26: the mesh has both `file` and `vertices`: keep one",
        ),
        (
            "mesh = { vertices = [[0, 0, 0], [1, 0, 0]], triangles = [[0, 1, 2]] }".to_owned(),
            "10:45: `triangles`: there is no vertex 2, the 2 are numbered from 0",
        ),
        (
            "mesh = { vertices = [[0, 0, 0], [1, 0, 0]], triangles = [[0, 1, 1]], uvs = [[0, 0]] }"
                .to_owned(),
            "10:70: `uvs` are one for each vertex: 2, not 1",
        ),
        (
            format!("{ball}\ntransform = {{ scale = 0 }}"),
            "11:15: `scale` makes the shape flat: no factor may be 0",
        ),
        (
            format!("{ball}\ninstances = [{{ scale = 0 }}]"),
            "11:16: `scale` makes the shape flat: no factor may be 0",
        ),
        (
            format!("{ball}\ninterior = 'milk'"),
            "11:1: `interior`: there is no volume `milk`, nor any with a name: add a [[volume]] with `name = \"milk\"`",
        ),
        (
            format!("{ball}\nexterior = 'medum'\n[medium]\nmu_t = 1\nalbedo = 1"),
            "11:1: `exterior`: there is no volume `medum`, did you mean `medium`?",
        ),
        (
            format!("{ball}\ninterior = 'a'\n{0}{0}", "[[volume]]\nname = 'a'\nmu_t = 1\nalbedo = 1\n"),
            "11:1: `interior`: several volumes are named `a`: give each its own name",
        ),
        (format!("{ball}\nid = 0"), "11:6: `id` must be an integer from 1 to 16777215, not 0"),
    ];
    for (text, expected) in cases {
        let found = problems(&format!("[[shape]]\nmaterial = 'grey'\n{text}"));
        assert_eq!(found, [format!("scene.toml:{expected}")], "of {text}");
    }
    let lamp = "emission = { radiance = 1 }";
    let without = problems(&format!("[[shape]]\n{ball}"));
    assert!(
        without.len() == 1 && without[0].starts_with("scene.toml:8:1: the shape has no `material`: give"),
        "{without:?}"
    );
    for nothing in ["'nothing'", "{ type = 'null' }"] {
        let found = problems(&format!("[[shape]]\n{ball}\nmaterial = {nothing}\n{lamp}"));
        assert_eq!(
            found,
            ["scene.toml:11:1: a surface of `null` is not there, and cannot shine: give another `material`"]
        );
    }
    let unknown = problems(&format!("[[shape]]\n{ball}\nmaterial = 'gray'"));
    assert!(unknown.len() == 1 && unknown[0].ends_with("did you mean `grey`?"), "{unknown:?}");
}
