//! Identities in the form that IFC gives them.

use twox_hash::XxHash3_64;

/// The digits of IFC's base 64.
const DIGITS: &[u8; 64] = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$";

/// Sets the second half of an identity apart from the first.
const SECOND: u64 = 0x9E37_79B9_7F4A_7C15;

/// 22 digits of IFC's base 64, 128 bits of hash: the same for the same seed and path.
pub fn global_id(seed: u64, path: &str) -> String {
    let half = |seed| u128::from(XxHash3_64::oneshot_with_seed(seed, path.as_bytes()));
    let bits = half(seed) << 64 | half(seed ^ SECOND);
    // 22 digits have 132 bits: the first digit holds two.
    (0..22).rev().map(|place| DIGITS[(bits >> (6 * place) & 63) as usize] as char).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identities_are_of_ifc_form_and_stable() {
        let id = global_id(0, "house/IfcWall:1");
        assert_eq!(id.len(), 22);
        assert!(id.bytes().all(|b| DIGITS.contains(&b)) && id.as_bytes()[0] < b'4', "{id}");
        assert_eq!(id, global_id(0, "house/IfcWall:1"));
        assert_ne!(id, global_id(1, "house/IfcWall:1"));
        assert_ne!(id, global_id(0, "house/IfcWall:2"));
    }
}
