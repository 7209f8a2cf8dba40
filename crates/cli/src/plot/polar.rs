//! A polar diagram: an angle from 0 (to the right) to 180 degrees above, mirrored below, and a radius by the value.

use super::{Anchor, Kind, Scale, Svg};

/// A round frame that takes curves.
pub struct Polar {
    centre: [f64; 2],
    radius: f64,
    scale: Scale,
}

impl Polar {
    /// A frame of `radius` pixels about `centre` whose radius shows numbers as `kind` around `values`.
    pub fn new(centre: [f64; 2], radius: f64, kind: Kind, values: impl Iterator<Item = f64>) -> Polar {
        Polar { centre, radius, scale: Scale::around(kind, values, [0.0, radius]) }
    }

    fn place(&self, degrees: f64, radius: f64) -> [f64; 2] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [self.centre[0] + radius * cos, self.centre[1] - radius * sin]
    }

    /// Draws rings at round numbers and spokes every 30 degrees.
    pub fn draw(&self, svg: &mut Svg) {
        for spoke in 0..12 {
            let degrees = 30.0 * f64::from(spoke);
            svg.line("grid", self.centre, self.place(degrees, self.radius));
            let [x, y] = self.place(degrees, self.radius + 16.0);
            let angle = if degrees > 180.0 { 360.0 - degrees } else { degrees };
            svg.text("small", Anchor::Middle, [x, y + 4.0], &format!("{angle}°"));
        }
        let ticks = self.scale.ticks(None);
        let rings = ticks.iter().filter(|tick| !tick.label.is_empty());
        for tick in rings.clone() {
            svg.circle("grid", self.centre, tick.pixel);
        }
        svg.circle("frame", self.centre, self.radius);
        // On the way straight up, where few phase functions have much to show.
        for tick in rings.filter(|tick| tick.pixel > 0.0) {
            let [x, y] = self.place(90.0, tick.pixel);
            svg.text("small", Anchor::Start, [x + 3.0, y + 11.0], &tick.label);
        }
    }

    /// Draws a curve through (degrees, value); values without a place are at the centre.
    pub fn curve(&self, svg: &mut Svg, colour: &str, points: &[(f64, f64)]) {
        let place = |sign: f64| {
            move |&(degrees, value): &(f64, f64)| {
                Some(self.place(sign * degrees, self.scale.at(value).unwrap_or(0.0)))
            }
        };
        svg.curve(colour, points.iter().rev().map(place(1.0)).chain(points.iter().map(place(-1.0))));
    }
}
