//! Checkpoints that are damaged, of something else, or in use are refused, and stay as they are.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::command::{BALL, Folder};
use crate::refused;

const RESUME: &str = "exec tyndall render ball.toml --spp 8 --checkpoint c.acc --resume -o a.json";

/// A folder with the ball and a checkpoint of half of it, whose bytes are returned too.
fn half_rendered() -> (Folder, Vec<u8>) {
    let folder = Folder::new();
    folder.write("ball.toml", BALL);
    folder.done("render ball.toml --spp 4 --checkpoint c.acc -o a.json");
    let whole = folder.read("c.acc");
    (folder, whole)
}

#[test]
fn a_checkpoint_cut_short_or_with_a_changed_byte_is_told_to_be_damaged() {
    let (folder, whole) = half_rendered();
    let cut = (0..16).map(|part| whole[..whole.len() * part / 16].to_vec());
    let changed = [0, 8, 12, 40, whole.len() / 2, whole.len() - 1].map(|at| {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        bytes
    });
    for (number, bytes) in cut.chain(changed).enumerate() {
        folder.write("c.acc", &bytes);
        let error = refused(&folder, RESUME);
        assert!(error.starts_with("error: c.acc: "), "{number}: {error}");
        let said = ["is damaged or cut short", "is no .acc file of tyndall"];
        assert!(said.iter().any(|words| error.contains(words)), "{number}: {error}");
        assert_eq!(folder.read("c.acc"), bytes, "{number}");
    }
}

#[test]
fn a_checkpoint_of_a_future_format_says_so() {
    let (folder, whole) = half_rendered();
    let mut future = whole[..whole.len() - 4].to_vec();
    future[8] = 99;
    let mut sum = flate2_crc(&future);
    future.append(&mut sum);
    folder.write("c.acc", &future);
    let error = refused(&folder, RESUME);
    assert!(error.contains("version 99 of the .acc format") && error.contains("use the program"), "{error}");
}

/// CRC-32 of zlib, bit by bit, least byte first.
fn flate2_crc(bytes: &[u8]) -> Vec<u8> {
    let sum = bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(
            sum ^ u32::from(byte),
            |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 },
        )
    });
    (!sum).to_le_bytes().to_vec()
}

#[test]
fn a_folder_or_another_picture_in_its_place_is_refused() {
    let (folder, _) = half_rendered();
    std::fs::remove_file(folder.path("c.acc")).unwrap();
    std::fs::create_dir(folder.path("c.acc")).unwrap();
    assert!(refused(&folder, RESUME).contains("c.acc: is a folder"));
    std::fs::remove_dir(folder.path("c.acc")).unwrap();
    folder.done("render ball.toml --spp 4 --seed 9 -o c.acc");
    assert!(refused(&folder, RESUME).contains("c.acc: is of another scene, size, seed"));
}

#[test]
fn two_renders_to_one_checkpoint_do_not_meet() {
    let folder = Folder::new();
    folder.write("ball.toml", BALL);
    let line =
        "render ball.toml --spp 1000000 --time 60s -o first.json --checkpoint c.acc --checkpoint-every 0.05s";
    let mut command = folder.command(&format!("{line} --progress json"));
    let mut first = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut reports = BufReader::new(first.stdout.take().unwrap()).lines();
    let _ = (reports.next(), reports.next());
    let error = refused(&folder, RESUME);
    let expected = format!("c.acc: process {} renders to this checkpoint; wait", first.id());
    assert!(error.contains(&expected), "{error}");
    // Another checkpoint in the same folder is free.
    folder.done("render ball.toml --spp 2 --checkpoint d.acc -o b.json");
    // A lock ends with its holder, also if that is killed.
    assert!(first.try_wait().unwrap().is_none(), "the first is not disturbed");
    first.kill().unwrap();
    first.wait().unwrap();
    let samples = folder.accumulation("c.acc").film.complete().count();
    folder.done(&format!("render ball.toml --spp {} --checkpoint c.acc --resume -o a.json", samples + 1));
    assert_eq!(folder.accumulation("c.acc").film.complete().count(), samples + 1);
    assert!(folder.names().iter().all(|name| !name.starts_with('.')), "{:?}", folder.names());
}
