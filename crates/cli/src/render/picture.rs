//! One picture, on its own or as a frame of an animation: rendered, saved every now and then, and written.

use std::path::Path;
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
    /// A file for the sums; the job goes on from it if it is there.
    pub checkpoint: Option<Checkpoint>,
    /// Stops by which a `.png` is brightened.
    pub exposure: f32,
    /// How progress is reported.
    pub progress: ProgressStyle,
    /// Which frame it is, of an animation.
    pub frame: Option<FramePosition>,
}

/// The checkpoint at `path`, if one is asked for: one that is there has to be gone on from.
pub fn open_checkpoint(
    path: Option<&Path>,
    every: Duration,
    resume: bool,
) -> miette::Result<Option<Checkpoint>> {
    let Some(path) = path else { return Ok(None) };
    let checkpoint = Checkpoint::open(path, every)?;
    if path.exists() && !resume {
        return Err(miette!(
            "{}: exists already; add --resume to go on from it, or name another file",
            path.display()
        ));
    }
    Ok(Some(checkpoint))
}

impl Target {
    /// Renders until the plan is fulfilled or a signal comes, and writes the picture.
    ///
    /// A frame that was interrupted is only saved to its checkpoint: a sequence has whole pictures or none. The checkpoint
    /// of a whole frame is of no more use, and goes.
    pub fn render(mut self, mut job: Job, plan: &Plan, control: &Arc<Control>) -> miette::Result<Done> {
        let mut checkpoint = self.checkpoint.take();
        if let Some(checkpoint) = checkpoint.as_ref().filter(|checkpoint| checkpoint.path().exists()) {
            job.resume(checkpoint.path())?;
        }
        let plan = match &checkpoint {
            Some(checkpoint) => plan.clone().with_passes_up_to(checkpoint.every()),
            None => plan.clone(),
        };
        let end = self.render_passes(&mut job, &plan, control, checkpoint.as_mut());
        let pictures = job.pictures();
        let is_whole = matches!(end, Ok(Done::All));
        if pictures.iter().any(|picture| picture.film.mean_sample_count() == 0.0) {
            tell("interrupted before all was rendered once; nothing is written");
            return end;
        }
        let is_frame_whole = self.frame.is_some() && is_whole;
        let mut saved = match &mut checkpoint {
            Some(checkpoint) if !is_frame_whole => checkpoint.save(&pictures[0]),
            _ => Ok(()),
        };
        if let Some(frame) = self.frame.filter(|_| !is_whole) {
            saved.into_diagnostic()?;
            tell(match &checkpoint {
                Some(checkpoint) => format!("interrupted: {frame} is in {}", checkpoint.path().display()),
                None => format!("interrupted: nothing of {frame} is written"),
            });
            return end;
        }
        if let Err(error) = write_all(&self.outputs, pictures, self.exposure) {
            if let (Some(checkpoint), true) = (&mut checkpoint, is_frame_whole) {
                saved = checkpoint.save(&pictures[0]);
            }
            let kept = checkpoint.filter(|_| saved.is_ok());
            rescue(pictures, kept.as_ref().map(Checkpoint::path));
            return Err(error.into());
        }
        saved.into_diagnostic()?;
        if let (Some(checkpoint), Some(_)) = (&checkpoint, self.frame) {
            // It may never have been written.
            let _ = std::fs::remove_file(checkpoint.path());
        }
        self.report(pictures, !is_whole);
        end
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
        let mut is_failing = false;
        let outcome = job.run(plan, control, |pictures| {
            progress.pass_done(&pictures[0].film);
            let saved = checkpoint.as_mut().and_then(|checkpoint| checkpoint.save_if_due(&pictures[0]));
            // The next may go well, and the picture itself is not lost: to stop would help nobody.
            match saved {
                Some(Err(error)) if !is_failing => {
                    tell(format!("note: no checkpoint for now: {error}"));
                    is_failing = true;
                }
                Some(Ok(())) if is_failing => {
                    tell("note: checkpoints are written again");
                    is_failing = false;
                }
                _ => {}
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

/// After a failure to write the picture: tells where its sums are, which goes on from `checkpoint`, or else are put into the
/// folder of temporary files, so that hours of rendering do not hang on one full disk.
fn rescue(pictures: &[Accumulation], checkpoint: Option<&Path>) {
    if let Some(path) = checkpoint {
        return tell(format!(
            "note: what was rendered is in {}; --resume goes on from it, and `tyndall merge` makes a picture of it",
            path.display()
        ));
    }
    // An .acc file holds one film.
    let [picture] = pictures else { return };
    let path = std::env::temp_dir().join(format!("tyndall-rescued-{}.acc", std::process::id()));
    if picture.write(&path).is_ok() {
        tell(format!(
            "note: what was rendered is in {}; `tyndall merge` makes a picture of it",
            path.display()
        ));
    }
}
