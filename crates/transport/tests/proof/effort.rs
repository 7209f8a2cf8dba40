//! How much effort the tests make.

/// Whether `TYNDALL_PROOF=full` in the environment asks for more samples than an everyday run has time for.
pub fn is_full() -> bool {
    std::env::var_os("TYNDALL_PROOF").is_some_and(|effort| effort == "full")
}
