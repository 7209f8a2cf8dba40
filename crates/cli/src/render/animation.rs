//! `--frames`: one picture a frame, the next scene read and built while the present one renders.
//!
//! Memory is that of two frames at most: a scene is begun when the one before the present is gone.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;

use miette::miette;
use tyndall_session::{
    Frames, Input, Job, JobOptions, Output, Plan, SessionError, check_no_input, check_writable,
    file_at_frame, is_rendered,
};
use tyndall_transport::Control;

use super::picture::{Target, open_checkpoint};
use super::progress::FramePosition;
use super::{Args, job_options, outputs};
use crate::Done;
use crate::interrupt::stop_on_signals;
use crate::terminal::tell;

/// What there is to do for a frame.
enum Prepared {
    /// Nothing: its pictures are there.
    Rendered,
    /// This, to where the plan says, and stops by which its `.png` is brightened.
    ToRender(Box<Job>, Plan, f32),
}

/// Renders one frame after the other.
pub fn run(args: &Args, input: Input, frames: Frames) -> miette::Result<Done> {
    let outputs = outputs(args, &input)?;
    input.check_frames(&frames)?;
    check_files(args, &input, &outputs, &frames)?;
    args.estimators.tell_integrator(args.integrator);
    let control = Arc::new(Control::default());
    stop_on_signals(&control.cancel)?;
    let frame_maker = Arc::new(FrameMaker { options: job_options(args), outputs, args: args.clone(), input });
    let mut notes = HashSet::new();
    let mut numbers = frames.iter();
    let mut next = numbers.next().map(|frame| frame_maker.begin(frame)).transpose()?;
    let mut position = 0;
    let mut skipped = 0_u64;
    while let Some((frame, building)) = next {
        let prepared = building.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        next = numbers.next().map(|frame| frame_maker.begin(frame)).transpose()?;
        position += 1;
        if control.cancel.load(Ordering::Relaxed) {
            return Ok(Done::Interrupted);
        }
        let Prepared::ToRender(job, plan, exposure) = prepared else {
            skipped += 1;
            continue;
        };
        let new_notes = job.notes().iter().filter(|note| notes.insert((*note).clone()));
        new_notes.for_each(|note| tell(format!("note: {note}")));
        let checkpoint = args.checkpoint.as_deref().map(|path| file_at_frame(path, frame));
        let target = Target {
            outputs: frame_maker.outputs_at(frame),
            checkpoint: open_checkpoint(checkpoint.as_deref(), args.checkpoint_every, args.resume)?,
            exposure,
            progress: args.progress,
            frame: Some(FramePosition { frame, position, count: frames.count() }),
        };
        if let Done::Interrupted = target.render(*job, &plan, &control)? {
            // What is being built for the next frame ends with the program.
            return Ok(Done::Interrupted);
        }
    }
    if skipped > 0 {
        tell(format!("{skipped} of {} frames were there already", frames.count()));
    }
    Ok(Done::All)
}

/// Refuses files that cannot be made, and checkpoints that are not to be gone on from.
fn check_files(args: &Args, input: &Input, outputs: &[Output], frames: &Frames) -> miette::Result<()> {
    let patterns: Vec<&Path> = outputs.iter().map(Output::path).chain(args.checkpoint.as_deref()).collect();
    let mut folders = HashSet::new();
    for frame in frames.iter() {
        let files: Vec<PathBuf> = patterns.iter().map(|path| file_at_frame(path, frame)).collect();
        let files = || files.iter().map(PathBuf::as_path);
        // Folders may depend on the frame, and one that cannot be written to is better found before the first.
        if files().any(|file| folders.insert(file.parent().map(Path::to_owned))) {
            check_writable(files())?;
            check_no_input(files(), input)?;
        }
    }
    let Some(checkpoint) = args.checkpoint.as_deref().filter(|_| !args.resume) else { return Ok(()) };
    match frames.iter().map(|frame| file_at_frame(checkpoint, frame)).find(|path| path.exists()) {
        Some(path) => Err(miette!(
            "{}: exists already; add --resume to go on from it, or name another file",
            path.display()
        )),
        None => Ok(()),
    }
}

/// A frame that is being prepared.
type Preparation = JoinHandle<Result<Prepared, SessionError>>;

/// Makes the scenes of frames ready.
struct FrameMaker {
    args: Args,
    input: Input,
    options: JobOptions,
    outputs: Vec<Output>,
}

impl FrameMaker {
    /// Begins to prepare a frame on a thread of its own.
    fn begin(self: &Arc<Self>, frame: u32) -> miette::Result<(u32, Preparation)> {
        let maker = Arc::clone(self);
        let thread = std::thread::Builder::new().spawn(move || maker.prepare(frame));
        Ok((frame, thread.map_err(|error| miette!("--frames: no thread for the next frame: {error}"))?))
    }

    fn prepare(&self, frame: u32) -> Result<Prepared, SessionError> {
        let input = self.input.at_frame(frame)?;
        let description = input.description();
        let plan = self.args.goal.with_samples(self.args.samples.clone()).plan(description.render.spp);
        let outputs = self.outputs_at(frame);
        if self.args.resume && is_rendered(&input, &self.options, &plan, &outputs)? {
            return Ok(Prepared::Rendered);
        }
        check_writable(outputs.iter().map(Output::path))?;
        let exposure = self.args.exposure.unwrap_or(description.film.exposure) as f32;
        Ok(Prepared::ToRender(Box::new(Job::new(&input, &self.options)?), plan, exposure))
    }

    fn outputs_at(&self, frame: u32) -> Vec<Output> {
        self.outputs.iter().map(|output| output.at_frame(frame)).collect()
    }
}
