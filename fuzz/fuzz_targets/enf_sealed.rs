//! Scene files with right lengths and checksums but wrong contents: refused, or harmless to rays.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::enf::check(data));

libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    fuzz::enf::mutate(data, size, max_size, seed, libfuzzer_sys::fuzzer_mutate)
});
