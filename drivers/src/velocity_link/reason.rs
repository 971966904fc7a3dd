//! A reason in words, of bounded length.

use core::fmt;

/// Longest reason, bytes of UTF-8.
pub const REASON_BYTES: usize = 128;

/// Text of at most [`REASON_BYTES`]. Writing more keeps the characters that fit, and is an error.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Reason {
    bytes: [u8; REASON_BYTES],
    length: usize,
}

impl Reason {
    /// No reason.
    pub const EMPTY: Self = Self { bytes: [0; REASON_BYTES], length: 0 };

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        core::str::from_utf8(self.bytes.get(..self.length).unwrap_or_default()).unwrap_or_default()
    }

    /// The text's bytes, with zeros behind it.
    #[must_use]
    pub const fn bytes(&self) -> &[u8; REASON_BYTES] {
        &self.bytes
    }

    /// Bytes of the text.
    #[must_use]
    pub const fn length(&self) -> usize {
        self.length
    }
}

impl Default for Reason {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl fmt::Debug for Reason {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), formatter)
    }
}

impl fmt::Write for Reason {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = REASON_BYTES.saturating_sub(self.length);
        let end = text.len().min(room);
        // A character has at most four bytes.
        let fits = (0..4_usize).find_map(|back| text.get(..end.saturating_sub(back))).unwrap_or_default();
        let places = self.bytes.get_mut(self.length..).unwrap_or_default();
        for (place, byte) in places.iter_mut().zip(fits.as_bytes()) {
            *place = *byte;
        }
        self.length = self.length.saturating_add(fits.len());
        if fits.len() == text.len() { Ok(()) } else { Err(fmt::Error) }
    }
}

#[cfg(test)]
mod tests {
    use core::fmt::Write as _;

    use super::*;

    #[test]
    fn long_reasons_end_with_a_whole_character() {
        let mut reason = Reason::EMPTY;
        assert!(reason.write_str("a").is_ok() && reason.as_str() == "a");
        for _ in 0..63 {
            assert!(reason.write_str("ä").is_ok());
        }
        assert!(reason.write_str("ä").is_err());
        assert_eq!((reason.length(), reason.as_str().chars().count()), (127, 64));
        assert!(reason.write_str("b").is_ok() && reason.write_str("c").is_err());
        assert!(reason.as_str().ends_with("äb"));
    }
}
