//! Phase functions as a picture: a polar diagram, and the values over the angle.

use tyndall_scene::PhaseCurve;

use crate::plot::{Anchor, Axes, COLOURS, Kind, Polar, Svg, legend};

/// Draws the curves; `radius` is the kind of scale of the polar diagram.
pub fn draw(curves: &[PhaseCurve], radius: Kind) -> String {
    let lines: Vec<Vec<(f64, f64)>> = curves
        .iter()
        .map(|curve| angles().into_iter().map(|angle| (angle, curve.value(angle))).collect())
        .collect();
    let values = || lines.iter().flatten().map(|point| point.1);
    let colours = || COLOURS.iter().cycle();

    let mut svg = Svg::new(920.0, 500.0 + 18.0 * curves.len() as f64);
    let scale = if radius == Kind::Log { "logarithmic" } else { "linear" };
    svg.text("title", Anchor::Start, [20.0, 28.0], "Phase function, 1/sr");
    svg.text(
        "small",
        Anchor::Start,
        [20.0, 46.0],
        &format!("light travels to the right; the radius is {scale}"),
    );

    let polar = Polar::new([230.0, 260.0], 180.0, radius, values());
    polar.draw(&mut svg);
    let axes = Axes::new([520.0, 80.0, 890.0, 440.0], [0.0, 180.0], Kind::Log, values());
    axes.draw(&mut svg, "scattering angle, degrees", Some(30.0), "phase function, 1/sr");
    for (line, colour) in lines.iter().zip(colours()) {
        polar.curve(&mut svg, colour, line);
        axes.curve(&mut svg, colour, line.iter().copied());
    }
    let names: Vec<String> =
        curves.iter().map(|curve| format!("{}, g = {:.4}", curve.name(), curve.mean_cosine())).collect();
    legend(&mut svg, [40.0, 500.0], names.iter().map(String::as_str));
    svg.finish()
}

/// Every quarter of a degree, and finer towards forward and backward, where there are peaks.
fn angles() -> Vec<f64> {
    let near = [0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2];
    let mut angles: Vec<f64> = (0..=720).map(|i| 0.25 * f64::from(i)).collect();
    angles.extend(near.iter().flat_map(|angle| [*angle, 180.0 - angle]));
    angles.sort_by(f64::total_cmp);
    angles
}
