//! Files for the reader `option` of `tyndall_fuzz::TARGETS`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tyndall_fuzz::fuzz("option", bytes));
