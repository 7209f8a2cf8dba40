//! Long work that Ctrl-C stops: it runs on a thread of its own, while this one asks Python for signals.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::{PyErr, PyResult, Python};

/// How long Ctrl-C may wait.
const PATIENCE: Duration = Duration::from_millis(50);

/// What `work` answers, and the exception that came meanwhile, if one did; then its flag was set, on which it should end
/// soon. Python goes on with other threads.
pub(crate) fn cancellable<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> (T, Option<PyErr>) {
    let cancel = AtomicBool::new(false);
    py.detach(|| {
        std::thread::scope(|scope| {
            let waiting = std::thread::current();
            let cancel = &cancel;
            let worker = scope.spawn(move || {
                let answer = work(cancel);
                waiting.unpark();
                answer
            });
            let mut signal = None;
            while !worker.is_finished() {
                std::thread::park_timeout(PATIENCE);
                if signal.is_none()
                    && let Err(exception) = Python::attach(|py| py.check_signals())
                {
                    cancel.store(true, Ordering::Relaxed);
                    signal = Some(exception);
                }
            }
            let answer = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (answer, signal)
        })
    })
}

/// What `work` answers. It knows no flag: after Ctrl-C nobody waits for it any more, and its answer is dropped.
pub(crate) fn abandonable<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (answer, answered) = channel();
    std::thread::spawn(move || answer.send(work()));
    py.detach(move || {
        loop {
            match answered.recv_timeout(PATIENCE) {
                Ok(answer) => return Ok(answer),
                Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err("a bug in Tyndall: the scene could not be built"));
                }
            }
        }
    })
}
