//! Times full loads of volume files: every grid, every value, in memory as a [`tyndall_volumes::VolumeFile`].
//!
//! ```text
//! cargo run --release -p tyndall-volumes --example read_speed -- [--runs N] FILE...
//! ```
//!
//! One line a file: its name, the number of runs, the least and the median time in milliseconds, and the number of
//! active voxels. Letting go of the memory is not counted. A first run that is not counted brings the file into
//! the system's cache, so that the disk is not measured. `RAYON_NUM_THREADS=1` measures a single thread.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use tyndall_volumes::{ReadError, ReadRequest, read};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).peekable();
    let mut runs = 15;
    if arguments.next_if_eq("--runs").is_some() {
        match arguments.next().and_then(|number| number.parse().ok()).filter(|&runs| runs > 0) {
            Some(number) => runs = number,
            None => return usage(),
        }
    }
    if arguments.peek().is_none() {
        return usage();
    }
    for file in arguments {
        if let Err(error) = time_loads(Path::new(&file), runs) {
            eprintln!("{error}");
            return ExitCode::from(1);
        }
    }
    ExitCode::SUCCESS
}

fn usage() -> ExitCode {
    eprintln!("usage: read_speed [--runs N] FILE...   (N from 1)");
    ExitCode::from(2)
}

fn time_loads(path: &Path, runs: usize) -> Result<(), ReadError> {
    let first = read(path, &ReadRequest::default())?;
    let active_voxels: u64 = first.grids.iter().map(|grid| grid.values.statistics().active_voxels).sum();
    drop(first);
    let mut milliseconds = Vec::with_capacity(runs);
    for _ in 0..runs {
        let start = Instant::now();
        let file = read(path, &ReadRequest::default())?;
        milliseconds.push(start.elapsed().as_secs_f64() * 1e3);
        drop(file);
    }
    milliseconds.sort_by(f64::total_cmp);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (least, median) = (milliseconds[0], milliseconds[runs / 2]);
    println!("{name} {runs} {least:.3} {median:.3} {active_voxels}");
    Ok(())
}
