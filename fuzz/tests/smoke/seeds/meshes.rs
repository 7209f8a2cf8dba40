//! Meshes: polygon files in both byte orders. (Those in text are written by hand.)

use super::put;

const HEADER: &str = "element vertex 5\nproperty float x\nproperty float y\nproperty double z\nproperty float nx\n\
    property float ny\nproperty float nz\nproperty float u\nproperty float v\nelement face 2\n\
    property list uchar int vertex_indices\nproperty uchar flags\nelement edge 1\nproperty list ushort short ends\n\
    end_header\n";

pub fn write_all() {
    put("ply", "little.ply", &binary(false));
    put("ply", "big.ply", &binary(true));
}

fn binary(is_big: bool) -> Vec<u8> {
    let format = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = format!("ply\nformat {format} 1.0\n{HEADER}").into_bytes();
    let mut push = |number: &[u8]| {
        let mut number = number.to_vec();
        if is_big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for [x, y, z] in [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]] {
        push(&x.to_le_bytes());
        push(&y.to_le_bytes());
        push(&f64::from(z).to_le_bytes());
        [0.0, 0.0, 1.0, x, y].iter().for_each(|number: &f32| push(&number.to_le_bytes()));
    }
    for face in [&[3, 2, 1, 0][..], &[0, 1, 4]] {
        push(&[face.len() as u8]);
        face.iter().for_each(|index: &i32| push(&index.to_le_bytes()));
        push(&[7]);
    }
    push(&2u16.to_le_bytes());
    [0i16, 4].iter().for_each(|index| push(&index.to_le_bytes()));
    bytes
}
