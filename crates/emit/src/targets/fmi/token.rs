//! The token by which a binary recognises its description: a hash of the content.

/// Placeholder in both files until their content is known.
pub(super) const TOKEN: &str = "@TOKEN@";

/// FNV-1a of 128 bits.
const START: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
const PRIME: u128 = (1 << 88) + 0x13b;

/// The token of these files, in braces.
pub(super) fn token(files: &[&[u8]]) -> String {
    let bytes = files.iter().flat_map(|file| file.iter());
    let hash = bytes.fold(START, |h, b| (h ^ u128::from(*b)).wrapping_mul(PRIME));
    format!("{{{hash:032x}}}")
}

#[cfg(test)]
mod tests {
    use super::token;

    /// The published value of FNV-1a for "a".
    #[test]
    fn the_hash_is_that_of_its_name() {
        assert_eq!(token(&[b"a"]), "{d228cb696f1a8caf78912b704e4a8964}");
    }
}
