//! Averages kept on disk, since those of great or various droplets take seconds.
//!
//! A file's name is a hash of everything that its content follows from; its content is
//!
//! ```text
//! "TYNDMIE1"   hash of the inputs (32 bytes)   number of angles (u64)
//! wavelength, Qext, Qsca, Qabs, g, area, volume, two changes (f64)   angles (f64 …)   phase function (f64 …)
//! SHA-256 of all of that
//! ```
//!
//! little-endian. A file that is missing, damaged or cannot be written costs the computation and nothing else.

use sha2::{Digest, Sha256};
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::{MieAverage, MieError, SizeDistribution, SizeLaw};
use crate::refractive_index::RefractiveIndex;

/// Beginning of every file. Its last digit changes with anything that changes results.
const MAGIC: [u8; 8] = *b"TYNDMIE1";

const EXTENSION: &str = "mie";

/// More than the longest table takes.
const GREATEST_FILE: u64 = 8 << 20;

/// What the files may take together; beyond either, the oldest half goes.
const MOST_FILES: usize = 4096;
const MOST_BYTES: u64 = 256 << 20;

/// Where averages are kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MieCache {
    folder: Option<PathBuf>,
}

impl MieCache {
    /// The folder `mie` in the one that the environment variable `TYNDALL_CACHE` names (`off`: none), or else in the
    /// folder `tyndall` of the user's caches.
    pub fn from_environment() -> Self {
        let variable = |name| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let folder = match variable("TYNDALL_CACHE") {
            Some(off) if off.as_os_str() == "off" => None,
            Some(folder) => Some(folder),
            None => user_caches(variable).map(|caches| caches.join("tyndall")),
        };
        Self { folder: folder.map(|folder| folder.join("mie")) }
    }

    /// A cache in `folder`, which is made when something is written.
    pub fn at(folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()) }
    }

    /// Nothing is kept.
    pub fn none() -> Self {
        Self { folder: None }
    }

    /// [`MieAverage::new`], or what it gave before.
    pub fn average(
        &self,
        m: RefractiveIndex,
        wavelength: f64,
        distribution: &SizeDistribution,
    ) -> Result<MieAverage, MieError> {
        let Some(folder) = &self.folder else {
            return MieAverage::new(m, wavelength, distribution);
        };
        let key = key(m, wavelength, distribution);
        let name: String = key[..16].iter().map(|byte| format!("{byte:02x}")).collect();
        let path = folder.join(format!("{name}.{EXTENSION}"));
        if let Some(average) = read(&path).and_then(|bytes| decode(&bytes, &key)) {
            return Ok(average);
        }
        let average = MieAverage::new(m, wavelength, distribution)?;
        // A cache that cannot be written is no reason to stop.
        let _ = write(&path, &encode(&average, &key)).and_then(|()| prune(folder));
        Ok(average)
    }
}

/// The folder of the user's caches by the convention of the platform.
fn user_caches(variable: impl Fn(&'static str) -> Option<PathBuf>) -> Option<PathBuf> {
    let home = |below: &str| variable("HOME").map(|home| home.join(below));
    if cfg!(windows) {
        return variable("LOCALAPPDATA");
    }
    if cfg!(target_os = "macos") {
        return home("Library/Caches");
    }
    variable("XDG_CACHE_HOME").filter(|folder| folder.is_absolute()).or_else(|| home(".cache"))
}

fn key(m: RefractiveIndex, wavelength: f64, distribution: &SizeDistribution) -> [u8; 32] {
    let (law, parameters) = match distribution.law {
        SizeLaw::Single { r } => (0.0, [r, 0.0, 0.0]),
        SizeLaw::Gamma { r_eff, v_eff } => (1.0, [r_eff, v_eff, 0.0]),
        SizeLaw::LogNormal { r_g, sigma_g } => (2.0, [r_g, sigma_g, 0.0]),
        SizeLaw::ModifiedGamma { r_mode, alpha, gamma } => (3.0, [r_mode, alpha, gamma]),
        SizeLaw::PowerLaw { exponent } => (4.0, [exponent, 0.0, 0.0]),
    };
    let limits = [distribution.r_min, distribution.r_max];
    let mut hasher = Sha256::new_with_prefix(MAGIC);
    for number in [m.n, m.k, wavelength, law].into_iter().chain(parameters).chain(limits) {
        hasher.update(number.to_le_bytes());
    }
    hasher.finalize().into()
}

fn encode(average: &MieAverage, key: &[u8; 32]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(key);
    bytes.extend((average.angles.len() as u64).to_le_bytes());
    let MieAverage { wavelength, q_ext, q_sca, q_abs, g, area, volume, change, .. } = *average;
    let numbers = [wavelength, q_ext, q_sca, q_abs, g, area, volume, change[0], change[1]];
    for number in numbers.iter().chain(&average.angles).chain(&average.values) {
        bytes.extend(number.to_le_bytes());
    }
    let hash = Sha256::digest(&bytes);
    bytes.extend(hash);
    bytes
}

/// The average, if the bytes are whole and belong to the key.
fn decode(bytes: &[u8], key: &[u8; 32]) -> Option<MieAverage> {
    let (content, hash) = bytes.split_last_chunk::<32>()?;
    if Sha256::digest(content).as_slice() != hash {
        return None;
    }
    let content = content.strip_prefix(&MAGIC)?.strip_prefix(key)?;
    let (angles, numbers) = content.split_first_chunk::<8>()?;
    let angles = usize::try_from(u64::from_le_bytes(*angles)).ok()?;
    let (numbers, rest) = numbers.as_chunks::<8>();
    let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    if !rest.is_empty() || numbers.len() != angles.checked_mul(2)?.checked_add(9)? {
        return None;
    }
    let (single, tables) = numbers.split_first_chunk::<9>()?;
    let [wavelength, q_ext, q_sca, q_abs, g, area, volume, efficiency, phase] = *single;
    Some(MieAverage {
        wavelength,
        q_ext,
        q_sca,
        q_abs,
        g,
        area,
        volume,
        angles: tables[..angles].to_vec(),
        values: tables[angles..].to_vec(),
        change: [efficiency, phase],
    })
}

fn read(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    tyndall_machine::files::open(path).ok()?.take(GREATEST_FILE).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// The file appears whole or not at all.
fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    static WRITTEN: AtomicU64 = AtomicU64::new(0);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let number = WRITTEN.fetch_add(1, Ordering::Relaxed);
    let temporary = path.with_extension(format!("{}-{number}.part", std::process::id()));
    let result = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    if result.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    result
}

/// Removes the oldest half of the files if there are too many. Only files of this cache are touched.
fn prune(folder: &Path) -> io::Result<()> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let path = entry.path();
        if path.extension().is_some_and(|extension| extension == EXTENSION || extension == "part") {
            let metadata = entry.metadata()?;
            files.push((metadata.modified()?, metadata.len(), path));
        }
    }
    if files.len() <= MOST_FILES && files.iter().map(|(_, length, _)| length).sum::<u64>() <= MOST_BYTES {
        return Ok(());
    }
    files.sort();
    files[..files.len() / 2].iter().try_for_each(|(_, _, path)| fs::remove_file(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: RefractiveIndex = RefractiveIndex { n: 1.33, k: 1e-9 };

    fn haze() -> SizeDistribution {
        SizeLaw::LogNormal { r_g: 0.2, sigma_g: 1.4 }.into()
    }

    fn files(folder: &Path) -> Vec<PathBuf> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
    }

    /// What is read is what was written, to the bit: it is changed on disk, with its hash, to tell it from a new one.
    #[test]
    fn a_second_average_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let cache = MieCache::at(folder.path().join("new/mie"));
        let first = cache.average(WATER, 550.0, &haze()).unwrap();
        assert_eq!(first, MieAverage::new(WATER, 550.0, &haze()).unwrap());
        let [path] = files(&folder.path().join("new/mie")).try_into().unwrap();
        let marked = MieAverage { g: 0.123, ..first };
        fs::write(&path, encode(&marked, &key(WATER, 550.0, &haze()))).unwrap();
        assert_eq!(cache.average(WATER, 550.0, &haze()).unwrap(), marked);
    }

    #[test]
    fn every_input_has_its_own_file() {
        let keys = [
            key(WATER, 550.0, &haze()),
            key(RefractiveIndex { n: 1.34, ..WATER }, 550.0, &haze()),
            key(RefractiveIndex { k: 0.0, ..WATER }, 550.0, &haze()),
            key(WATER, 551.0, &haze()),
            key(WATER, 550.0, &SizeDistribution { r_max: 9.0, ..haze() }),
            key(WATER, 550.0, &SizeDistribution { r_min: 0.1, ..haze() }),
            key(WATER, 550.0, &SizeLaw::LogNormal { r_g: 0.2, sigma_g: 1.5 }.into()),
            key(WATER, 550.0, &SizeLaw::Gamma { r_eff: 0.2, v_eff: 0.4 }.into()),
        ];
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(key));
        }
    }

    #[test]
    fn damaged_foreign_and_cut_files_are_computed_anew() {
        let folder = tempfile::tempdir().unwrap();
        let cache = MieCache::at(folder.path());
        let sound = cache.average(WATER, 550.0, &haze()).unwrap();
        let [path] = files(folder.path()).try_into().unwrap();
        let bytes = fs::read(&path).unwrap();
        let mut flipped = bytes.clone();
        flipped[200] ^= 1;
        let foreign = encode(&MieAverage { g: 0.5, ..sound.clone() }, &key(WATER, 1.0, &haze()));
        let mut claims = bytes[..bytes.len() - 32].to_vec();
        claims[40..48].copy_from_slice(&u64::MAX.to_le_bytes());
        let hash = Sha256::digest(&claims);
        claims.extend(hash);
        for damaged in [flipped, foreign, claims, bytes[..bytes.len() - 1].to_vec(), Vec::new(), vec![7; 31]]
        {
            fs::write(&path, damaged).unwrap();
            assert_eq!(cache.average(WATER, 550.0, &haze()).unwrap(), sound);
            assert_eq!(fs::read(&path).unwrap(), bytes);
        }
    }

    #[test]
    fn a_folder_that_cannot_be_written_costs_nothing_but_time() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "not a folder").unwrap();
        let average = MieCache::at(file.join("mie")).average(WATER, 550.0, &haze()).unwrap();
        assert_eq!(average, MieCache::none().average(WATER, 550.0, &haze()).unwrap());
    }

    #[test]
    fn the_oldest_half_goes_when_there_are_too_many_files_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        for i in 0..MOST_FILES {
            fs::write(folder.path().join(format!("{i}.{EXTENSION}")), "").unwrap();
        }
        fs::write(folder.path().join("notes.txt"), "mine").unwrap();
        prune(folder.path()).unwrap();
        assert_eq!(files(folder.path()).len(), MOST_FILES + 1);
        fs::write(folder.path().join(format!("new.{EXTENSION}")), "").unwrap();
        prune(folder.path()).unwrap();
        assert_eq!(files(folder.path()).len(), MOST_FILES / 2 + 2);
        assert!(folder.path().join("notes.txt").exists() && folder.path().join("new.mie").exists());
    }

    #[test]
    fn the_user_s_caches_are_where_the_platform_has_them() {
        let home = |name| (name == "HOME").then(|| PathBuf::from("/home/me"));
        let xdg = |name| (name == "XDG_CACHE_HOME").then(|| PathBuf::from("/caches"));
        if cfg!(target_os = "linux") {
            assert_eq!(user_caches(home), Some("/home/me/.cache".into()));
            assert_eq!(user_caches(xdg), Some("/caches".into()));
        }
        assert_eq!(user_caches(|_| None), None);
    }
}
