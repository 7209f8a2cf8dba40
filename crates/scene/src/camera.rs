//! The camera: perspective (a pinhole, or a thin lens of finite aperture) or orthographic.
//!
//! A point of the film goes through the centre of the lens to the point in focus; a thin lens sends all rays
//! from that film point through the same point in focus (Kolb, Mitchell & Hanrahan 1995, section 2). Pixels
//! are filtered by a box: a film point is uniform in its pixel.

use glam::DVec3;

use crate::description::{CameraDescription, Projection};

/// A half-line; `direction` is of unit length, except in the local coordinates of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins.
    pub origin: DVec3,
    /// Where it goes.
    pub direction: DVec3,
}

impl Ray {
    /// The point at the distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A camera ready to make rays.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    position: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    is_orthographic: bool,
    /// Left, right, bottom and top edge of the film: at distance 1 from the lens, or in scene units of parallel rays.
    window: [f64; 4],
    /// Columns and rows of all of the film.
    full_resolution: [u32; 2],
    /// Left column and top row of the picture in it.
    corner: [u32; 2],
    /// Columns and rows of the picture.
    resolution: [u32; 2],
    aperture_radius: f64,
    focus_distance: f64,
}

impl Camera {
    /// The camera of a description without [violations](crate::SceneDescription::violations), for a film of
    /// `full_resolution` pixels, which are square unless the camera's window says otherwise, of which the picture is the
    /// `crop`: left column, top row, width, height.
    pub fn new(description: &CameraDescription, full_resolution: [u32; 2], crop: Option<[u32; 4]>) -> Self {
        let position = DVec3::from_array(description.position);
        let to_target = description.target.map(|target| DVec3::from_array(target) - position);
        let view = description.direction.map(DVec3::from_array).or(to_target).unwrap_or(DVec3::NEG_Z);
        let forward = view.normalize_or(DVec3::NEG_Z);
        let right =
            forward.cross(DVec3::from_array(description.up)).normalize_or(forward.any_orthonormal_vector());
        let is_orthographic = description.projection == Projection::Orthographic;
        let half_height = match description.height {
            Some(height) if is_orthographic => 0.5 * height,
            _ => libm::tan(0.5 * description.vertical_fov.to_radians()),
        };
        let half_width = half_height * f64::from(full_resolution[0]) / f64::from(full_resolution[1]);
        let [left, top, width, height] = crop.unwrap_or([0, 0, full_resolution[0], full_resolution[1]]);
        Self {
            position,
            forward,
            right,
            up: right.cross(forward),
            is_orthographic,
            window: description.window.unwrap_or([-half_width, half_width, -half_height, half_height]),
            full_resolution,
            corner: [left, top],
            resolution: [width, height],
            aperture_radius: description.aperture_radius,
            focus_distance: description
                .focus_distance
                .unwrap_or_else(|| to_target.map_or(1.0, DVec3::length)),
        }
    }

    /// Width and height of the picture, pixels.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }

    /// Where all rays begin, if they do so in one place.
    pub fn pinhole(&self) -> Option<DVec3> {
        (!self.is_orthographic && self.aperture_radius == 0.0).then_some(self.position)
    }

    /// Whether [`ray`](Self::ray) depends on the place on the lens.
    pub fn has_lens(&self) -> bool {
        !self.is_orthographic && self.aperture_radius > 0.0
    }

    /// The direction the camera looks in, of unit length.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The ray through a point of a pixel (column, row; row 0 is the top) and a point of the lens.
    ///
    /// `film_u` in [0, 1)² is the place in the pixel from its left upper corner, `lens_u` in [0, 1)² that on
    /// the lens.
    pub fn ray(&self, pixel: [u32; 2], film_u: [f64; 2], lens_u: [f64; 2]) -> Ray {
        let along = |axis: usize| {
            (f64::from(self.corner[axis] + pixel[axis]) + film_u[axis])
                / f64::from(self.full_resolution[axis])
        };
        let [left, right, bottom, top] = self.window;
        let x = left + (right - left) * along(0);
        let y = top + (bottom - top) * along(1);
        if self.is_orthographic {
            let origin = self.position + x * self.right + y * self.up;
            return Ray { origin, direction: self.forward };
        }
        let through_centre = self.forward + x * self.right + y * self.up;
        if self.aperture_radius == 0.0 {
            return Ray { origin: self.position, direction: through_centre.normalize() };
        }
        let [lens_x, lens_y] = concentric_disc(lens_u).map(|coordinate| coordinate * self.aperture_radius);
        let on_lens = lens_x * self.right + lens_y * self.up;
        let direction = (through_centre * self.focus_distance - on_lens).normalize();
        Ray { origin: self.position + on_lens, direction }
    }
}

/// The unit square to the unit disc, areas kept and neighbours kept together (Shirley & Chiu 1997).
fn concentric_disc(u: [f64; 2]) -> [f64; 2] {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    let [a, b] = u.map(|coordinate| 2.0 * coordinate - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * b / a) } else { (b, FRAC_PI_2 - FRAC_PI_4 * a / b) };
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description() -> CameraDescription {
        CameraDescription {
            position: [0.0, 0.0, 5.0],
            target: Some([0.0, 0.0, 0.0]),
            direction: None,
            up: [0.0, 1.0, 0.0],
            projection: Projection::Perspective,
            height: None,
            window: None,
            inside: None,
            vertical_fov: 90.0,
            aperture_radius: 0.0,
            focus_distance: None,
        }
    }

    fn camera(aperture_radius: f64) -> Camera {
        Camera::new(&CameraDescription { aperture_radius, ..description() }, [200, 100], None)
    }

    const CENTRE: [f64; 2] = [0.5, 0.5];

    #[test]
    fn seen_from_plus_z_world_x_is_on_the_right_and_y_is_at_the_top() {
        let right = camera(0.0).ray([199, 50], CENTRE, CENTRE).direction;
        let top = camera(0.0).ray([100, 0], CENTRE, CENTRE).direction;
        assert!(right.x > 0.8 && right.z < 0.0, "{right}");
        assert!(top.y > 0.6 && top.z < 0.0, "{top}");
    }

    #[test]
    fn the_edges_of_the_film_are_at_the_field_of_view() {
        let top = camera(0.0).ray([100, 0], [0.0, 0.0], CENTRE).direction;
        assert!((top - DVec3::new(0.0, 1.0, -1.0).normalize()).length() < 1e-12, "{top}");
        let left = camera(0.0).ray([0, 50], [0.0, 0.0], CENTRE).direction;
        assert!((left - DVec3::new(-2.0, 0.0, -1.0).normalize()).length() < 1e-12, "{left}");
    }

    #[test]
    fn a_crop_is_the_same_pixels_of_the_whole_picture() {
        let mut description = description();
        description.aperture_radius = 0.0;
        let whole = Camera::new(&description, [200, 100], None);
        let part = Camera::new(&description, [200, 100], Some([30, 20, 50, 60]));
        assert_eq!(part.resolution(), [50, 60]);
        assert_eq!(part.ray([3, 5], CENTRE, CENTRE), whole.ray([33, 25], CENTRE, CENTRE));
    }

    #[test]
    fn a_window_takes_the_place_of_the_angle_and_mirrors() {
        let window = CameraDescription { window: Some([2.0, -2.0, -1.0, 1.0]), ..description() };
        let [mirrored, plain] = [&window, &description()].map(|camera| Camera::new(camera, [200, 100], None));
        let direction = |camera: &Camera, column| camera.ray([column, 30], CENTRE, CENTRE).direction;
        assert!((direction(&mirrored, 20) - direction(&plain, 179)).length() < 1e-12);
    }

    #[test]
    fn orthographic_rays_are_parallel_and_as_far_apart_as_the_height_says() {
        let description =
            CameraDescription { projection: Projection::Orthographic, height: Some(4.0), ..description() };
        let camera = Camera::new(&description, [200, 100], None);
        let [top, bottom] = [0, 99].map(|row| camera.ray([7, row], CENTRE, CENTRE));
        assert_eq!(top.direction, DVec3::NEG_Z);
        assert_eq!(bottom.direction, DVec3::NEG_Z);
        assert!(((top.origin - bottom.origin) - DVec3::new(0.0, 3.96, 0.0)).length() < 1e-12);
        let right = camera.ray([199, 50], CENTRE, CENTRE).origin;
        assert!((right.x - 3.98).abs() < 1e-12, "{right}");
    }

    #[test]
    fn all_rays_of_a_film_point_meet_in_the_plane_of_focus() {
        let lens = camera(0.3);
        for pixel in [[100, 50], [13, 77], [199, 0]] {
            let pinhole = camera(0.0).ray(pixel, CENTRE, CENTRE);
            let in_focus = pinhole.origin + pinhole.direction * (-5.0 / pinhole.direction.z);
            for lens_u in [[0.0, 0.0], [0.9, 0.1], [0.3, 0.99], [0.5, 0.5]] {
                let ray = lens.ray(pixel, CENTRE, lens_u);
                assert!((ray.direction.length() - 1.0).abs() < 1e-12);
                assert!((ray.origin - pinhole.origin).length() <= 0.3 + 1e-12);
                let at_plane = ray.origin + ray.direction * (-5.0 / ray.direction.z);
                assert!((at_plane - in_focus).length() < 1e-9, "{at_plane} {in_focus}");
            }
        }
    }

    #[test]
    fn lens_points_are_uniform_on_the_disc() {
        // Half the area lies within 1/sqrt(2) of the centre, a quarter in each quadrant.
        let count = 1000;
        let points: Vec<[f64; 2]> = (0..count * count)
            .map(|i| [i % count, i / count].map(|k| (f64::from(k) + 0.5) / f64::from(count)))
            .map(concentric_disc)
            .collect();
        let fraction = |is_in: fn(&[f64; 2]) -> bool| {
            points.iter().filter(|point| is_in(point)).count() as f64 / points.len() as f64
        };
        assert!((fraction(|[x, y]| x * x + y * y < 0.5) - 0.5).abs() < 2e-3);
        assert!((fraction(|[x, y]| *x > 0.0 && *y > 0.0) - 0.25).abs() < 2e-3);
        assert!(fraction(|[x, y]| x * x + y * y > 1.0 + 1e-12) == 0.0);
    }
}
