//! Builds the pictures of `examples/`: `cargo run --release --example gallery [-- NN…]`.
//!
//! Pictures of scenes are what the command `tyndall` writes, so that each can be made by hand as well; here they are
//! set side by side with captions. The charts are short programs. Seeds are fixed: the same bits every time. [`chapters`] is the list, in the order of
//! the subject; numbers after `--` choose some of it.

mod chapters;
mod command;
mod compose;
mod convergence;
mod distances;
mod font;
mod layers;
#[path = "../../src/plot/mod.rs"]
#[allow(dead_code, unused_imports, reason = "the command draws more kinds of charts")]
mod plot;
mod transmittances;

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use chapters::{CHAPTERS, Chapter, Chart, Picture};
use command::Tyndall;
use tyndall_film::write_atomically;

fn main() -> ExitCode {
    let numbers: Vec<String> = std::env::args().skip(1).collect();
    match build(&numbers) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn build(numbers: &[String]) -> Result<(), Box<dyn Error>> {
    let chosen = choose(numbers)?;
    let tyndall = Tyndall::build()?;
    for chapter in chosen {
        let start = Instant::now();
        let file = picture_of(chapter, &tyndall)?;
        let kilobytes = std::fs::metadata(&file)?.len() / 1000;
        println!("{}: {kilobytes} kB, {:.1} s", file.display(), start.elapsed().as_secs_f64());
    }
    Ok(())
}

/// The chapters whose folders begin with one of the numbers; all if there is none.
fn choose(numbers: &[String]) -> Result<Vec<&'static Chapter>, String> {
    let is_chapter =
        |number: &String, chapter: &Chapter| chapter.folder.split('_').next() == Some(number.as_str());
    if let Some(unknown) = numbers.iter().find(|n| !CHAPTERS.iter().any(|chapter| is_chapter(n, chapter))) {
        let folders: Vec<_> = CHAPTERS.iter().map(|chapter| chapter.folder).collect();
        return Err(format!("there is no chapter `{unknown}`; give the numbers of {}", folders.join(", ")));
    }
    let wanted = |chapter: &&Chapter| numbers.is_empty() || numbers.iter().any(|n| is_chapter(n, chapter));
    Ok(CHAPTERS.iter().filter(wanted).collect())
}

/// Makes the picture of a chapter and says which file it is.
fn picture_of(chapter: &Chapter, tyndall: &Tyndall) -> Result<PathBuf, Box<dyn Error>> {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(chapter.folder).canonicalize()?;
    match &chapter.picture {
        Picture::Panels { columns, panels } => {
            let file = folder.join("picture.png");
            let images = layers::render(tyndall, &folder, panels)?;
            compose::write(&file, *columns, &images)?;
            Ok(file)
        }
        Picture::Command { line } => {
            tyndall.run(&folder, &format!("{line} -o picture.svg"))?;
            Ok(folder.join("picture.svg"))
        }
        Picture::Chart(chart) => {
            let file = folder.join("picture.svg");
            let svg = match chart {
                Chart::Convergence => convergence::draw(&folder)?,
                Chart::Distances => distances::draw(),
                Chart::Transmittances => transmittances::draw(),
            };
            write_atomically(&file, |out| out.write_all(svg.as_bytes()))?;
            Ok(file)
        }
    }
}
