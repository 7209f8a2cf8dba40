//! Scenes as text, and what every imported scene must hold to.

use std::fs;
use std::path::Path;

use glam::DVec3;
use tempfile::TempDir;
use tyndall_import::{ImportError, Imported, NoteKind, Sidecar, import_mitsuba};
use tyndall_scene::description::{MaterialChoice, MaterialDescription, ShapeDescription};
use tyndall_scene::{SceneDescription, SceneDocument};

/// A folder with files, of which `scene.xml` is the scene.
pub struct Folder(pub TempDir);

impl Folder {
    pub fn with(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, content).unwrap();
        }
        Self(folder)
    }

    pub fn import_file(&self, name: &str, parameters: &[(&str, &str)]) -> Result<Imported, ImportError> {
        let parameters: Vec<_> = parameters.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let sidecar = Sidecar::new(self.0.path().join("sidecar"));
        import_mitsuba(&self.0.path().join(name), &sidecar, &parameters)
    }

    pub fn import_with(&self, parameters: &[(&str, &str)]) -> Result<Imported, ImportError> {
        self.import_file("scene.xml", parameters)
    }

    pub fn import(&self) -> Imported {
        let imported = self.import_with(&[]).unwrap_or_else(|error| panic!("{error}"));
        assert_sound(&imported.description);
        imported
    }
}

/// What a sensor needs.
pub const SENSOR: &str = r#"<sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><rfilter type="box"/></film></sensor>"#;

/// A scene with a usual sensor.
pub fn import(content: &str) -> Imported {
    let scene = format!("<scene version=\"3.0.0\">\n{content}\n{SENSOR}\n</scene>");
    Folder::with(&[("scene.xml", scene.as_bytes())]).import()
}

/// The one line with which a scene is refused.
pub fn refusal(content: &str) -> String {
    let scene = format!("<scene version=\"3.0.0\">\n{content}\n{SENSOR}\n</scene>");
    let folder = Folder::with(&[("scene.xml", scene.as_bytes())]);
    let error = folder.import_with(&[]).expect_err("the scene is wrong").to_string();
    assert_eq!(error.lines().count(), 1, "{error}");
    error.replace(&folder.0.path().display().to_string(), "")
}

/// The description contradicts nothing and reads back from its own file.
pub fn assert_sound(description: &SceneDescription) {
    assert_eq!(description.violations(), [], "{}", description.to_toml());
    let text = description.to_toml();
    let read = SceneDocument::parse("imported.toml", &text).and_then(|document| document.description());
    assert_eq!(read.unwrap_or_else(|error| panic!("{error}\n{text}")), *description, "{text}");
}

/// The messages of a kind of notes.
pub fn messages(imported: &Imported, kind: NoteKind) -> Vec<String> {
    imported.notes.iter().filter(|note| note.kind == kind).map(|note| note.message.clone()).collect()
}

/// Nothing at all is said.
pub fn assert_silent(imported: &Imported) {
    assert_eq!(
        imported.notes,
        [],
        "{:?}",
        imported.notes.iter().map(ToString::to_string).collect::<Vec<_>>()
    );
}

/// A .vol file: cells, channels, box, values with x fastest.
pub fn volume(cells: [i32; 3], channels: i32, corners: [[f32; 3]; 2], values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    let numbers = [1, cells[0], cells[1], cells[2], channels];
    bytes.extend(numbers.into_iter().flat_map(i32::to_le_bytes));
    bytes.extend(corners.into_iter().flatten().chain(values.iter().copied()).flat_map(f32::to_le_bytes));
    bytes
}

pub fn here(material: MaterialDescription) -> MaterialChoice {
    MaterialChoice::Here(Box::new(material))
}

pub fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    DVec3::from_array(a).distance(b.into()) < 1e-9
}

/// The direction to which a rectangle's outer side is.
pub fn rectangle_normal(shape: &ShapeDescription) -> [f64; 3] {
    let rectangle = shape.rectangle.unwrap();
    let normal = DVec3::from_array(rectangle.u).cross(rectangle.v.into()).normalize();
    (if shape.flip { -normal } else { normal }).to_array()
}

/// The benchmark's scenes, if they are there.
pub fn bench_folder() -> Option<std::path::PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/bench/mitsuba");
    if !folder.is_dir() {
        println!("skipped: there is no {}", folder.display());
        return None;
    }
    Some(folder)
}
