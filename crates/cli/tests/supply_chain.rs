//! What comes in from outside is what `deny.toml` allows, and no more than is known of; and `unsafe` is where it is known to be.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Packages of others that the command is built from, on this platform. Each is code that runs with the user's rights: think
/// twice before this number grows, and lower it when it falls.
const MOST_PACKAGES: usize = 120;

/// Files that may have `unsafe` in them, and why.
const UNSAFE: &[(&str, &str)] = &[
    ("crates/transport/src/wide.rs", "calls a function compiled for AVX2 after asking for it"),
    ("crates/transport/examples/roof.rs", "measures gather instructions"),
    ("fuzz/src/memory.rs", "counts allocations, which takes an allocator"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// `cargo metadata` of the workspace as it is locked, for the platform at hand.
fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--filter-platform", platform()])
        .current_dir(root())
        .output()
        .expect("cargo runs, as it runs this test");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn platform() -> &'static str {
    match (std::env::consts::OS, std::env::consts::ARCH) {
        ("macos", "aarch64") => "aarch64-apple-darwin",
        ("macos", _) => "x86_64-apple-darwin",
        ("windows", _) => "x86_64-pc-windows-msvc",
        (_, "aarch64") => "aarch64-unknown-linux-gnu",
        _ => "x86_64-unknown-linux-gnu",
    }
}

/// The packages that the command needs to run or to be built, by their identity; those of tests are not among them.
fn needed(metadata: &Value) -> BTreeSet<&str> {
    let nodes = metadata["resolve"]["nodes"].as_array().unwrap();
    let nodes: BTreeMap<&str, &Value> =
        nodes.iter().map(|node| (node["id"].as_str().unwrap(), node)).collect();
    let is_command = |id: &&str| package(metadata, id)["name"] == "tyndall";
    let mut todo: Vec<&str> = nodes.keys().copied().filter(is_command).collect();
    let mut needed = BTreeSet::new();
    while let Some(id) = todo.pop() {
        if !needed.insert(id) {
            continue;
        }
        for dependency in nodes[id]["deps"].as_array().unwrap() {
            let kinds = dependency["dep_kinds"].as_array().unwrap();
            if kinds.iter().any(|kind| kind["kind"] != "dev") {
                todo.push(dependency["pkg"].as_str().unwrap());
            }
        }
    }
    needed
}

fn package<'a>(metadata: &'a Value, id: &str) -> &'a Value {
    let packages = metadata["packages"].as_array().unwrap();
    packages.iter().find(|package| package["id"] == id).unwrap()
}

/// The strings of an array of `deny.toml`, which is plain enough to be read by lines.
fn allowed(key: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("deny.toml")).unwrap();
    let after = text.split(&format!("\n{key} = [\n")).nth(1).unwrap();
    let lines = after.lines().take_while(|line| *line != "]");
    lines.filter_map(|line| line.split('"').nth(1)).map(str::to_owned).collect()
}

/// Whether an SPDX expression can be met by the allowed licences.
fn is_met(expression: &str, allowed: &[String]) -> bool {
    let expression = expression.replace('/', " OR ");
    let mut terms = Vec::new();
    let (mut depth, mut start) = (0, 0);
    for (at, letter) in expression.char_indices() {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        if depth == 0 && expression[at..].starts_with(" AND ") {
            terms.push(&expression[start..at]);
            start = at + " AND ".len();
        }
    }
    terms.push(&expression[start..]);
    terms.iter().all(|term| {
        let term = term.trim_start_matches('(').trim_end_matches(')');
        term.split(" OR ").any(|licence| allowed.iter().any(|allowed| allowed == licence.trim()))
    })
}

#[test]
fn licences_sources_and_duplicates_are_as_allowed() {
    let metadata = metadata();
    let (licences, twice) = (allowed("allow"), allowed("skip"));
    let mut versions: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let needed = needed(&metadata);
    for id in &needed {
        let package = package(&metadata, id);
        let name = package["name"].as_str().unwrap();
        let licence = package["license"].as_str().unwrap_or("none");
        assert!(is_met(licence, &licences), "{name}: its licence {licence} is not among those of deny.toml");
        if let Some(source) = package["source"].as_str() {
            assert!(source.starts_with("registry+"), "{name} comes from {source}");
            versions.entry(name).or_default().insert(package["version"].as_str().unwrap());
        }
    }
    for (name, versions) in &versions {
        assert!(
            versions.len() == 1 || twice.iter().any(|skipped| skipped == name),
            "{name} comes as {versions:?}"
        );
    }
    let count = versions.values().map(BTreeSet::len).sum::<usize>();
    println!("packages of others in the default build: {count}");
    assert!(count <= MOST_PACKAGES, "{count} packages of others, above {MOST_PACKAGES}");
}

#[test]
fn cargo_run_in_the_root_means_the_command() {
    let metadata = metadata();
    let members = metadata["workspace_default_members"].as_array().unwrap();
    let packages = members.iter().map(|id| package(&metadata, id.as_str().unwrap()));
    // Of several packages with programs, cargo runs the one that names its own.
    let named: Vec<&Value> =
        packages.map(|package| &package["default_run"]).filter(|run| !run.is_null()).collect();
    assert_eq!(named, ["tyndall"]);
}

#[test]
fn licence_expressions_are_read_as_spdx_means_them() {
    let allowed = ["MIT", "Apache-2.0", "Unicode-3.0"].map(str::to_owned);
    for met in ["MIT", "GPL-3.0 OR MIT", "MIT/GPL-2.0", "(MIT OR GPL-3.0) AND Unicode-3.0"] {
        assert!(is_met(met, &allowed), "{met}");
    }
    for refused in ["GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Apache-2.0) AND GPL-3.0", "none", "MITx"] {
        assert!(!is_met(refused, &allowed), "{refused}");
    }
}

#[test]
fn unsafe_code_is_only_where_it_is_known_to_be() {
    let mut found = BTreeSet::new();
    let mut todo = vec![root().join("crates"), root().join("fuzz")];
    while let Some(folder) = todo.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                todo.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                // Without `allow`, the lint `unsafe_code` of the workspace denies it.
                if text.contains(concat!("allow(unsafe", "_code")) {
                    found.insert(path.strip_prefix(root()).unwrap().display().to_string().replace('\\', "/"));
                }
            }
        }
    }
    let known: BTreeSet<String> = UNSAFE.iter().map(|(file, _)| (*file).to_owned()).collect();
    assert_eq!(found, known);
}
