//! Pictures: of the surroundings, on surfaces, and those that are compared.

use tyndall_film::Provenance;
use tyndall_film::comparison::Picture as Compared;
use tyndall_scene::light::read_light_image;
use tyndall_scene::surface::Picture;

use crate::folder::Folder;
use crate::{Outcome, assert_message};

/// OpenEXR, by the three readers there are of it.
pub(crate) fn exr(bytes: &[u8]) -> Outcome {
    let folder = Folder::with("a.exr", bytes);
    let path = folder.path("a.exr");
    let compared = match Compared::read(&path) {
        Ok(picture) => Outcome::Read(picture.width * picture.height * size_of::<[f32; 3]>()),
        Err(error) => Outcome::refused(&error),
    };
    if let Err(error) = Provenance::of_exr(&path) {
        Outcome::refused(&error);
    }
    either(either(surroundings(&folder, "a.exr"), surface(&folder, "a.exr")), compared)
}

/// Radiance's pictures, as surroundings and on surfaces.
pub(crate) fn hdr(bytes: &[u8]) -> Outcome {
    let folder = Folder::with("a.hdr", bytes);
    either(surroundings(&folder, "a.hdr"), surface(&folder, "a.hdr"))
}

/// PNG pictures on surfaces, with the right checksums, so that damage reaches what lies behind them.
pub(crate) fn png(bytes: &[u8]) -> Outcome {
    surface(&Folder::with("a.png", &with_checksums(bytes)), "a.png")
}

/// A PNG is eight bytes and chunks: length, type, so many bytes, checksum of type and bytes.
fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    let mut mended = bytes.to_vec();
    let mut rest = mended.get_mut(8..).unwrap_or_default();
    while let Some((length, chunk)) = rest.split_first_chunk_mut::<4>() {
        let length = u32::from_be_bytes(*length) as usize + 4;
        let Some((content, after)) = chunk.split_at_mut_checked(length) else { break };
        let Some((checksum, next)) = after.split_first_chunk_mut::<4>() else { break };
        let mut crc = flate2::Crc::new();
        crc.update(content);
        *checksum = crc.sum().to_be_bytes();
        rest = next;
    }
    mended
}

/// JPEG pictures on surfaces.
pub(crate) fn jpeg(bytes: &[u8]) -> Outcome {
    surface(&Folder::with("a.jpg", bytes), "a.jpg")
}

fn surroundings(folder: &Folder, name: &str) -> Outcome {
    match read_light_image(&folder.path(name)) {
        Ok((image, warning)) => {
            warning.iter().for_each(|warning| assert_message(warning));
            image.texel(image.width() - 1, image.height() - 1);
            Outcome::Read(image.width() * image.height() * size_of::<[f32; 3]>())
        }
        Err(error) => Outcome::refused(&error),
    }
}

fn surface(folder: &Folder, name: &str) -> Outcome {
    match Picture::read(&folder.path(name), None) {
        Ok(picture) => {
            picture.texel(picture.width() - 1, picture.height() - 1);
            assert!(picture.greatest().is_finite());
            Outcome::Read(picture.width() * picture.height() * size_of::<[f32; 3]>())
        }
        Err(error) => Outcome::refused(&error),
    }
}

/// Read if one of both was: the larger.
fn either(a: Outcome, b: Outcome) -> Outcome {
    match (a, b) {
        (Outcome::Read(a), Outcome::Read(b)) => Outcome::Read(a.max(b)),
        (Outcome::Refused, read) => read,
        (read, Outcome::Refused) => read,
    }
}
