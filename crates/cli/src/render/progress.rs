//! Progress: a bar on a terminal, or a JSON object a line.

use std::fmt;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle as BarStyle};
use serde::Serialize;
use tyndall_film::Film;
use tyndall_transport::Control;

use crate::terminal;

/// How progress is reported.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum ProgressStyle {
    /// A bar, if the output is a terminal
    #[default]
    Bar,
    /// One JSON object a line on standard output: samples, seconds, rate, error, time left
    Json,
    /// Nothing
    None,
}

/// Which frame of an animation.
#[derive(Debug, Clone, Copy)]
pub struct FramePosition {
    /// Its number.
    pub frame: u32,
    /// The how manieth it is, from 1.
    pub position: u64,
    /// How many there are.
    pub count: u64,
}

impl fmt::Display for FramePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "frame {} ({} of {})", self.frame, self.position, self.count)
    }
}

/// A line of `--progress json`.
#[derive(Serialize)]
struct Line {
    /// The frame of an animation.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<u32>,
    /// Samples a pixel so far.
    samples: f64,
    seconds: f64,
    /// Paths a second.
    rate: f64,
    /// Median relative standard error after the last whole pass.
    error: Option<f64>,
    /// Seconds left, where the number of samples is known.
    time_left: Option<f64>,
}

/// Reports from a thread of its own until [`Progress::finish`].
pub struct Progress {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    style: ProgressStyle,
    pixels: f64,
    spp: Option<f64>,
    frame: Option<FramePosition>,
    control: Arc<Control>,
    start: Instant,
    error: Mutex<Option<f64>>,
    finished: AtomicBool,
}

impl Progress {
    /// `spp` is the number of samples of each pixel, if it is known beforehand.
    pub fn start(
        style: ProgressStyle,
        pixels: u64,
        spp: Option<u64>,
        control: Arc<Control>,
        frame: Option<FramePosition>,
    ) -> Progress {
        let style = match style {
            ProgressStyle::Bar if !std::io::stderr().is_terminal() => ProgressStyle::None,
            style => style,
        };
        let shared = Arc::new(Shared {
            style,
            pixels: pixels as f64,
            spp: spp.map(|spp| spp as f64),
            frame,
            control,
            start: Instant::now(),
            error: Mutex::new(None),
            finished: AtomicBool::new(false),
        });
        // A system that has no thread for it costs the reports, not the picture.
        let thread = (style != ProgressStyle::None).then(|| {
            let shared = Arc::clone(&shared);
            std::thread::Builder::new().spawn(move || shared.report()).ok()
        });
        Progress { shared, thread: thread.flatten() }
    }

    /// Takes the error of the film after a pass.
    pub fn pass_done(&self, film: &Film) {
        if self.shared.style == ProgressStyle::Json {
            let error = film.median_relative_error().filter(|error| error.is_finite());
            *self.shared.error.lock().unwrap_or_else(PoisonError::into_inner) = error;
        }
    }

    /// Ends the reports.
    pub fn finish(mut self) {
        self.shared.finished.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A reporter that died has nothing more to say.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn report(&self) {
        let bar = (self.style == ProgressStyle::Bar).then(|| self.new_bar());
        let interval = Duration::from_millis(if bar.is_some() { 100 } else { 500 });
        while !self.finished.load(Ordering::Relaxed) {
            self.tell(bar.as_ref());
            std::thread::park_timeout(interval);
        }
        self.tell(bar.as_ref());
        if let Some(bar) = bar {
            bar.finish_and_clear();
        }
    }

    fn new_bar(&self) -> ProgressBar {
        let (bar, template) = match self.spp {
            Some(spp) => (ProgressBar::new((spp * self.pixels) as u64), "{bar:40} {percent:>3} %  {msg}"),
            None => (ProgressBar::new_spinner(), "{spinner} {msg}"),
        };
        bar.with_style(BarStyle::with_template(template).unwrap_or_else(|_| BarStyle::default_bar()))
    }

    fn tell(&self, bar: Option<&ProgressBar>) {
        let paths = self.control.samples.load(Ordering::Relaxed) as f64;
        let seconds = self.start.elapsed().as_secs_f64();
        let rate = if seconds > 0.0 { paths / seconds } else { 0.0 };
        let left = self.spp.map(|spp| (spp * self.pixels - paths).max(0.0) / rate).filter(|t| t.is_finite());
        match bar {
            Some(bar) => {
                bar.set_position(paths as u64);
                let left = left.map_or(String::new(), |t| format!(", {} left", minutes(t)));
                let samples = paths / self.pixels;
                let frame = self.frame.map_or(String::new(), |frame| format!("{frame}, "));
                bar.set_message(format!(
                    "{frame}{samples:.1} samples a pixel, {:.2} million paths/s, {}{left}",
                    rate * 1e-6,
                    minutes(seconds)
                ));
            }
            None => {
                let error = *self.error.lock().unwrap_or_else(PoisonError::into_inner);
                let frame = self.frame.map(|position| position.frame);
                let line =
                    Line { frame, samples: paths / self.pixels, seconds, rate, error, time_left: left };
                if let Ok(line) = serde_json::to_string(&line) {
                    // Whether anyone listens is no matter for the picture.
                    let _ = terminal::answer(line + "\n");
                }
            }
        }
    }
}

fn minutes(seconds: f64) -> String {
    format!("{}:{:02}", (seconds / 60.0) as u64, (seconds % 60.0) as u64)
}
