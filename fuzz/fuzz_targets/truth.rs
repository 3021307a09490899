//! Small models of any shape: every answer to a ray must be right.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::truth::check(data));
