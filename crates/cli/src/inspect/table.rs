//! The report for people: what is there, how large, and what a renderer would take it for.

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use super::report::{GridReport, Report};

/// A heading and a paragraph a grid.
pub fn table(path: &Path, report: &Report) -> String {
    let mut text = format!("{}: {}, {}\n", path.display(), report.format, count(report.grids.len(), "grid"));
    for grid in &report.grids {
        text.push('\n');
        for (key, value) in rows(grid) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {key:<19}{value}");
        }
    }
    for skipped in &report.skipped {
        let _ = writeln!(text, "\n  `{}` is not read: {}", skipped.name, skipped.why);
    }
    text
}

fn rows(grid: &GridReport) -> Vec<(&'static str, String)> {
    let half = if grid.saved_as_half { ", stored as half" } else { "" };
    let tiles = match grid.active_tiles {
        0 => String::new(),
        n => format!(" ({} among them)", count(n as usize, "tile")),
    };
    let mut rows = vec![
        ("grid", format!("`{}`, {}, {}", grid.name, grid.kind, grid.class)),
        ("taken for", meaning(grid).to_owned()),
        ("codec", format!("{}{half}", grid.codec)),
        ("active voxels", format!("{}{tiles}", grouped(grid.active_voxels))),
    ];
    if grid.active_voxels > 0 {
        rows.push((
            "values",
            format!("{} to {}, sum {}", short(&grid.min), short(&grid.max), short(&grid.sum)),
        ));
    }
    if grid.non_finite > 0 {
        rows.push(("not finite", format!("{} values, left out above", grouped(grid.non_finite))));
    }
    rows.push(("background", short(&grid.background)));
    rows.push(("voxel size", triple(grid.voxel_size.map(number))));
    if grid.active_voxels > 0 {
        let [first, last] = grid.index_bbox;
        let edges = [0, 1, 2].map(|axis| i64::from(last[axis]) - i64::from(first[axis]) + 1);
        rows.push((
            "index box",
            format!("{first:?} to {last:?}, {}", edges.map(|e| e.to_string()).join(" x ")),
        ));
        let [low, high] = world_box(grid);
        rows.push(("world box", format!("{} to {}", triple(low.map(number)), triple(high.map(number)))));
    }
    if let Some(integrals) = grid.mean_line_integral.filter(|_| meaning(grid).contains("density")) {
        let integrals = triple(integrals.map(number));
        rows.push(("optical thickness", format!("{integrals} along x, y, z for scale 1, mean over the box")));
    }
    rows.push(("memory", bytes(grid.memory_bytes)));
    for (voxel, value, active) in &grid.probes {
        let state = if *active { "active" } else { "inactive" };
        rows.push(("probe", format!("{voxel:?}: {}, {state}", short(value))));
    }
    rows
}

/// What the name and the type suggest.
fn meaning(grid: &GridReport) -> &'static str {
    if grid.class == "level set" {
        return "a surface (signed distance), no medium";
    }
    match grid.name.to_lowercase().as_str() {
        "density" => "density: extinction is a scale times this",
        "temperature" => "temperature of what glows; kelvin by a scale and an offset",
        "flame" | "flames" | "heat" => "fire: emission",
        "cd" | "color" => "colour: albedo",
        "vel" | "v" | "velocity" => "velocity: motion, no medium",
        _ if grid.kind == "Vec3SGrid" => "nothing by its name",
        _ if grid.class == "fog volume" => "density, by its class",
        _ => "nothing by its name; as the only grid of a file, density",
    }
}

/// The box around the voxels' cells, which reach half a voxel beyond their centres.
fn world_box(grid: &GridReport) -> [[f64; 3]; 2] {
    let [first, last] = grid.index_bbox;
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for corner in 0..8 {
        let index = [0, 1, 2].map(|axis| match corner >> axis & 1 {
            0 => f64::from(first[axis]) - 0.5,
            _ => f64::from(last[axis]) + 0.5,
        });
        for (axis, row) in grid.index_to_world[..3].iter().enumerate() {
            let world = row[0] * index[0] + row[1] * index[1] + row[2] * index[2] + row[3];
            low[axis] = low[axis].min(world);
            high[axis] = high[axis].max(world);
        }
    }
    [low, high]
}

pub fn count(n: usize, what: &str) -> String {
    format!("{} {what}{}", grouped(n as u64), if n == 1 { "" } else { "s" })
}

/// 1234567 as 1,234,567.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

pub(super) fn bytes(n: u64) -> String {
    match n {
        0..10_000 => format!("{n} bytes"),
        10_000..10_000_000 => format!("{:.1} kB", n as f64 * 1e-3),
        _ => format!("{:.1} MB", n as f64 * 1e-6),
    }
}

pub(super) fn triple(parts: [String; 3]) -> String {
    format!("({})", parts.join(", "))
}

/// Six significant digits.
pub(super) fn number(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) {
        return format!("{x:.5e}");
    }
    let before_point = if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 + 1 };
    let text = format!("{x:.*}", (6 - before_point).clamp(0, 9) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn short(value: &Value) -> String {
    match value {
        Value::Array(parts) => format!("({})", parts.iter().map(short).collect::<Vec<_>>().join(", ")),
        Value::Number(n) => n.as_f64().map_or_else(|| n.to_string(), number),
        Value::Null => "not finite".into(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_readable() {
        assert_eq!(grouped(1_234_567), "1,234,567");
        assert_eq!(
            [0.1f32.into(), 0.0, 1.0, 123.456_789, 6.0e-5, 1e9].map(number).join(" "),
            "0.1 0 1 123.457 6.00000e-5 1.00000e9"
        );
        assert_eq!(bytes(123_456), "123.5 kB");
    }
}
