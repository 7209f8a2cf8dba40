//! Builds the pictures of `examples/`: `cargo run --release --example gallery [-- NN…]`.
//!
//! Every picture is made of what the command `tyndall` writes, so that each can be made by hand as well; here they are
//! set side by side with captions. Seeds are fixed: the same bits every time. [`chapters`] is the list, in the order of
//! the subject; numbers after `--` choose some of it.

mod chapters;
mod command;
mod compose;
mod font;
mod layers;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use chapters::{CHAPTERS, Chapter, Picture};
use command::Tyndall;

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
        Picture::Plot { command } => {
            let file = folder.join("picture.svg");
            tyndall.run(&folder, &format!("{command} -o picture.svg"))?;
            Ok(file)
        }
    }
}
