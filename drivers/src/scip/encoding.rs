//! Numbers in characters, and check characters (SCIP 2.0, sections 6 and 7).

/// What is added to six bits to make a character.
const OFFSET: u8 = 0x30;
const SIX_BITS: u8 = 0x3F;

/// The check character of a line: the low six bits of the sum of its bytes, as a character.
///
/// ```
/// use floorguard_drivers::scip::check_character;
///
/// // The example of the specification, and the two most frequent status lines.
/// assert_eq!([b"Hokuyo".as_slice(), b"00", b"99"].map(check_character), [b'o', b'P', b'b']);
/// ```
#[must_use]
pub fn check_character(line: &[u8]) -> u8 {
    let sum = line.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    (sum & SIX_BITS).wrapping_add(OFFSET)
}

/// A line without its check character; `None` where that is wrong, or the line is empty.
#[must_use]
pub(super) fn checked(line: &[u8]) -> Option<&[u8]> {
    let (sum, content) = line.split_last()?;
    (check_character(content) == *sum).then_some(content)
}

/// The number that two to four characters stand for, the highest six bits first. `None` for another length, and for what is no
/// character of the encoding.
///
/// ```
/// use floorguard_drivers::scip::decode_number;
///
/// // The examples of the specification.
/// assert_eq!(decode_number(b"CB"), Some(1_234));
/// assert_eq!(decode_number(b"1Dh"), Some(5_432));
/// assert_eq!(decode_number(b"m2@0"), Some(16_000_000));
/// assert_eq!(decode_number(b"1 h"), None);
/// ```
#[must_use]
pub fn decode_number(characters: &[u8]) -> Option<u32> {
    if !(2..=4).contains(&characters.len()) {
        return None;
    }
    characters.iter().take(4).try_fold(0_u32, |number, character| Some(number << 6 | six_bits(*character)?))
}

/// The six bits of a character; `None` for what the encoding has not.
pub(super) fn six_bits(character: u8) -> Option<u32> {
    let value = character.checked_sub(OFFSET)?;
    (value <= SIX_BITS).then_some(u32::from(value))
}

/// Digits as a number; `None` for none, and for what is no digit or does not fit.
pub(super) fn decimal(digits: &[u8]) -> Option<u32> {
    if digits.is_empty() || digits.len() > 9 {
        return None;
    }
    digits.iter().take(9).try_fold(0_u32, |number, digit| {
        digit
            .is_ascii_digit()
            .then(|| number.wrapping_mul(10).wrapping_add(u32::from(digit.wrapping_sub(b'0'))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number of 18 bits has three characters of its own; nothing else is a character.
    #[test]
    fn numbers_and_characters_are_one_to_one() {
        for number in (0..1_u32 << 18).step_by(7) {
            let characters = [12, 6, 0].map(|shift| ((number >> shift) & 0x3F) as u8 + 0x30);
            assert_eq!(decode_number(&characters), Some(number));
        }
        for byte in 0..=u8::MAX {
            assert_eq!(six_bits(byte).is_some(), (0x30..=0x6F).contains(&byte), "{byte:#x}");
        }
        assert_eq!((decode_number(b"1"), decode_number(b"12345")), (None, None));
    }

    #[test]
    fn decimals_are_digits() {
        assert_eq!(decimal(b"0044"), Some(44));
        assert_eq!(
            (decimal(b""), decimal(b"4a"), decimal(b"-1"), decimal(b"1234567890")),
            (None, None, None, None)
        );
        assert_eq!(checked(b"99b"), Some(&b"99"[..]));
        assert_eq!((checked(b"99c"), checked(b"")), (None, None));
    }
}
