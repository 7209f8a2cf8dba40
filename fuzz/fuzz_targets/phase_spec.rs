//! Files for the reader `phase_spec` of `tyndall_fuzz::TARGETS`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tyndall_fuzz::fuzz("phase_spec", bytes));
