//! glTF files, `.glb` and `.gltf`, through the reader, the compiler and rays.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| fuzz::glb::check(data));

libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    fuzz::glb::mutate(data, size, max_size, seed, libfuzzer_sys::fuzzer_mutate)
});
