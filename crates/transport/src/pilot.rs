//! The pilot of adaptive sampling: a few samples a pixel, by which the pixels of a picture get different numbers of them.

use std::sync::Arc;

use tyndall_film::{Film, Layers, Rates, SizeError};
use tyndall_scene::description::Sampler;

use crate::render::{Control, Outcome, RenderOptions, Renderer};

/// Samples of a pixel. The 49 pixels around one tell a variance from 196 of them, to some 10 % where noise is mild.
const SAMPLES: u64 = 4;

impl Renderer<'_> {
    /// How many samples each pixel of such a film is to get (see [`Rates`]); `None` if the render was cancelled.
    ///
    /// It is a function of the scene, the integrator, its estimators and the seed: all parts of a picture have the same. Its samples are
    /// independent of the picture's.
    ///
    /// # Errors
    /// If there is no memory for another film.
    pub fn rates(
        &self,
        film: &Film,
        options: &RenderOptions,
        control: &Control,
    ) -> Result<Option<Rates>, SizeError> {
        // Asks for memory to be written as well, of which it needs less for the rates.
        let mut pilot = Film::new(film.width(), film.height(), Layers { effort: true, ..Layers::NONE })?;
        pilot.open_range(0).expect("an empty film takes all samples");
        // Scenes have seeds of 32 bits. That samples are spread evenly takes no noise from others'.
        let options = RenderOptions { seed: !options.seed, sampler: Sampler::Independent, ..*options };
        let control = Control { cancel: Arc::clone(&control.cancel), ..Control::default() };
        if self.render_pass(&mut pilot, SAMPLES, &options, &control) == Outcome::Cancelled {
            return Ok(None);
        }
        pilot.complete_through(SAMPLES).expect("the pass is complete");
        Ok(Some(Rates::of_pilot(&pilot)))
    }
}
