//! The clear sky at four heights of the sun, as pictures: `cargo run --release --example sky`.

use tyndall_scene::description::SkyDescription;
use tyndall_scene::sky::Sky;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for elevation in [2.0, 10.0, 30.0, 60.0] {
        let description = SkyDescription {
            sun_elevation: Some(elevation),
            sun_azimuth: Some(45.0),
            ..SkyDescription::default()
        };
        let start = std::time::Instant::now();
        let sky = Sky::new(&description);
        let image = sky.to_image();
        let seconds = start.elapsed().as_secs_f64();

        // A curve that lets highlights roll off, then the sRGB encoding, roughly.
        let exposure = 2.0;
        let picture = image::RgbImage::from_fn(image.width() as u32, image.height() as u32, |x, y| {
            let radiance = image.texel(x as usize, y as usize) * exposure;
            let shown = radiance.to_array().map(|value| (1.0 - (-value).exp()).powf(1.0 / 2.2));
            image::Rgb(shown.map(|value| (255.0 * value + 0.5) as u8))
        });
        let file = format!("sky_{elevation:02}.png");
        picture.save(&file)?;
        println!(
            "{file}: sun {:.3}, zenith {:.4}, {seconds:.3} s",
            sky.sun_irradiance(),
            sky.radiance(glam::DVec3::Y)
        );
    }
    Ok(())
}
