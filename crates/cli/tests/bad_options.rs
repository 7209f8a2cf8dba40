//! Bad values of options: every option of every subcommand that takes a value, as `--help` lists them, is given what nobody
//! means. It is refused by one line that names it, or the command does its work.

use std::process::{Child, Stdio};
use std::time::Duration;

#[path = "command/mod.rs"]
mod command;

use command::{BALL, Folder, Run};

/// What every option is tried with.
const VALUES: [&str; 9] = ["", "0", "-1", "nan", "inf", "1e-310", "99999999999999999999", "0x0", "9..5"];

/// How each subcommand is called, short of the option under test.
const CALLS: [(&str, &str); 11] = [
    ("render", "render ball.toml -o out.json"),
    ("inspect", "inspect grid.npy"),
    ("convert", "convert grid.npy out.npy"),
    ("merge", "merge a.acc"),
    ("diff", "diff a.exr a.exr"),
    ("estimators", "estimators ball.toml --ray=0,0,4,0,0,-1"),
    ("slab", "slab"),
    ("measure", "measure ball.toml"),
    ("phase", "phase hg(g=0.5)"),
    ("completions", "completions bash"),
    ("schema", "schema"),
];

/// What an option needs beside it, or what keeps it from working for ever.
const COMPANIONS: [(&str, &str); 24] = [
    ("render --checkpoint-every", "--checkpoint new.acc"),
    ("render --error", "--spp 1"),
    ("render --time", "--spp 1"),
    ("render --raw-shape", "--raw-type uint8"),
    ("render --raw-type", "--raw-shape 1x1x1"),
    ("inspect --raw-shape", "--raw-type uint8"),
    ("inspect --raw-type", "--raw-shape 1x1x1"),
    ("convert --raw-shape", "--raw-type uint8"),
    ("convert --raw-type", "--raw-shape 1x1x1"),
    ("measure --error", "--samples 100"),
    ("merge --output", ""),
    ("merge --of", "--missing"),
    ("merge", "-o out.json"),
    ("estimators --width", "--samples 16 --pictures"),
    ("estimators --spp", "--samples 16 --pictures --width 4"),
    ("estimators --raw-shape", "--raw-type uint8"),
    ("estimators --raw-type", "--raw-shape 1x1x1"),
    ("estimators --samples", ""),
    ("estimators", "--samples 16"),
    ("slab --tau", "--albedo 0.5 --samples 100"),
    ("slab --albedo", "--tau 1 --samples 100"),
    ("slab --samples", "--albedo 0.5 --tau 1"),
    ("slab --azimuth", "--albedo 0.5 --tau 1 --radiance 1 --samples 100"),
    ("slab", "--albedo 0.5 --tau 1 --samples 100"),
];

/// Milliseconds that a run may take: far more than any does.
const PATIENCE: u32 = 30_000;

#[test]
fn bad_values_of_options_are_refused_by_name_or_do_no_harm() {
    let folder = Folder::new();
    folder.write("ball.toml", ball());
    folder.done("render ball.toml -o a.acc -o a.exr");
    folder.write("grid_2x2x2_uint8.raw", [1; 8]);
    folder.done("convert grid_2x2x2_uint8.raw grid.npy");
    let mut calls = Vec::new();
    for subcommand in subcommands(&folder) {
        let options = options(&folder, &subcommand);
        calls.extend(options.into_iter().map(|option| (subcommand.clone(), option)));
    }
    assert!(calls.len() > 50, "{calls:?}");
    let judged = |(subcommand, option): &(String, String)| -> String {
        let say = |value: &str| {
            let why = judge(&folder, subcommand, option, value).err()?;
            Some(format!("{subcommand} {option}={value}: {why}\n"))
        };
        VALUES.into_iter().filter_map(say).collect()
    };
    let wrong = std::thread::scope(|scope| {
        let half = |parity| calls.iter().skip(parity).step_by(2).map(judged).collect::<String>();
        let other = scope.spawn(move || half(1));
        half(0) + &other.join().expect("no panic")
    });
    assert!(wrong.is_empty(), "{wrong}");
}

fn judge(folder: &Folder, subcommand: &str, option: &str, value: &str) -> Result<(), String> {
    let call = CALLS.iter().find(|(name, _)| *name == subcommand);
    let (_, call) = call.ok_or("say in CALLS how the subcommand is called")?;
    let name = format!("{subcommand} {option}");
    let companions = COMPANIONS.iter().find(|(of, _)| *of == name || *of == subcommand);
    let mut command = folder.command(&format!("{call} {}", companions.map_or("", |(_, with)| with)));
    command.arg(format!("{option}={value}")).stdout(Stdio::piped()).stderr(Stdio::piped());
    let run = finished(command.spawn().expect("the command starts"))?;
    let line = run.err.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
    let word = option.trim_start_matches('-');
    match run.code {
        _ if run.err.contains("panicked") => Err(run.err),
        _ if line.contains("were not provided") => {
            Err(format!("say in COMPANIONS what it needs: {}", run.err))
        }
        Some(0) if run.out.contains("NaN") || run.out.contains("null") => Err(run.out),
        Some(0) => Ok(()),
        Some(1 | 2) if line.contains(word) || (!value.is_empty() && line.contains(value)) => Ok(()),
        code => Err(format!("{code:?}: {}", run.err)),
    }
}

/// The run, once it has ended.
fn finished(mut child: Child) -> Result<Run, String> {
    for _ in 0..PATIENCE {
        if child.try_wait().expect("a child").is_some() {
            return Ok(Run::from(child.wait_with_output().expect("its output")));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("a child");
    Err("does not end".into())
}

/// The subcommands, as `--help` lists them.
fn subcommands(folder: &Folder) -> Vec<String> {
    let help = folder.done("--help").out;
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    // Descriptions go on in lines that begin further in.
    let heads = lines.take_while(|line| line.starts_with("  ")).filter(|line| !line.starts_with("   "));
    let words = heads.filter_map(|line| line.split_whitespace().next());
    words.filter(|word| *word != "help").map(str::to_owned).collect()
}

/// The options of a subcommand that take a value.
fn options(folder: &Folder, subcommand: &str) -> Vec<String> {
    let help = folder.done(&format!("{subcommand} --help")).out;
    let takes_value = |line: &str| {
        let (_, rest) = line.trim_start().split_at_checked(line.trim_start().find("--")?)?;
        let (option, value) = rest.split_once(' ')?;
        let is_heading = line.trim_start().starts_with('-') && value.starts_with('<');
        is_heading.then(|| option.to_owned())
    };
    help.lines().filter_map(takes_value).collect()
}

/// [`BALL`], with fewer pixels and a meter.
fn ball() -> String {
    let meter = "meter = [{ type = 'radiance', position = [0, 0, 4], direction = [0, 0, -1] }]";
    format!("{}\nrender = {{ spp = 1 }}\n{meter}\n", BALL.replace("[16, 12]", "[4, 3]"))
}
