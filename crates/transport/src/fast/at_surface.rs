//! A path's turn at a surface: the way there, the lights that are looked at from it, and how the path goes on.

use super::next_event::choose_correction;
use super::sided::{Direct, draw_light, light_of};
use super::{Engine, Next, survives_roulette};
use crate::counters::{self, Event};
use crate::first_draws::FirstDraws;
use crate::found_light;
use crate::shadow_catcher;
use crate::surface_vertex::SurfaceVertex;
use glam::Vec3;

impl Engine<'_, '_> {
    /// Finds the surface at which the path's ray ends; its distance.
    #[inline(always)]
    pub(super) fn look_ahead(&mut self, slot: usize) -> f32 {
        counters::count(Event::Intersection, 1);
        self.sided[slot].look_ahead(self.scene.scene, &mut self.rays.random[slot]);
        self.sided[slot].way.end as f32
    }

    /// The path's ray has gone through all volumes to a surface, or past all: the surface's own light is gathered, a light
    /// is chosen, a direction drawn.
    #[inline(never)]
    pub(super) fn arrive(&mut self, slot: usize) -> Next {
        let Some(hit) = self.sided[slot].way.hit else { return self.escape(slot) };
        let scene = self.scene.scene;
        let sided = &mut self.sided[slot];
        let path = &mut self.paths[slot];
        let random = &mut self.rays.random[slot];
        let lamp = found_light::lamp(scene, &hit, sided.ray.direction, path.turned()).as_vec3();
        path.add_in_scattered(path.throughput * lamp);

        let vertex = sided.vertex(scene, &hit);
        if path.turns == 0 {
            let mut first = vertex.first_met(scene, vertex.albedo().truncate());
            if vertex.is_shadow_catcher(scene) {
                first.caught = Some(shadow_catcher::reflected(scene, &vertex, &sided.presence, random));
            }
            path.first = path.first.or(Some(first));
            if first.caught.is_some() {
                return Next::Record;
            }
        }
        if scene.max_depth.is_some_and(|depth| path.turns >= depth) {
            return Next::Record;
        }
        path.turns += 1;
        path.position = (vertex.position() - self.scene.centre).as_vec3();

        let mut traced = false;
        if path.turns == 1 && !self.scene.seen_at_once.is_empty() {
            for &number in &self.scene.seen_at_once {
                let value = |toward| (vertex.value(toward).truncate(), 0.0);
                if let Some(Direct { unshadowed, toward, distance, .. }) =
                    light_of(self.scene, (number, 1.0), vertex.position(), value, path.draws, random)
                    && unshadowed != Vec3::ZERO
                    && sided.sees_from(scene, &vertex, toward, distance, random)
                {
                    sided.waiting.push((path.throughput * unshadowed, toward.as_vec3(), distance as f32));
                }
            }
            path.direct_is_glow = false;
        } else if !vertex.is_delta() {
            let value = |toward| (vertex.value(toward).truncate(), vertex.pdf(toward));
            let way = if self.scene.knows_all_lights {
                choose_correction(self.scene, vertex.position(), path, value, false, random)
            } else {
                let direct = draw_light(self.scene, vertex.position(), value, path.draws, random);
                direct.filter(|direct| direct.unshadowed != Vec3::ZERO).map(|direct| {
                    let way = (direct.toward, direct.distance);
                    path.look(path.throughput * direct.unshadowed, direct.is_glow, way);
                    way
                })
            };
            traced = way
                .is_some_and(|(toward, distance)| sided.sees_from(scene, &vertex, toward, distance, random));
        }

        if path.turns == 1 && !vertex.is_delta() {
            self.split(slot, 0, Some(&vertex));
        }
        self.turn_at(slot, &vertex);
        let traced = traced || self.next_light(slot);
        self.turned(slot, traced)
    }

    /// The path goes on in another direction from the surface where it is, or ends there.
    #[inline(always)]
    pub(super) fn turn_at(&mut self, slot: usize, vertex: &SurfaceVertex) {
        let (path, sided) = (&mut self.paths[slot], &mut self.sided[slot]);
        let random = &mut self.rays.random[slot];
        let [u, v] = path.draws.direction(random).map(f64::from);
        path.draws = FirstDraws::Independent;
        let onward = vertex.sample_by(random.f64(), [u, v]).filter(|onward| {
            path.throughput *= onward.weight.truncate().as_vec3();
            sided.refraction *= onward.radiance_scale;
            survives_roulette(path, sided.refraction as f32, self.scene.roulette_throughput, random)
        });
        match onward {
            Some(onward) => {
                path.direction = onward.direction.as_vec3();
                path.turned = onward.pdf.map(|_| vertex.position());
                path.turn_pdf = onward.pdf.unwrap_or_default() as f32;
                sided.leave(self.scene.scene, vertex, onward.direction);
            }
            None => path.throughput = Vec3::ZERO,
        }
    }

    /// Turns to a light that waits to be looked at from the path's surface, if there is one.
    #[inline(always)]
    pub(super) fn next_light(&mut self, slot: usize) -> bool {
        let Some((direct, toward, distance)) = self.sided.get_mut(slot).and_then(|sided| sided.waiting.pop())
        else {
            return false;
        };
        let path = &mut self.paths[slot];
        (path.direct, path.shadow_direction, path.light_distance) = (direct, toward, distance);
        true
    }
}
