//! Arrays in `.vol`, `.npy`, `.raw` and NIfTI files become the same voxels whatever their type and order.

use std::io::Write;
use std::path::Path;

use glam::{DAffine3, DVec3};
use half::f16;
use tyndall_volumes::{
    AxisOrder, ByteOrder, Element, Format, Grid, GridValues, RawShape, ReadRequest, read, read_bytes,
};

use crate::facts::{float, shared};

/// Voxels along x, y, z: no two alike, one more than a leaf, one less.
const SHAPE: [usize; 3] = [9, 7, 11];

/// The number at voxel (x, y, z): exact in every element type.
fn number(x: usize, y: usize, z: usize) -> f64 {
    ((x * 31 + y * 17 + z * 7) % 101) as f64
}

fn encode(number: f64, element: Element, order: ByteOrder) -> Vec<u8> {
    let mut bytes = match element {
        Element::Float16 => f16::from_f64(number).to_le_bytes().to_vec(),
        Element::Float32 => (number as f32).to_le_bytes().to_vec(),
        Element::Float64 => number.to_le_bytes().to_vec(),
        Element::UInt8 => vec![number as u8],
        Element::UInt16 => (number as u16).to_le_bytes().to_vec(),
        Element::UInt32 => (number as u32).to_le_bytes().to_vec(),
        Element::Int8 => vec![number as i8 as u8],
        Element::Int16 => (number as i16).to_le_bytes().to_vec(),
        Element::Int32 => (number as i32).to_le_bytes().to_vec(),
        Element::Bool => vec![u8::from(number != 0.0)],
    };
    if order == ByteOrder::Big {
        bytes.reverse();
    }
    bytes
}

/// The voxels of [`SHAPE`] in the given order.
fn voxels(order: AxisOrder) -> Vec<[usize; 3]> {
    let [nx, ny, nz] = SHAPE;
    let mut all = Vec::new();
    match order {
        AxisOrder::XFastest => {
            (0..nz).for_each(|z| (0..ny).for_each(|y| (0..nx).for_each(|x| all.push([x, y, z]))))
        }
        AxisOrder::ZFastest => {
            (0..nx).for_each(|x| (0..ny).for_each(|y| (0..nz).for_each(|z| all.push([x, y, z]))))
        }
    }
    all
}

fn array(element: Element, bytes: ByteOrder, axes: AxisOrder) -> Vec<u8> {
    voxels(axes).into_iter().flat_map(|[x, y, z]| encode(number(x, y, z), element, bytes)).collect()
}

fn npy(descr: &str, fortran: bool, shape: &str, version: u8, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut file = b"\x93NUMPY".to_vec();
    file.extend([version, 0]);
    match version {
        1 => file.extend((header.len() as u16).to_le_bytes()),
        _ => file.extend((header.len() as u32).to_le_bytes()),
    }
    file.extend(header.as_bytes());
    file.extend(data);
    file
}

fn vol(encoding: i32, channels: i32, data: &[u8]) -> Vec<u8> {
    let mut file = b"VOL\x03".to_vec();
    file.extend(encoding.to_le_bytes());
    SHAPE.iter().for_each(|&edge| file.extend((edge as i32).to_le_bytes()));
    file.extend(channels.to_le_bytes());
    [-1.0f32, 0.0, 2.0, 8.0, 14.0, 13.0].iter().for_each(|corner| file.extend(corner.to_le_bytes()));
    file.extend(data);
    file
}

#[track_caller]
fn one(bytes: &[u8], name: &str) -> Grid {
    let file =
        read_bytes(bytes, Path::new(name), &ReadRequest::default()).unwrap_or_else(|error| panic!("{error}"));
    let [grid] = file.grids.try_into().expect("one grid");
    grid
}

#[track_caller]
fn refusal(bytes: &[u8], name: &str) -> String {
    let error = read_bytes(bytes, Path::new(name), &ReadRequest::default()).expect_err("refused").to_string();
    assert!(!error.contains('\n'), "{error}");
    error
}

/// Every voxel has its number times `factor`, and the array alone is active.
#[track_caller]
fn assert_numbers(grid: &Grid, factor: f64) {
    let statistics = grid.values.statistics();
    assert_eq!(statistics.active_voxels, 9 * 7 * 11);
    assert_eq!(statistics.active_bbox, Some([[0; 3], SHAPE.map(|edge| edge as i32 - 1)]));
    let all = voxels(AxisOrder::XFastest);
    let probes: Vec<_> = all.iter().map(|voxel| voxel.map(|index| index as i32)).collect();
    for ([x, y, z], (value, active)) in all.iter().zip(grid.values.probe(&probes)) {
        let expected = number(*x, *y, *z) * factor;
        assert!(
            active && (value[0] - expected).abs() <= 1e-6 * expected,
            "{value:?} at {x} {y} {z}: {expected}"
        );
    }
    assert_eq!(grid.values.probe(&[[9, 0, 0], [-1, 0, 0]]), [(vec![0.0], false), (vec![0.0], false)]);
}

const ELEMENTS: [(Element, &str); 9] = [
    (Element::Float16, "f2"),
    (Element::Float32, "f4"),
    (Element::Float64, "f8"),
    (Element::UInt8, "u1"),
    (Element::UInt16, "u2"),
    (Element::UInt32, "u4"),
    (Element::Int8, "i1"),
    (Element::Int16, "i2"),
    (Element::Int32, "i4"),
];

#[test]
fn numpy_arrays_of_every_type_order_and_version_are_indexed_x_y_z() {
    for (element, kind) in ELEMENTS {
        for (bytes, sign) in [(ByteOrder::Little, '<'), (ByteOrder::Big, '>')] {
            for (axes, fortran) in [(AxisOrder::ZFastest, false), (AxisOrder::XFastest, true)] {
                for version in 1..=3 {
                    let file = npy(
                        &format!("{sign}{kind}"),
                        fortran,
                        "(9, 7, 11)",
                        version,
                        &array(element, bytes, axes),
                    );
                    let grid = one(&file, "a.npy");
                    assert_numbers(&grid, 1.0);
                    assert_eq!(grid.index_to_world, DAffine3::IDENTITY);
                    assert_eq!(matches!(grid.values, GridValues::Float(_)), element.fits_f32());
                }
            }
        }
    }
}

#[test]
fn numpy_arrays_with_a_last_axis_of_three_are_vectors_in_either_order() {
    let component = |c: usize| if c == 0 { 1.0 } else { -(c as f64) };
    let c_order: Vec<u8> = voxels(AxisOrder::ZFastest)
        .into_iter()
        .flat_map(|[x, y, z]| (0..3).map(move |c| (number(x, y, z) * component(c)) as f32))
        .flat_map(f32::to_be_bytes)
        .collect();
    let fortran: Vec<u8> = (0..3)
        .flat_map(|c| {
            voxels(AxisOrder::XFastest).into_iter().map(move |[x, y, z]| number(x, y, z) * component(c))
        })
        .flat_map(f64::to_le_bytes)
        .collect();
    for file in
        [npy(">f4", false, "(9, 7, 11, 3)", 1, &c_order), npy("<f8", true, "(9, 7, 11, 3)", 1, &fortran)]
    {
        let grid = one(&file, "a.npy");
        let GridValues::Vec3(tree) = &grid.values else { panic!("not vectors") };
        for [x, y, z] in voxels(AxisOrder::XFastest) {
            let n = number(x, y, z) as f32;
            assert_eq!(tree.probe([x, y, z].map(|index| index as i32)), ([n, -n, -2.0 * n], true));
        }
    }
}

#[test]
fn arrays_that_are_no_volumes_are_refused_with_the_mend() {
    let file = npy("<f4", false, "(9, 7)", 1, &[0; 252]);
    assert!(
        refusal(&file, "a.npy")
            .contains("an array of 2 axes [9, 7] is no volume; save one of shape (X, Y, Z)")
    );
    let file = npy("<c8", false, "(9, 7, 11)", 1, &[0; 8 * 693]);
    assert!(
        refusal(&file, "a.npy").contains("type `<c8` are not read; save the array with .astype('float32')")
    );
    let file = npy("<f4", false, "(9, 7, 11)", 1, &[0; 4 * 692]);
    assert!(
        refusal(&file, "a.npy").ends_with("9 x 7 x 11 voxels take 2772 bytes, the file has 2768 for them")
    );
    let file = npy("<f4", false, "(4611686018427387904, 4, 4)", 1, &[0; 16]);
    assert!(refusal(&file, "a.npy").contains("too large for any memory"));
    let file = npy("<f4", false, "(0, 7, 11)", 1, &[]);
    assert!(refusal(&file, "a.npy").contains("has none at all"));
    let file = npy("|u1", false, "(1, 1, 4000000)", 1, &[7; 4_000_000]);
    assert!(refusal(&file, "a.npy").contains("too thin to be a volume"));
    assert!(refusal(b"", "a.npy").ends_with("the file is empty"));
    assert!(
        refusal(b"PK\x03\x04", "a.npy")
            .contains("not a file of the format NumPy array, in spite of its name")
    );
}

#[test]
fn mitsuba_volumes_stand_in_their_box_with_cell_centres_inside() {
    for (encoding, element, factor) in
        [(1, Element::Float32, 1.0), (2, Element::Float16, 1.0), (3, Element::UInt8, 1.0 / 255.0)]
    {
        let grid = one(&vol(encoding, 1, &array(element, ByteOrder::Little, AxisOrder::XFastest)), "a.vol");
        assert_numbers(&grid, factor);
        // Cells of 1 x 2 x 1 from (-1, 0, 2) on.
        let centre = |index: [f64; 3]| grid.index_to_world.transform_point3(DVec3::from_array(index));
        assert!(centre([0.0; 3]).abs_diff_eq(DVec3::new(-0.5, 1.0, 2.5), 1e-12));
        assert!(centre([8.0, 6.0, 10.0]).abs_diff_eq(DVec3::new(7.5, 13.0, 12.5), 1e-12));
    }
    let colours: Vec<u8> = voxels(AxisOrder::XFastest)
        .into_iter()
        .flat_map(|[x, y, z]| [number(x, y, z) as u8, 255, 0])
        .collect();
    let grid = one(&vol(3, 3, &colours), "a.vol");
    let GridValues::Vec3(tree) = &grid.values else { panic!("not vectors") };
    assert_eq!(tree.probe([3, 2, 1]), ([number(3, 2, 1) as f32 / 255.0, 1.0, 0.0], true));
    assert!(refusal(&vol(4, 3, &[]), "a.vol").contains("quantised directions"));
    assert!(refusal(&vol(1, 2, &[]), "a.vol").contains("2 channels"));
}

#[test]
fn raw_numbers_take_their_shape_from_the_request_or_the_name() {
    let data = array(Element::UInt16, ByteOrder::Big, AxisOrder::XFastest);
    assert_numbers(&one(&data, "bone_9x7x11_uint16_be.raw"), 1.0);
    for axes in [AxisOrder::XFastest, AxisOrder::ZFastest] {
        let data = array(Element::Int32, ByteOrder::Little, axes);
        let raw = RawShape {
            shape: SHAPE,
            element: Element::Int32,
            byte_order: ByteOrder::Little,
            axis_order: axes,
        };
        let request = ReadRequest { raw: Some(raw), ..ReadRequest::default() };
        let file = read_bytes(&data, Path::new("nameless"), &request).expect("readable");
        assert_eq!(file.format, Format::Raw);
        assert_numbers(&file.grids[0], 1.0);
    }
    assert!(refusal(&data, "bone.raw").contains("a .raw file does not say its shape; give shape and type"));
    let error = refusal(&data[1..], "bone_9x7x11_uint16.raw");
    assert!(
        error.contains("make 1386 bytes, but the file has 1385; check the shape and the type"),
        "{error}"
    );
}

#[test]
fn the_buckyball_is_32_voxels_wide() {
    let Some(path) = shared("volumes/buckyball.raw") else { return };
    let raw = RawShape {
        shape: [32; 3],
        element: Element::UInt8,
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
    };
    let file = read(&path, &ReadRequest { raw: Some(raw), ..ReadRequest::default() }).expect("readable");
    let bytes = std::fs::read(&path).expect("readable");
    let statistics = file.grids[0].values.statistics();
    assert_eq!(statistics.active_voxels, 32_768);
    assert_eq!(statistics.sum[0], bytes.iter().map(|&byte| f64::from(byte)).sum::<f64>());
    assert_eq!(float(&file.grids[0]).probe([3, 17, 9]).0, f32::from(bytes[(9 * 32 + 17) * 32 + 3]));
}

/// A NIfTI file of the given version and byte order, with what `edit` puts into its header.
fn nifti(version: u8, order: ByteOrder, datatype: i16, edit: impl Fn(&mut Nifti), data: &[u8]) -> Vec<u8> {
    let length = if version == 1 { 352 } else { 544 };
    let mut file = Nifti { bytes: vec![0; length], version, order };
    file.int(0, 4, length as i64 - 4);
    let magic: &[u8] = if version == 1 { b"n+1\0" } else { b"n+2\0\r\n\x1a\n" };
    let at = if version == 1 { 344 } else { 4 };
    file.bytes[at..at + magic.len()].copy_from_slice(magic);
    for (n, count) in [3, 9, 7, 11, 1].into_iter().enumerate() {
        file.dim(n, count);
    }
    file.field((70, 2), (12, 2), i64::from(datatype));
    file.float(108, 168, length as f64);
    if version == 2 {
        file.int(168, 8, length as i64);
    }
    edit(&mut file);
    file.bytes.extend(data);
    file.bytes
}

struct Nifti {
    bytes: Vec<u8>,
    version: u8,
    order: ByteOrder,
}

impl Nifti {
    fn put(&mut self, at: usize, mut bytes: Vec<u8>) {
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        self.bytes[at..at + bytes.len()].copy_from_slice(&bytes);
    }
    fn int(&mut self, at: usize, size: usize, value: i64) {
        self.put(at, value.to_le_bytes()[..size].to_vec());
    }
    fn field(&mut self, (at_1, size_1): (usize, usize), (at_2, size_2): (usize, usize), value: i64) {
        if self.version == 1 { self.int(at_1, size_1, value) } else { self.int(at_2, size_2, value) }
    }
    fn dim(&mut self, n: usize, count: i64) {
        self.field((40 + 2 * n, 2), (16 + 8 * n, 8), count);
    }
    fn float(&mut self, at_1: usize, at_2: usize, value: f64) {
        match self.version {
            1 => self.put(at_1, (value as f32).to_le_bytes().to_vec()),
            _ => self.put(at_2, value.to_le_bytes().to_vec()),
        }
    }
    fn floats(&mut self, at_1: usize, at_2: usize, values: &[f64]) {
        values.iter().enumerate().for_each(|(n, &value)| self.float(at_1 + 4 * n, at_2 + 8 * n, value));
    }
}

#[test]
fn nifti_images_of_every_type_version_and_order_are_read() {
    let types = [
        (2, Element::UInt8),
        (4, Element::Int16),
        (8, Element::Int32),
        (16, Element::Float32),
        (64, Element::Float64),
        (256, Element::Int8),
        (512, Element::UInt16),
        (768, Element::UInt32),
    ];
    for version in [1, 2] {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            for (datatype, element) in types {
                let data = array(element, order, AxisOrder::XFastest);
                assert_numbers(&one(&nifti(version, order, datatype, |_| {}, &data), "a.nii"), 1.0);
                let scaled =
                    nifti(version, order, datatype, |file| file.floats(112, 176, &[0.5, 0.0]), &data);
                assert_numbers(&one(&scaled, "a.nii"), 0.5);
            }
        }
    }
}

#[test]
fn nifti_maps_come_from_sform_then_qform_then_spacings() {
    let data = array(Element::UInt8, ByteOrder::Little, AxisOrder::XFastest);
    for version in [1, 2] {
        let spacings = |file: &mut Nifti| file.floats(76, 104, &[-1.0, 2.0, 3.0, 4.0]);
        let qform = |file: &mut Nifti| {
            spacings(file);
            file.field((252, 2), (344, 4), 1);
            // A quarter turn about z: x to y, y to -x; the handedness of -1 mirrors z.
            file.floats(256, 352, &[0.0, 0.0, 0.5f64.sqrt(), 10.0, 20.0, 30.0]);
        };
        let sform = |file: &mut Nifti| {
            qform(file);
            file.field((254, 2), (348, 4), 2);
            file.floats(280, 400, &[0.0, 5.0, 0.0, 1.0, 6.0, 0.0, 0.0, 2.0, 0.0, 0.0, 7.0, 3.0]);
        };
        let place = |edit: &dyn Fn(&mut Nifti)| {
            let file = nifti(version, ByteOrder::Big, 2, edit, &data);
            one(&file, "a.nii").index_to_world.transform_point3(DVec3::new(1.0, 2.0, 3.0))
        };
        assert!(place(&spacings).abs_diff_eq(DVec3::new(2.0, 6.0, 12.0), 1e-5));
        assert!(place(&qform).abs_diff_eq(DVec3::new(10.0 - 6.0, 20.0 + 2.0, 30.0 - 12.0), 1e-5));
        assert!(place(&sform).abs_diff_eq(DVec3::new(11.0, 8.0, 24.0), 1e-5));
    }
}

#[test]
fn of_several_nifti_volumes_the_first_is_read_and_the_others_are_told() {
    let mut data = array(Element::UInt8, ByteOrder::Little, AxisOrder::XFastest);
    data.extend(vec![200; data.len()]);
    let several = |file: &mut Nifti| {
        file.dim(0, 4);
        file.dim(4, 2);
    };
    let grid = one(&nifti(1, ByteOrder::Little, 2, several, &data), "a.nii");
    assert_numbers(&grid, 1.0);
    assert!(
        grid.metadata.contains(&("nifti_volumes".to_owned(), "2, of which the first is read".to_owned()))
    );

    let flat = nifti(1, ByteOrder::Little, 2, |file| file.dim(0, 2), &data);
    assert!(refusal(&flat, "a.nii").contains("a NIfTI image of 2 axes is no volume"));
    let colours = nifti(1, ByteOrder::Little, 128, |_| {}, &data);
    assert!(refusal(&colours, "a.nii").contains("datatype 128 are not read; write the image as float32"));
}

#[test]
fn gzip_is_unpacked_no_further_than_the_header_promises() {
    let pack = |bytes: &[u8]| {
        let mut stream = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        stream.write_all(bytes).expect("in memory");
        stream.finish().expect("in memory")
    };
    let mut file = nifti(
        1,
        ByteOrder::Little,
        2,
        |_| {},
        &array(Element::UInt8, ByteOrder::Little, AxisOrder::XFastest),
    );
    assert_numbers(&one(&pack(&file), "a.nii.gz"), 1.0);
    // What follows the voxels is never looked at: here it is not even valid deflate data.
    let whole = file.len();
    file.resize(whole + (1 << 20), 0);
    let mut packed = pack(&file);
    let length = packed.len();
    packed[length - 200..].fill(0xff);
    assert_numbers(&one(&packed, "a.nii.gz"), 1.0);
    assert!(refusal(&pack(&file[..400]), "a.nii.gz").contains("truncated"));
    assert!(refusal(&pack(b"something else"), "a.vdb.gz").contains("decompress the file first"));
}

#[test]
fn a_constant_array_takes_the_memory_of_its_tiles() {
    let raw = RawShape {
        shape: [128; 3],
        element: Element::UInt8,
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
    };
    let request = ReadRequest { raw: Some(raw), ..ReadRequest::default() };
    let file = read_bytes(&vec![3; 128 * 128 * 128], Path::new("a.raw"), &request).expect("readable");
    let tree = float(&file.grids[0]);
    assert_eq!((tree.leaves.len(), tree.tiles.len()), (0, 4096));
    assert_eq!(tree.statistics().sum[0], 3.0 * 128.0 * 128.0 * 128.0);
}
