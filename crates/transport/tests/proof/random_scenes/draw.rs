//! Draws the text of a scene file at random: one number, one scene.
//!
//! What a scene may hold: one to three volumes (rough grids, a procedural cumulus, boxes, spheres, a medium everywhere), grey
//! or chromatic, of any albedo and phase function, some of which glow; up to three lights of all kinds; in every third scene
//! surfaces, of all kinds of materials; cameras of all kinds, in front of the media or among them; a limit on depth.
//! Point lights keep their distance from the media, but for a medium everywhere: inside, 1/d² has no finite variance, and
//! without one the tests know no level.

use tyndall_lanes::Random;

use crate::surfaces::MATERIALS;

/// The scene of this number, as the text of a scene file; its grid is `random.npy`.
pub fn scene(number: u64) -> String {
    let mut draw = Draw { random: Random::new(number, 0x7363_656e, 0) };
    let has_surfaces = draw.chance(0.35);
    let is_everywhere = draw.chance(0.2);
    let count = 1 + draw.below(3);
    let volumes: Vec<String> = (0..count).map(|_| draw.volume()).collect();
    let mut lights: Vec<String> = (0..draw.below(4)).map(|_| draw.light()).collect();
    if lights.is_empty() && !volumes.iter().any(|volume| volume.contains("emission")) {
        lights.push(draw.light());
    }
    let mut text = draw.camera();
    text += "film = { resolution = [24, 24] }\n";
    if draw.chance(0.3) {
        text += &format!("render = {{ max_depth = {} }}\n", draw.below(6));
    }
    if is_everywhere {
        text += &draw.medium_everywhere();
    }
    text += &volumes.concat();
    text += &lights.concat();
    if has_surfaces {
        text += &draw.surfaces();
        text += MATERIALS;
    }
    text
}

struct Draw {
    random: Random,
}

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        // Short numbers, as somebody may have to read them.
        ((low + (high - low) * self.random.f64()) * 1e3).round() * 1e-3
    }

    /// Evenly over the powers between.
    fn log_within(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    fn below(&mut self, end: usize) -> usize {
        (self.random.f64() * end as f64) as usize
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.random.f64() < probability
    }

    /// Uniform in a cube of half this edge length.
    fn place(&mut self, reach: f64) -> String {
        format!("{:.3?}", [0; 3].map(|_| self.within(-reach, reach)))
    }

    /// On a sphere.
    fn place_at(&mut self, distance: f64) -> String {
        let direction = crate::scenes::random_direction(&mut self.random);
        format!("{:.3?}", (direction * distance).to_array())
    }

    fn colour(&mut self, low: f64, high: f64) -> String {
        match self.chance(0.3) {
            true => format!("{:.3}", self.within(low, high)),
            false => format!("{:.3?}", [0; 3].map(|_| self.within(low, high))),
        }
    }

    fn camera(&mut self) -> String {
        let position = match self.chance(0.25) {
            true => self.place(0.5),
            false => {
                let distance = self.within(2.8, 4.0);
                self.place_at(distance)
            }
        };
        let target = self.place(0.2);
        let view = match self.below(3) {
            0 => format!("projection = \"orthographic\", height = {:.3}", self.within(1.5, 3.0)),
            1 => format!(
                "vertical_fov = {:.3}, aperture_radius = {:.3}",
                self.within(25.0, 50.0),
                self.within(0.01, 0.3)
            ),
            _ => format!("vertical_fov = {:.3}", self.within(25.0, 70.0)),
        };
        format!("camera = {{ position = {position}, target = {target}, up = [0.1, 1, 0.2], {view} }}\n")
    }

    fn volume(&mut self) -> String {
        let rotation = format!("{:.0?}", [0; 3].map(|_| self.within(0.0, 360.0)));
        let shape = match self.below(5) {
            0 | 1 => {
                let scale = self.within(0.06, 0.13);
                let corner = format!("{:.3?}", [0; 3].map(|_| self.within(-0.9, 0.0)));
                let storage = ["u8", "f16", "f32"][self.below(3)];
                let filter = ["trilinear", "nearest"][usize::from(self.chance(0.2))];
                format!(
                    "file = \"random.npy\"\nstorage = \"{storage}\"\nfilter = \"{filter}\"\n\
                     transform = {{ scale = {scale:.3}, rotate = {rotation}, translate = {corner} }}\n"
                )
            }
            2 => format!(
                "procedural = {{ type = \"cumulus\", seed = {}, resolution = 24, size = {:.3} }}\n",
                self.below(100),
                self.within(1.0, 2.2)
            ),
            3 => {
                let centre = self.place(0.6);
                format!("sphere = {{ center = {centre}, radius = {:.3} }}\n", self.within(0.2, 0.9))
            }
            _ => {
                let [low, high] = [(-0.9, -0.1), (0.1, 0.9)]
                    .map(|(low, high)| format!("{:.3?}", [0; 3].map(|_| self.within(low, high))));
                format!("box = {{ min = {low}, max = {high} }}\ntransform = {{ rotate = {rotation} }}\n")
            }
        };
        format!("[[volume]]\n{shape}{}", self.medium((0.3, 12.0), 1.0))
    }

    /// Thin, and it absorbs, as it does not end.
    fn medium_everywhere(&mut self) -> String {
        format!("[medium]\n{}", self.medium((0.05, 0.3), 0.8))
    }

    fn medium(&mut self, mu_t: (f64, f64), greatest_albedo: f64) -> String {
        let mu_t = match self.chance(0.2) {
            true => format!("{:.3?}", [0; 3].map(|_| self.log_within(mu_t.0, mu_t.1))),
            false => format!("{:.3}", self.log_within(mu_t.0, mu_t.1)),
        };
        let albedo = match self.below(8) {
            0 => "0".to_owned(),
            1 => format!("{greatest_albedo}"),
            _ => self.colour(0.0, greatest_albedo),
        };
        let mut text = format!("mu_t = {mu_t}\nalbedo = {albedo}\nphase = {}\n", self.phase());
        match self.below(7) {
            0 => text += &format!("emission = {}\n", self.colour(0.0, 2.0)),
            1 => text += &format!("emission_per_length = {}\n", self.colour(0.0, 2.0)),
            _ => {}
        }
        text
    }

    fn phase(&mut self) -> String {
        let parameters = match self.below(10) {
            0 => "\"isotropic\"".to_owned(),
            1 => "\"rayleigh\"".to_owned(),
            2 => format!(
                "\"double_hg\", g1 = {:.3}, g2 = {:.3}, weight = {:.3}",
                self.within(0.0, 0.9),
                self.within(-0.6, 0.0),
                self.within(0.0, 1.0)
            ),
            3 => format!("\"schlick\", k = {:.3}", self.within(-0.5, 0.8)),
            4 => {
                format!("\"draine\", g = {:.3}, alpha = {:.3}", self.within(-0.5, 0.8), self.within(0.0, 2.0))
            }
            5 => format!("\"fog\", droplet_diameter_um = {:.3}", self.within(0.5, 20.0)),
            6 => {
                let kind = ["surface", "fibre"][self.below(2)];
                let axis = self.place_at(1.0);
                format!(
                    "\"sggx\", kind = \"{kind}\", axis = {axis}, roughness = {:.3}",
                    self.within(0.1, 1.0)
                )
            }
            _ => format!("\"hg\", g = {:.3}", self.within(-0.6, 0.9)),
        };
        format!("{{ type = {parameters} }}")
    }

    fn light(&mut self) -> String {
        let colour = self.colour(0.1, 1.0);
        let direction = self.place_at(1.0);
        let parameters = match self.below(5) {
            0 => format!("\"constant\"\nradiance = {colour}"),
            1 => format!("\"distant\"\ndirection = {direction}\nirradiance = {colour}"),
            2 => format!(
                "\"sun\"\ndirection = {direction}\nirradiance = {colour}\nangular_diameter = {:.3}",
                self.within(0.5, 20.0)
            ),
            3 => format!("\"point\"\nposition = {}\nintensity = {colour}", self.place_at(2.0)),
            _ => {
                let [inner, outer] = [self.within(5.0, 20.0), self.within(25.0, 60.0)];
                let place = self.random_place_and_inward(2.2);
                format!(
                    "\"spot\"\n{place}\nintensity = {colour}\ninner_angle = {inner:.3}\nangle = {outer:.3}"
                )
            }
        };
        format!("[[light]]\ntype = {parameters}\n")
    }

    fn random_place_and_inward(&mut self, distance: f64) -> String {
        let outward = crate::scenes::random_direction(&mut self.random);
        let [place, inward] = [outward * distance, -outward].map(|v| format!("{:.3?}", v.to_array()));
        format!("position = {place}\ndirection = {inward}")
    }

    /// A floor, some things, and a lamp.
    fn surfaces(&mut self) -> String {
        let mut text = String::new();
        if self.chance(0.6) {
            let material = ["white", "grey", "chequered"][self.below(3)];
            text += &format!(
                "[[shape]]\nplane = {{ point = [0, -1, 0], normal = [0, 1, 0] }}\nmaterial = \"{material}\"\n"
            );
        }
        for _ in 0..self.below(3) {
            let material = ["white", "chequered", "mirror", "glass", "pane", "lattice"][self.below(6)];
            let centre = self.place(0.7);
            let shape = match self.below(2) {
                0 => format!("sphere = {{ center = {centre}, radius = {:.3} }}", self.within(0.1, 0.4)),
                _ => {
                    let [u, v] = [0; 2].map(|_| {
                        let length = self.within(0.3, 0.9);
                        self.place_at(length)
                    });
                    format!("rectangle = {{ corner = {centre}, u = {u}, v = {v} }}")
                }
            };
            text += &format!("[[shape]]\n{shape}\nmaterial = \"{material}\"\n");
        }
        if self.chance(0.5) {
            let interior = self.medium((0.5, 6.0), 0.95);
            let centre = self.place(0.5);
            text += &format!(
                "[[volume]]\nname = \"inside\"\n{interior}[[shape]]\n\
                 sphere = {{ center = {centre}, radius = {:.3} }}\nmaterial = \"{}\"\ninterior = \"inside\"\n",
                self.within(0.2, 0.5),
                ["none", "glass"][self.below(2)]
            );
        }
        if self.chance(0.7) {
            let radiance = self.colour(0.5, 4.0);
            let two_sided = self.chance(0.5);
            text += &format!(
                "[[shape]]\nrectangle = {{ corner = [-0.4, 1.6, -0.3], u = [0.8, 0, 0], v = [0, 0.1, 0.6] }}\n\
                 material = \"grey\"\nemission = {{ radiance = {radiance}, two_sided = {two_sided} }}\n"
            );
        }
        text
    }
}
