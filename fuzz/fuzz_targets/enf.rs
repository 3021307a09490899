//! Scene files as they come: damage must be noticed.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::enf::check(data));
