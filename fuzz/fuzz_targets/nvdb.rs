//! Files for the reader `nvdb` of `tyndall_fuzz::TARGETS`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tyndall_fuzz::fuzz("nvdb", bytes));
