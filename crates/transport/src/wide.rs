//! Running loops of plain arithmetic compiled for the widest vectors that the processor has.
//!
//! The code is the same for all: fused multiply-add stays off, so that the bits are the same too. The environment variable
//! `TYNDALL_VECTORS`, `avx2` or `none`, has a processor with wider vectors do without, to see just that.

#[cfg(target_arch = "x86_64")]
use std::sync::OnceLock;

/// A task that gains from wide vectors. `run` is to be inlined, down to its loops.
pub(crate) trait Task {
    /// Whether AVX-512 makes it faster than AVX2 does, as was measured.
    const GAINS_FROM_AVX512: bool;

    /// Does it.
    fn run(self);
}

/// Does the task with AVX-512 or AVX2 where the processor has it.
pub(crate) fn run<T: Task>(task: T) {
    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code)]
    match vectors() {
        Vectors::Avx512 if T::GAINS_FROM_AVX512 => {
            // SAFETY: the processor has the features, as it was asked.
            return unsafe { run_avx512(task) };
        }
        Vectors::Avx512 | Vectors::Avx2 => {
            // SAFETY: as above; what has AVX-512 has AVX2.
            return unsafe { run_avx2(task) };
        }
        Vectors::Narrow => {}
    }
    task.run();
}

/// What the compiler may take for granted.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
enum Vectors {
    Narrow,
    Avx2,
    Avx512,
}

#[cfg(target_arch = "x86_64")]
fn vectors() -> Vectors {
    static VECTORS: OnceLock<Vectors> = OnceLock::new();
    *VECTORS.get_or_init(|| {
        let limit = std::env::var("TYNDALL_VECTORS").unwrap_or_default();
        // All that the functions below are compiled for.
        let has_avx2 = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        let has_avx512 = has_avx2
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        match limit.as_str() {
            "none" => Vectors::Narrow,
            "avx2" if has_avx2 => Vectors::Avx2,
            _ if has_avx512 => Vectors::Avx512,
            _ if has_avx2 => Vectors::Avx2,
            _ => Vectors::Narrow,
        }
    })
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<T: Task>(task: T) {
    task.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx512<T: Task>(task: T) {
    task.run();
}
