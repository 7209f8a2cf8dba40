//! Ends the test with the name of the case, should one not end by itself.

use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Pauses of a tenth of a second, which a machine that stands still does not make, that a case may take: far longer than
/// any does.
const PATIENCE: u32 = 600;

/// A look-out for cases that do not end.
pub struct Watch {
    present: Arc<Mutex<(String, u32)>>,
}

impl Watch {
    /// Begins to look.
    pub fn start() -> Self {
        let present = Arc::new(Mutex::new((String::new(), 0)));
        let watched = Arc::downgrade(&present);
        std::thread::spawn(move || {
            while let Some(present) = watched.upgrade() {
                let mut present = present.lock().expect("no panic with the lock");
                present.1 += 1;
                if present.1 > PATIENCE {
                    eprintln!("does not end: {}", present.0);
                    std::process::exit(1);
                }
                drop(present);
                std::thread::sleep(Duration::from_millis(100));
            }
        });
        Self { present }
    }

    /// Another case begins.
    pub fn next(&self, case: &str) {
        *self.present.lock().expect("no panic with the lock") = (case.to_owned(), 0);
    }
}
