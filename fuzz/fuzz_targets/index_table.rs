//! Files for the reader `index_table` of `tyndall_fuzz::TARGETS`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| tyndall_fuzz::fuzz("index_table", bytes));
