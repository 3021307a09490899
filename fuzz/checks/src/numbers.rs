//! Numbers at the edge of something.

use enfilade_testing::Random;

/// 32-bit words at the edge of something, as indices, counts or floats.
const WORDS: [u32; 18] = [
    0,
    1,
    2,
    3,
    0x7F,
    0xFF,
    0x100,
    0xFFFF,
    0x1_0000,
    0x7FFF_FFFF,
    0x8000_0000,
    0x8000_0001,
    0xFFFF_FFFE,
    0xFFFF_FFFF,
    0x7F80_0000, // inf
    0xFF80_0000, // -inf
    0x7FC0_0000, // NaN
    0x7F7F_FFFF, // the largest f32
];

/// f64 at the edge of something.
const FLOATS: [f64; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-3,
    1e-9,
    5e-324,
    1e-300,
    1e12,
    -1e12,
    1e13,
    -1e13,
    3.4e38,
    1e154,
    1e300,
    f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// Changes one number in binary data: a byte, an aligned word or an aligned double, to one near it or to one at the
/// edge of something.
pub fn change_number(bytes: &mut [u8], random: &mut Random) {
    if bytes.is_empty() {
        return;
    }
    match random.below(8) {
        0 => {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        1..=4 if bytes.len() >= 4 => {
            let at = random.below(bytes.len() / 4) * 4;
            let old = u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
            let near = [old.wrapping_add(1), old.wrapping_sub(1), old ^ (1 << 31), old.wrapping_mul(2)];
            let new = match random.below(3) {
                0 => *random.pick(&near),
                1 => *random.pick(&WORDS),
                _ => random.below(64) as u32,
            };
            bytes[at..at + 4].copy_from_slice(&new.to_le_bytes());
        }
        _ if bytes.len() >= 8 => {
            let at = random.below(bytes.len() / 8) * 8;
            let mut old = [0; 8];
            old.copy_from_slice(&bytes[at..at + 8]);
            let old = f64::from_le_bytes(old);
            let new = match random.below(4) {
                0 => old * 2.0,
                1 => -old,
                _ => *random.pick(&FLOATS),
            };
            bytes[at..at + 8].copy_from_slice(&new.to_le_bytes());
        }
        _ => {
            let at = random.below(bytes.len());
            bytes[at] = random.bits() as u8;
        }
    }
}
