//! Data items of MTData2 (book, Xsens MTi: Data items): identifier, length, numbers in one of four formats.

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberFormat {
    /// Four bytes, IEEE 754.
    Float32,
    /// Four bytes, signed, 20 bits behind the point.
    Fixed1220,
    /// Six bytes: 32 bits behind the point first, then 16 bits before it, signed.
    Fixed1632,
    /// Eight bytes, IEEE 754.
    Float64,
}

impl NumberFormat {
    const fn bytes(self) -> usize {
        match self {
            Self::Float32 | Self::Fixed1220 => 4,
            Self::Fixed1632 => 6,
            Self::Float64 => 8,
        }
    }

    fn number(self, bytes: &[u8]) -> Option<f64> {
        match (self, bytes) {
            (Self::Float32, &[a, b, c, d]) => Some(f64::from(f32::from_be_bytes([a, b, c, d]))),
            (Self::Fixed1220, &[a, b, c, d]) => {
                Some(f64::from(i32::from_be_bytes([a, b, c, d])) / 1_048_576.0)
            }
            (Self::Fixed1632, &[a, b, c, d, e, f]) => {
                let fraction = f64::from(u32::from_be_bytes([a, b, c, d])) / 4_294_967_296.0;
                Some(f64::from(i16::from_be_bytes([e, f])) + fraction)
            }
            (Self::Float64, &[a, b, c, d, e, f, g, h]) => Some(f64::from_be_bytes([a, b, c, d, e, f, g, h])),
            _ => None,
        }
    }
}

/// Which way the axes of the local frame point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocalFrame {
    /// The default, and what the robot asks for.
    EastNorthUp,
    /// As in aviation.
    NorthEastDown,
    /// x north, y west.
    NorthWestUp,
}

/// One item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item<'a> {
    /// Group and type, without coordinate system and format.
    pub kind: u16,
    /// Local frame of orientations and velocities; `None` for the code that has no meaning.
    pub local_frame: Option<LocalFrame>,
    /// Number format.
    pub format: NumberFormat,
    /// The bytes.
    pub data: &'a [u8],
}

impl Item<'_> {
    /// Exactly `N` numbers; `None` when the length is another.
    ///
    /// ```
    /// use floorguard_drivers::xsens::{Item, LocalFrame, NumberFormat};
    ///
    /// let format = NumberFormat::Fixed1220;
    /// let item = Item { kind: 0x2010, local_frame: Some(LocalFrame::EastNorthUp), format, data: &[3, 0x9A, 0xDF, 3] };
    /// let [number] = item.numbers().unwrap();
    /// assert!((number - 57.679_446_22).abs() < 1.0e-8);
    /// ```
    #[must_use]
    pub fn numbers<const N: usize>(&self) -> Option<[f64; N]> {
        let size = self.format.bytes();
        if self.data.len() != size.checked_mul(N)? {
            return None;
        }
        let mut numbers = [0.0; N];
        for (slot, bytes) in numbers.iter_mut().zip(self.data.chunks(size)) {
            *slot = self.format.number(bytes)?;
        }
        Some(numbers)
    }

    /// A whole number of one to four bytes; `None` when the length is another.
    #[must_use]
    pub fn whole(&self, bytes: usize) -> Option<u32> {
        if self.data.len() != bytes || bytes > 4 {
            return None;
        }
        Some(self.data.iter().fold(0, |value, byte| (value << 8) | u32::from(*byte)))
    }
}

/// The items of a message, in order. Ends with an error when an item runs past the end.
///
/// ```
/// use floorguard_drivers::xsens::{Items, Overrun};
///
/// // Packet counter 57,285, and an item that runs past the end.
/// let mut items = Items::new(&[0x10, 0x20, 2, 0xDF, 0xC5, 0x80, 0x20, 12, 0]);
/// let counter = items.next().unwrap().unwrap();
/// assert_eq!((counter.kind, counter.whole(2)), (0x1020, Some(57_285)));
/// assert_eq!(items.next(), Some(Err(Overrun)));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Items<'a> {
    rest: &'a [u8],
}

/// An item runs past the end of the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun;

impl<'a> Items<'a> {
    /// Of the data of an MTData2 message.
    #[must_use]
    pub const fn new(data: &'a [u8]) -> Self {
        Self { rest: data }
    }
}

impl<'a> Iterator for Items<'a> {
    type Item = Result<Item<'a>, Overrun>;

    /// Takes at least three bytes, so that it ends.
    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let parts = self.rest.split_first_chunk::<3>().and_then(|(&[high, low, length], rest)| {
            let (data, rest) = rest.split_at_checked(usize::from(length))?;
            Some((u16::from_be_bytes([high, low]), data, rest))
        });
        let Some((id, data, rest)) = parts else {
            self.rest = &[];
            return Some(Err(Overrun));
        };
        self.rest = rest;
        let format = match id & 3 {
            0 => NumberFormat::Float32,
            1 => NumberFormat::Fixed1220,
            2 => NumberFormat::Fixed1632,
            _ => NumberFormat::Float64,
        };
        let local_frame = match (id >> 2) & 3 {
            0 => Some(LocalFrame::EastNorthUp),
            1 => Some(LocalFrame::NorthEastDown),
            2 => Some(LocalFrame::NorthWestUp),
            _ => None,
        };
        Some(Ok(Item { kind: id & 0xFFF0, local_frame, format, data }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits 2 and 3 of the identifier name the frame (book, Xsens MTi: Data items).
    #[test]
    fn each_frame_of_reference_has_its_bits() {
        let frame = |bits: u8| {
            let bytes = [0x20, 0x10 | bits << 2, 0];
            Items::new(&bytes).next().unwrap().unwrap().local_frame
        };
        let frames = [LocalFrame::EastNorthUp, LocalFrame::NorthEastDown, LocalFrame::NorthWestUp].map(Some);
        assert_eq!([frame(0), frame(1), frame(2)], frames);
        assert_eq!(frame(3), None);
    }

    #[test]
    fn a_whole_number_has_its_length() {
        let item = |data| Item { kind: 0, local_frame: None, format: NumberFormat::Float32, data };
        assert_eq!(item(&[1, 2]).whole(2), Some(0x0102));
        assert_eq!((item(&[1, 2]).whole(1), item(&[1, 2, 3, 4, 5]).whole(5)), (None, None));
    }

    /// Examples of the book, Xsens MTi: Number formats.
    #[test]
    fn published_numbers() {
        let near = |format: NumberFormat, bytes: &[u8], value: f64, tolerance: f64| {
            let number = format.number(bytes).unwrap();
            assert!((number - value).abs() <= tolerance, "{number} {value}");
        };
        near(NumberFormat::Fixed1220, &[0x03, 0x9A, 0xDF, 0x03], 57.679_446_22, 1e-8);
        near(NumberFormat::Fixed1220, &[0x00, 0xBE, 0x1F, 0x81], 11.882_691_38, 1e-8);
        near(NumberFormat::Fixed1632, &[0xAD, 0xF0, 0x52, 0x98, 0x00, 0x39], 57.679_448_28, 1e-8);
        near(NumberFormat::Fixed1632, &[0xE1, 0xF5, 0x89, 0xE9, 0x00, 0x0B], 11.882_652_87, 1e-8);
        near(NumberFormat::Fixed1632, &[0xF6, 0x3F, 0xCA, 0xF0, 0xFF, 0xFF], -0.038_089_10, 1e-8);
        near(NumberFormat::Float32, &[0x41, 0x1C, 0xF5, 0xC3], 9.81, 1e-6);
        assert_eq!(NumberFormat::Float64.number(&[0; 4]), None);
    }
}
