//! Signals that ask to stop (Ctrl-C, `kill`, a terminal that closes): the first ends the work, which saves what there is; the
//! second ends the program. The exit code is 128 and the signal's number, as shells have it: 130, 143, 129.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};

use miette::IntoDiagnostic;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Number of the last signal.
static RECEIVED: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// A flag that the first signal sets.
pub fn cancel_on_signals() -> miette::Result<Arc<AtomicBool>> {
    let cancel = Arc::new(AtomicBool::new(false));
    stop_on_signals(&cancel)?;
    Ok(cancel)
}

/// Lets the first signal set `cancel`.
pub fn stop_on_signals(cancel: &Arc<AtomicBool>) -> miette::Result<()> {
    for signal in [Some(SIGINT), Some(SIGTERM), hangup()].into_iter().flatten() {
        if is_ignored(signal) {
            continue;
        }
        // In this order, so that the first signal does not find the flag set.
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(cancel)).into_diagnostic()?;
        flag::register(signal, Arc::clone(cancel)).into_diagnostic()?;
        flag::register_usize(signal, Arc::clone(&RECEIVED), signal as usize).into_diagnostic()?;
    }
    Ok(())
}

/// The exit code after a signal.
pub fn exit_code() -> u8 {
    match RECEIVED.load(Ordering::Relaxed) {
        0 => 130,
        signal => 128 + signal as u8,
    }
}

/// Lets writing beyond `ulimit -f` fail with an error, which can be told, where the signal would end the program.
pub fn survive_file_size_limit() -> miette::Result<()> {
    #[cfg(unix)]
    flag::register(signal_hook::consts::SIGXFSZ, Arc::default()).into_diagnostic()?;
    Ok(())
}

/// The signal of a terminal that closes.
#[cfg(unix)]
fn hangup() -> Option<i32> {
    Some(signal_hook::consts::SIGHUP)
}

/// There is none.
#[cfg(not(unix))]
fn hangup() -> Option<i32> {
    None
}

/// Whether the program was started to ignore the signal, as `nohup` does, and shells do to commands in the background.
///
/// Linux tells (`proc_pid_status(5)`); elsewhere a standard error that is no terminal is taken for `nohup`.
fn is_ignored(signal: i32) -> bool {
    match std::fs::read_to_string("/proc/self/status") {
        Ok(status) => {
            let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
            let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
            mask >> (signal - 1) & 1 == 1
        }
        Err(_) => Some(signal) == hangup() && !std::io::IsTerminal::is_terminal(&std::io::stderr()),
    }
}
