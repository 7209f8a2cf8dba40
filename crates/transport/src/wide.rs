//! Running loops of plain arithmetic compiled for the widest vectors that the processor has.
//!
//! The code is the same for all: fused multiply-add stays off, so that the bits are the same too. The environment variable
//! `TYNDALL_VECTORS=none` has even a processor with wider vectors do without, to see just that.

#[cfg(target_arch = "x86_64")]
use std::sync::OnceLock;

/// A task that gains from wide vectors. `run` is to be inlined, down to its loops.
pub(crate) trait Task {
    /// Does it.
    fn run(self);
}

/// Does the task with AVX2 where the processor has it.
pub(crate) fn run<T: Task>(task: T) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: the processor has the features, as just asked.
        #[allow(unsafe_code)]
        return unsafe { run_avx2(task) };
    }
    task.run();
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    static HAS_AVX2: OnceLock<bool> = OnceLock::new();
    *HAS_AVX2.get_or_init(|| {
        let is_wanted = std::env::var_os("TYNDALL_VECTORS").is_none_or(|vectors| vectors != "none");
        is_wanted && is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi2")
    })
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<T: Task>(task: T) {
    task.run();
}
