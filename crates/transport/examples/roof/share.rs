//! What share of the roof the march of the fast engine reaches on the benchmark's scenes of grids, from what it counts.
//!
//! Two roofs are told. That of *memory* is independent values from a table as large as the scene's grids, with as many
//! threads, where a cell counts as two loads and a density as three. That of the *structure* is cells and densities of the
//! scene's own grid at random independent points, as many of each as the march had, and no ray to follow
//! between them; the march may pass it, as rays of neighbouring pixels meet in the caches.
//!
//! The seconds are those within the march alone. What other work takes of the processor meanwhile is taken off in proportion.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use tyndall_film::{Film, Layers};
use tyndall_machine::seconds_on_cores;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_scene::{Density, Scene, SceneDocument, build};
use tyndall_transport::counters::{Counters, Event};
use tyndall_transport::{Control, Estimators, RenderOptions, render_pass};
use tyndall_volumes::BrickGrid;
use tyndall_volumes::bricks::Bricks;

use super::thread_seconds;

/// Enough samples that the pools are full for most of the time.
const SAMPLES: u64 = 8;

/// Renders each scene that is there; one JSON object for each. `roof` gives values a second by bytes and threads.
pub fn measure_all(roof: &dyn Fn(usize, usize) -> f64) -> Vec<String> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!("\nthe march, {SAMPLES} samples a pixel, {threads} threads");
    println!(
        "scene    grids    cells/s  lookups/s  loads/s  of memory's roof  of the structure's  lanes  of all time"
    );
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmarks/scenes");
    let mut all = Vec::new();
    for name in ["A_cloud", "B_smoke", "D_fire", "G_wdas"] {
        match read(&folder.join(format!("{name}.toml"))) {
            Ok(scene) => all.push(measure(name, &scene, threads, roof)),
            Err(error) => println!("{name}: left out: {error}"),
        }
    }
    all
}

fn measure(name: &str, scene: &Scene, threads: usize, roof: &dyn Fn(usize, usize) -> f64) -> String {
    let bytes: usize = grids(scene).map(BrickGrid::memory_bytes).sum();
    let (start, cpu_start) = (Instant::now(), seconds_on_cores());
    let counters = count(scene, threads);
    let wall = start.elapsed().as_secs_f64() * threads as f64;
    let seconds = cpu_start.zip(seconds_on_cores()).map_or(wall, |(start, end)| end - start);
    let of_all = counters.count(Event::MarchNanosecond) as f64 * 1e-9 / wall;
    let in_march = seconds * of_all;
    // A thread does so much in its own seconds, and there are so many of them.
    let rate = |count: u64| count as f64 / in_march * threads as f64;
    let [cells, lookups, loads] =
        [counters.count(Event::Cell), counters.lookups(), counters.loads()].map(rate);
    let of_memory = loads / roof(bytes, threads);
    let of_structure = grids(scene).next().map_or(f64::NAN, |grid| {
        let [cell, density] = seconds_at_random_points(grid);
        (cells * cell + lookups * density) / threads as f64
    });
    println!(
        "{name:7} {:4.1} MB  {:5.0} M  {:7.0} M  {:5.0} M  {:14.0} %  {:15.0} %  {:3.0} %  {:8.0} %",
        bytes as f64 / 1e6,
        cells / 1e6,
        lookups / 1e6,
        loads / 1e6,
        100.0 * of_memory,
        100.0 * of_structure,
        100.0 * counters.occupancy(),
        100.0 * of_all,
    );
    format!(
        "{{\"scene\": \"{name}\", \"threads\": {threads}, \"grid_bytes\": {bytes}, \"cells_a_second\": {cells:.4e}, \
         \"lookups_a_second\": {lookups:.4e}, \"loads_a_second\": {loads:.4e}, \"share_of_memory\": {of_memory:.4}, \
         \"share_of_structure\": {of_structure:.4}, \"share_of_time\": {of_all:.4}, \"counters\": {}}}",
        counters.json()
    )
}

fn grids(scene: &Scene) -> impl Iterator<Item = &BrickGrid> {
    scene.volumes.iter().filter_map(|volume| match &volume.density {
        Density::Grid(grid) => Some(grid.as_ref()),
        _ => None,
    })
}

/// Seconds that a cell takes, and a density, at random points of a grid that do not depend on each other; on one thread.
fn seconds_at_random_points(grid: &BrickGrid) -> [f64; 2] {
    let cell = seconds_each(grid, |p| {
        let cell = grid.cell(p);
        cell.max + (cell.corner[0] ^ cell.corner[1] ^ cell.corner[2]) as f32
    });
    let density = match grid.bricks() {
        Bricks::U8(bricks) => seconds_each(grid, |p| grid.local_voxel(bricks, p)),
        Bricks::F16(bricks) => seconds_each(grid, |p| grid.local_voxel(bricks, p)),
        Bricks::F32(bricks) => seconds_each(grid, |p| grid.local_voxel(bricks, p)),
    };
    [cell, density]
}

#[inline(always)]
fn seconds_each(grid: &BrickGrid, look: impl Fn([u32; 3]) -> f32) -> f64 {
    const POINTS: u32 = 4_000_000;
    let [min, max] = grid.domain();
    let size = (max - min).to_array().map(|edge| (edge as u64).max(1));
    let (start, cpu_start) = (Instant::now(), thread_seconds());
    let mut sum = 0.0;
    for i in 0..POINTS {
        // Weyl sequences: three multiplications, and no point follows from the last.
        let p = [0x9e37_79b9_u32, 0x85eb_ca6b, 0xc2b2_ae35].map(|step| u64::from(i.wrapping_mul(step)));
        sum += look([0, 1, 2].map(|axis| ((p[axis] * size[axis]) >> 32) as u32));
    }
    black_box(sum);
    let computed = cpu_start.zip(thread_seconds()).map(|(start, end)| end - start);
    computed.unwrap_or(start.elapsed().as_secs_f64()) / f64::from(POINTS)
}

fn count(scene: &Scene, threads: usize) -> Counters {
    let [width, height] = scene.resolution;
    let mut film = Film::new(width, height, Layers::ALL).expect("the picture is small");
    film.open_range(0).expect("an empty film holds no samples");
    let options = RenderOptions {
        integrator: Integrator::Fast,
        sampler: Sampler::Independent,
        seed: 1,
        threads,
        estimators: Estimators::default(),
    };
    let control = Control::default();
    render_pass(scene, &mut film, SAMPLES, &options, &control);
    control.counters.counters()
}

fn read(path: &Path) -> Result<Scene, String> {
    let told = |error: &dyn std::fmt::Display| error.to_string();
    let document = SceneDocument::read(path).map_err(|error| told(&error))?;
    let description = document.description().map_err(|error| told(&error))?;
    Ok(build(&description, document.folder()).map_err(|error| told(&error))?.scene)
}
