//! Rules files through the parser, and then on a model.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::rules::check(data));
