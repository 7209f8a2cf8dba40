use glam::{DVec3, DAffine3};
use std::sync::Arc;
use tyndall_scene::*;
use tyndall_transport::*;
use tyndall_film::*;
use tyndall_volumes::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let which = &a[1];
    let spp: u64 = a[2].parse().unwrap();
    let reference = a.get(3).map(|s| s == "reference").unwrap_or(false);
    let storage = match a.get(4).map(|s| s.as_str()) { Some("u8") => Storage::U8, Some("f32") => Storage::F32, _ => Storage::F16 };
    let out = a.get(5).cloned().unwrap_or("/tmp/out.exr".into());
    let sh = "/work/shared/";
    let (file, mu_t, g, camera, sky, sun, dir) = if which == "A" {
        (format!("{sh}bench/cloud.vdb"), 50.0, 0.85, Camera::new(DVec3::new(0.,0.3,3.4), DVec3::ZERO, 40., [256,256]), DVec3::new(0.5,0.7,1.0), DVec3::new(5.,4.7,4.2), DVec3::new(-0.5,-1.,-0.3))
    } else {
        (format!("{sh}volumes/wdas_cloud_sixteenth.vdb"), 0.25, 0.8, Camera::new(DVec3::new(520.,150.,560.), DVec3::new(-11.67,66.,-45.), 32., [256,256]), DVec3::new(0.35,0.5,0.8), DVec3::new(6.,5.4,4.6), DVec3::new(-1.,-0.6,0.2))
    };
    let t0 = std::time::Instant::now();
    let grids = vdb::read(std::path::Path::new(&file), &GridSelection::All).unwrap().grids;
    let t1 = t0.elapsed();
    let grid = &grids[0];
    let bricks = BrickGrid::new(grid, storage).unwrap();
    eprintln!("read {:?} build {:?} bricks {} memory {} domain {:?} bounds {:?}", t1, t0.elapsed()-t1, bricks.brick_count(), bricks.memory_bytes(), bricks.domain(), bricks.bounds());
    let scene = Scene {
        camera, resolution: [256,256],
        volumes: vec![Volume { name: "v".into(), world_to_local: grid.index_to_world.inverse(), density: Density::Grid(Arc::new(bricks)),
            medium: Medium { mu_t, albedo: DVec3::splat(0.999), phase_function: tyndall_optics::PhaseFunction::HenyeyGreenstein { g }, emission: DVec3::ZERO } }],
        lights: vec![Light::Constant(sky), Light::Distant { toward: -dir.normalize(), irradiance: sun }],
        light_probabilities: vec![0.0, 1.0], max_depth: None,
    };
    let _ = DAffine3::IDENTITY;
    let mut film = Film::new(256,256, Layers::ALL).unwrap();
    film.open_range(0).unwrap();
    let t = std::time::Instant::now();
    let integrator = if reference { description::Integrator::Reference } else { description::Integrator::Fast };
    render_pass(&scene, &mut film, spp, &RenderOptions { integrator, seed: 1, threads: a.get(6).map_or(2, |s| s.parse().unwrap()) }, &Control::default());
    let s = t.elapsed().as_secs_f64();
    film.complete_through(spp).unwrap();
    eprintln!("seconds {s:.3}");
    println!("{s:.4}");
    let _ = write_exr(std::path::Path::new(&out), &film, &Default::default());
}
