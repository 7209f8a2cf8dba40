//! Mesh files: what is read from them, and what is said of files that are damaged.

use std::fs;
use std::path::Path;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::surface::{Mesh, read_mesh, write_ply};

/// A pyramid over a unit square: a quadrilateral and four triangles.
const ASCII: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 5\nproperty float x\nproperty float y\n\
property float z\nproperty uchar red\nelement face 5\nproperty list uchar int vertex_indices\nelement edge 1\n\
property int vertex1\nend_header\n0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n0.5 0.5 1 9\n4 3 2 1 0\n3 0 1 4\n3 1 2 4\n\
3 2 3 4\n3 3 0 4\n7\n";

const OBJ: &str = "# by hand\nmtllib a.mtl\no pyramid\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nusemtl stone\n\
s off\nf 4 3 2 1\nf 1 2 5\nf -4 -3 \\\n -1\nf 3 4 5\nf 4 1 5 # the last\n";

fn pyramid() -> Mesh {
    let base = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut positions: Vec<DVec3> = base.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    positions.push(DVec3::new(0.5, 0.5, 1.0));
    let triangles = vec![[3, 2, 1], [3, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    Mesh { positions, triangles, ..Mesh::default() }
}

/// The same in binary, of one byte order or the other.
fn binary(is_big: bool) -> Vec<u8> {
    let header = ASCII.split_inclusive("end_header\n").next().unwrap();
    let format = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = header.replace("ascii", format).into_bytes();
    let mut push = |number: &[u8]| {
        let mut number = number.to_vec();
        if is_big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for position in pyramid().positions {
        position.to_array().iter().for_each(|x| push(&(*x as f32).to_le_bytes()));
        push(&[9]);
    }
    for face in [&[3, 2, 1, 0][..], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]] {
        push(&[face.len() as u8]);
        face.iter().for_each(|index: &i32| push(&index.to_le_bytes()));
    }
    push(&7_i32.to_le_bytes());
    bytes
}

/// What is read from a file of this name and content, with its notes; or the message.
fn read(name: &str, bytes: &[u8]) -> Result<(Mesh, Vec<String>), String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    let without_folder = |message: String| message.replace(&format!("{}/", folder.path().display()), "");
    let mut notes = Vec::new();
    match read_mesh(&path, &mut notes) {
        Ok(mesh) => Ok((mesh, notes.into_iter().map(without_folder).collect())),
        Err(error) => Err(without_folder(error.to_string())),
    }
}

/// The triangles by the places of their corners.
fn corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    mesh.triangles.iter().map(|triangle| triangle.map(|corner| mesh.positions[corner as usize])).collect()
}

#[test]
fn text_and_both_byte_orders_are_the_same_mesh() {
    for bytes in [ASCII.as_bytes(), &binary(false), &binary(true)] {
        assert_eq!(read("a.ply", bytes), Ok((pyramid(), vec![])));
    }
    assert_eq!(read("a.PLY", ASCII.replace('\n', "\r\n").as_bytes()).unwrap().0, pyramid());
}

#[test]
fn an_obj_file_is_the_same_mesh() {
    let (mesh, notes) = read("a.obj", OBJ.as_bytes()).unwrap();
    assert_eq!(corners(&mesh), corners(&pyramid()));
    assert_eq!(notes, ["a.obj: the materials that the file names are not read: the shape's is used"]);
}

#[test]
fn corners_of_an_obj_file_that_differ_in_normal_are_different_vertices() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 0 1 0\nvt 0 0.25\nf 1/1/1 2/1/1 3/1/1\nf 1/1/2 4/1/2 2/1/2\n";
    let (mesh, notes) = read("a.obj", text.as_bytes()).unwrap();
    assert_eq!((mesh.positions.len(), notes.len()), (6, 0));
    assert_eq!(mesh.normals.unwrap()[0], DVec3::Z);
    assert_eq!(mesh.uvs.unwrap(), vec![[0.0, 0.25]; 6]);
    let (mesh, notes) = read("a.obj", text.replace("4/1/2", "4").as_bytes()).unwrap();
    assert_eq!((mesh.normals, mesh.uvs, notes.len()), (None, None, 2));
}

#[test]
fn what_is_written_reads_back_identically() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    for (normals, uvs) in [(false, false), (true, false), (false, true), (true, true)] {
        let mesh = Mesh {
            normals: normals.then(|| vec![DVec3::new(0.6, 0.0, 0.8); 5]),
            uvs: uvs.then(|| (0..5).map(|n| [0.1 * f64::from(n), 1.0 / 3.0]).collect()),
            ..pyramid()
        };
        write_ply(&path, &mesh).unwrap();
        assert_eq!(read_mesh(&path, &mut Vec::new()).unwrap(), mesh);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
    let error = write_ply(&folder.path().join("no/a.ply"), &pyramid()).unwrap_err().to_string();
    assert!(error.contains("no/a.ply: cannot be written: "), "{error}");
}

#[test]
fn every_damage_is_one_line_that_says_where() {
    let ply = |from: &str, to: &str| ("a.ply", ASCII.replacen(from, to, 1));
    let obj = |from: &str, to: &str| ("a.obj", OBJ.replacen(from, to, 1));
    let cases = [
        (ply("ply", "plx"), "a.ply: is not a PLY file: its first line is not `ply`"),
        (ply("end_header", "end"), "a.ply: line 13 of the header is not understood: `end`"),
        (ply("ascii", "morse"), "a.ply: line 2 of the header names an unknown format: `format morse 1.0`"),
        (
            ply("float x", "half x"),
            "a.ply: line 5 of the header has a property of an unknown type: `property half x`",
        ),
        (
            ply("vertex 5", "vertex many"),
            "a.ply: line 4 of the header has no number of elements: `element vertex many`",
        ),
        (ply("float x", "float q"), "a.ply: the element `vertex` lacks one of x, y, z"),
        (ply("vertex_indices", "corners"), "a.ply: the element `face` lacks the list `vertex_indices`"),
        (ply("1 0 0 9", "1 zero 0 9"), "a.ply: `zero` is not a number in `vertex` 1 (from 0) of 5"),
        (
            ply("1 0 0 9", "1 nan 0 9"),
            "a.ply: vertex 1 (from 0) is at [1, NaN, 0]: coordinates must be finite and at most 1e30",
        ),
        (
            ply("3 0 1 4", "3 0 1 5"),
            "a.ply: triangle 2 (from 0) names vertex 5, but the 5 vertices are numbered from 0",
        ),
        (ply("3 0 1 4", "3 0 1 -4"), "a.ply: face 1 (from 0) names vertex -4, and there is none such"),
        (ply("3 0 1 4", "3.5 0 1 4"), "a.ply: a list has the length 3.5 in `face` 1 (from 0) of 5"),
        (ply("edge 1", "edge 999999999999"), "a.ply: the file ends in `edge` 1 (from 0) of 999999999999"),
        (
            ply("element face 5", "element tristrips 5"),
            "a.ply: holds strips of triangles (`tristrips`): export it with faces instead",
        ),
        (
            ply("element face 5", "element edges 5"),
            "a.ply: has no element `face`: it is a cloud of points, not a mesh",
        ),
        (
            obj("f 1 2 5", "f 1 2 6"),
            "a.obj: line 12: `6` is none of the 5 vertices before it, which count from 1",
        ),
        (
            obj("f 1 2 5", "f 1 2 0"),
            "a.obj: line 12: `0` is none of the 5 vertices before it, which count from 1",
        ),
        (
            obj("f 1 2 5", "f 1 2 5/1"),
            "a.obj: line 12: `1` is none of the 0 texture coordinates before it, which count from 1",
        ),
        (obj("v 1 1 0", "v 1 1"), "a.obj: line 6: a number is missing"),
        (
            ("a.obj", "v 0 0 0\n".to_owned()),
            "a.obj: has no triangle that has an area: nothing of it can be seen",
        ),
        (
            ("a.stl", "solid".to_owned()),
            "a.stl: is no mesh by its name: meshes are read from .ply and .obj files",
        ),
        (("a.glb", "glTF".to_owned()), "a.glb: glTF is not read: export the mesh as .ply, binary, or .obj"),
    ];
    for ((name, text), message) in cases {
        assert_eq!(read(name, text.as_bytes()).unwrap_err(), message);
    }
    let error = read_mesh(Path::new("no/such.ply"), &mut Vec::new()).unwrap_err().to_string();
    assert_eq!(
        error,
        "no/such.ply: there is no such file; mend the key `file`, which is relative to the scene file"
    );
    let few = ASCII.replacen("3 0 1 4", "2 0 1", 1);
    assert_eq!(
        read("a.ply", few.as_bytes()).unwrap().1,
        ["a.ply: 1 face has fewer than 3 corners and is left out"]
    );
}

/// Whatever is changed or cut off leads to a mesh or to one line.
#[test]
fn no_damage_makes_reading_panic() {
    let mut random = Random::new(3, 0, 0);
    for (name, sound) in
        [("a.ply", ASCII.as_bytes().to_vec()), ("a.ply", binary(false)), ("a.obj", OBJ.as_bytes().to_vec())]
    {
        for _ in 0..2000 {
            let mut bytes = sound.clone();
            for _ in 0..1 + random.bits() % 3 {
                let at = (random.bits() % bytes.len() as u64) as usize;
                match random.bits() % 4 {
                    0 => bytes.truncate(at + 1),
                    1 => bytes[at] = random.bits() as u8,
                    2 => bytes[at] = b'9',
                    _ => bytes.insert(at, b'9'),
                }
            }
            if let Err(message) = read(name, &bytes) {
                assert!(message.starts_with(name) && !message.contains('\n'), "{message}");
            }
        }
    }
}
