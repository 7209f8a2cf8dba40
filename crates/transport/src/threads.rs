//! Work shared out among threads: fewer than asked for, where the system gives no more (`ulimit -u`, `ulimit -v`).

use std::thread;

/// Runs `work` on up to so many threads, this one among them, until all have returned.
///
/// # Panics
/// If `work` does, once all others have returned.
pub(crate) fn share(threads: usize, work: impl Fn() + Sync) {
    thread::scope(|scope| {
        for _ in 1..threads.max(1) {
            // What there are no more threads for is done by those there are.
            if thread::Builder::new().spawn_scoped(scope, &work).is_err() {
                break;
            }
        }
        work();
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicU32, Ordering};

    #[test]
    fn a_panic_of_one_thread_leaves_the_others_to_finish() {
        let (first, done) = (AtomicU32::new(0), AtomicU32::new(0));
        let work = || {
            assert!(first.fetch_add(1, Ordering::Relaxed) != 0, "the first of all fails");
            done.fetch_add(1, Ordering::Relaxed);
        };
        assert!(catch_unwind(AssertUnwindSafe(|| share(4, work))).is_err());
        assert_eq!(done.into_inner(), 3);
    }
}
