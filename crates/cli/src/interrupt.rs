//! Ctrl-C: the first ends the work, which saves what there is; the second ends the program.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use miette::IntoDiagnostic;
use tyndall_transport::Control;

/// A flag that the first Ctrl-C sets.
pub fn cancel_on_interrupt() -> miette::Result<Arc<AtomicBool>> {
    let cancel = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&cancel);
    on_interrupt(move || flag.swap(true, Ordering::Relaxed))?;
    Ok(cancel)
}

/// Lets the first Ctrl-C cancel a render.
pub fn stop_on_interrupt(control: &Arc<Control>) -> miette::Result<()> {
    let control = Arc::clone(control);
    on_interrupt(move || control.cancel.swap(true, Ordering::Relaxed))
}

/// `cancel` says whether it was called before.
fn on_interrupt(cancel: impl Fn() -> bool + Send + 'static) -> miette::Result<()> {
    ctrlc::set_handler(move || {
        if cancel() {
            std::process::exit(130);
        }
    })
    .into_diagnostic()
}
