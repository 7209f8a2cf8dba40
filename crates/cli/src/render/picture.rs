//! One picture, on its own or as a frame of an animation: rendered, saved every now and then, and written.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use miette::{IntoDiagnostic, miette};
use tyndall_film::{Accumulation, warnings};
use tyndall_session::{Checkpoint, Job, Output, Plan, write_all};
use tyndall_transport::{Control, Outcome, counters};

use super::progress::{FramePosition, Progress, ProgressStyle};
use crate::Done;
use crate::terminal::tell;

/// What becomes of a job.
pub struct Target {
    /// Files for the picture.
    pub outputs: Vec<Output>,
    /// A file for the sums.
    pub checkpoint: Option<PathBuf>,
    /// How often the sums are saved.
    pub checkpoint_every: Duration,
    /// Whether to go on from them.
    pub resume: bool,
    /// Stops by which a `.png` is brightened.
    pub exposure: f32,
    /// How progress is reported.
    pub progress: ProgressStyle,
    /// Which frame it is, of an animation.
    pub frame: Option<FramePosition>,
}

impl Target {
    /// Renders until the plan is fulfilled or Ctrl-C is pressed, and writes the picture.
    ///
    /// A frame that was interrupted is only saved to its checkpoint: a sequence has whole pictures or none. The checkpoint
    /// of a whole frame is of no more use, and goes.
    pub fn render(self, mut job: Job, plan: &Plan, control: &Arc<Control>) -> miette::Result<Done> {
        let mut checkpoint = self.open_checkpoint(&mut job)?;
        let plan = match checkpoint {
            Some(_) => plan.clone().with_passes_up_to(self.checkpoint_every),
            None => plan.clone(),
        };
        let end = self.render_passes(&mut job, &plan, control, checkpoint.as_mut())?;
        let pictures = job.pictures();
        let interrupted = matches!(end, Done::Interrupted);
        if pictures.iter().any(|picture| picture.film.mean_sample_count() == 0.0) {
            tell("interrupted before all was rendered once; nothing is written");
            return Ok(end);
        }
        let saved = match &mut checkpoint {
            Some(checkpoint) if self.frame.is_none() || interrupted => checkpoint.save(&pictures[0]),
            _ => Ok(()),
        };
        if let Some(frame) = self.frame.filter(|_| interrupted) {
            saved.into_diagnostic()?;
            tell(match &checkpoint {
                Some(checkpoint) => format!("interrupted: {frame} is in {}", checkpoint.path().display()),
                None => format!("interrupted: nothing of {frame} is written"),
            });
            return Ok(end);
        }
        write_all(&self.outputs, pictures, self.exposure)?;
        saved.into_diagnostic()?;
        if let (Some(checkpoint), Some(_)) = (&checkpoint, self.frame) {
            // It may never have been written.
            let _ = std::fs::remove_file(checkpoint.path());
        }
        self.report(pictures, interrupted);
        Ok(end)
    }

    /// The checkpoint that is asked for; the job goes on from it if it is there.
    fn open_checkpoint(&self, job: &mut Job) -> miette::Result<Option<Checkpoint>> {
        let Some(path) = &self.checkpoint else { return Ok(None) };
        if path.exists() {
            if !self.resume {
                return Err(miette!(
                    "{}: exists already; add --resume to go on from it, or name another file",
                    path.display()
                ));
            }
            job.resume(path)?;
        }
        Ok(Some(Checkpoint::new(path, self.checkpoint_every)))
    }

    fn render_passes(
        &self,
        job: &mut Job,
        plan: &Plan,
        control: &Arc<Control>,
        mut checkpoint: Option<&mut Checkpoint>,
    ) -> miette::Result<Done> {
        control.samples.store(0, Ordering::Relaxed);
        let progress =
            Progress::start(self.progress, job.pixels(), plan.spp(), Arc::clone(control), self.frame);
        let outcome = job.run(plan, control, |pictures| {
            progress.pass_done(&pictures[0].film);
            if let Some(checkpoint) = &mut checkpoint {
                // The next may go well, and the picture itself is not lost.
                if let Err(error) = checkpoint.save_if_due(&pictures[0]) {
                    tell(format!("note: no checkpoint: {error}"));
                }
            }
        });
        progress.finish();
        if counters::COUNTED {
            tell(format!("counters: {}", control.counters.counters().json()));
        }
        Ok(match outcome? {
            Outcome::Complete => Done::All,
            Outcome::Cancelled => Done::Interrupted,
        })
    }

    fn report(&self, pictures: &[Accumulation], interrupted: bool) {
        let film = &pictures[0].film;
        let error = film.median_relative_error().filter(|error| error.is_finite());
        let error =
            error.map_or("error not known yet".into(), |e| format!("median error {:.2} %", 100.0 * e));
        let interrupted = if interrupted { "interrupted: " } else { "" };
        let frame = self.frame.map_or(String::new(), |frame| format!("{frame}: "));
        let samples = film.mean_sample_count();
        let samples = if samples.fract() == 0.0 { format!("{samples}") } else { format!("{samples:.2}") };
        tell(format!(
            "{interrupted}{frame}{}x{}, {samples} samples a pixel, {error}, {:.1} s",
            film.width(),
            film.height(),
            pictures.iter().map(|picture| picture.metadata.seconds).fold(0.0, f64::max)
        ));
        for warning in warnings(pictures.iter().map(|picture| &picture.film)) {
            tell(format!("warning: {warning}"));
        }
        for output in &self.outputs {
            tell(format!("wrote {}", output.path().display()));
        }
    }
}
