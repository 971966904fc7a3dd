//! Lines of text on a serial line: bytes in, whole lines out.

use heapless::Vec;

/// Longer lines belong to no protocol here, bytes.
pub const LINE_BYTES_MAX: usize = 144;

/// Finds lines that end with carriage return or line feed. A line that is too long is dropped as a whole, and counted.
///
/// ```
/// use floorguard_drivers::text_lines::TextLines;
///
/// let (mut lines, mut found) = (TextLines::default(), Vec::new());
/// for byte in b"S=10:-4\r\nFF=0\r" {
///     if let Some(line) = lines.byte(*byte) {
///         found.push(line.to_vec());
///     }
/// }
/// assert_eq!(found, [b"S=10:-4".to_vec(), b"FF=0".to_vec()]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct TextLines {
    line: Vec<u8, LINE_BYTES_MAX>,
    /// The line in front was given out.
    is_given: bool,
    is_too_long: bool,
    dropped: u32,
}

impl TextLines {
    /// Takes in a byte; gives the line that ends with it. Empty lines are none.
    pub fn byte(&mut self, byte: u8) -> Option<&[u8]> {
        if core::mem::take(&mut self.is_given) {
            self.line.clear();
        }
        if matches!(byte, b'\r' | b'\n') {
            if core::mem::take(&mut self.is_too_long) {
                self.line.clear();
                self.dropped = self.dropped.saturating_add(1);
            }
            self.is_given = !self.line.is_empty();
            return self.is_given.then_some(self.line.as_slice());
        }
        self.is_too_long |= self.line.push(byte).is_err();
        None
    }

    /// Lines that were too long; saturating.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }
}

/// A whole number in decimal digits, with a sign or without.
pub(crate) fn whole<T: core::str::FromStr>(text: &[u8]) -> Option<T> {
    core::str::from_utf8(text).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_line_is_dropped_and_counted() {
        let mut lines = TextLines::default();
        assert!((0..LINE_BYTES_MAX + 1).all(|_| lines.byte(b'x').is_none()));
        assert_eq!(lines.byte(b'\n'), None);
        assert_eq!((lines.dropped(), lines.byte(b'+')), (1, None));
        assert_eq!(lines.byte(b'\r'), Some(&b"+"[..]));
        assert_eq!(lines.byte(b'\n'), None, "what follows is a line of its own");
    }
}
