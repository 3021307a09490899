//! OBJ files with material libraries through the reader, the compiler and rays.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::obj::check(data));
