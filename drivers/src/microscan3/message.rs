//! A whole message as a checked view: header and blocks (book, microScan3: Message header).

use super::blocks::{DeviceStatus, Geometry, Intrusion, Measured};

/// Bytes of the header.
const HEADER: usize = 52;
/// "This is a version".
const VERSION_INDICATOR: u8 = b'V';
/// Where the header says where the blocks are.
const STATUS: usize = 32;
const GEOMETRY: usize = 36;
const MEASURED: usize = 40;
const INTRUSION: usize = 44;
const APPLICATION: usize = 48;

/// Why a message is of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MessageError {
    /// Shorter than its header.
    Short {
        /// Bytes.
        length: usize,
    },
    /// The device says itself that the message is not valid.
    Invalid {
        /// What stands in place of the version indicator.
        found: u8,
    },
    /// A block lies outside of the message or within its header.
    Block {
        /// Where it begins.
        offset: u16,
        /// Its length.
        size: u16,
    },
}

impl core::fmt::Display for MessageError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Short { length } => {
                write!(f, "scanner message of {length} bytes; expected at least {HEADER}")
            }
            Self::Invalid { found } => {
                write!(f, "scanner message begins with 0x{found:02X}; expected 0x{VERSION_INDICATOR:02X}")
            }
            Self::Block { offset, size } => {
                write!(f, "scanner message has a block at {offset} of {size} bytes, outside of it")
            }
        }
    }
}

impl core::error::Error for MessageError {}

/// A message whose blocks lie within it.
///
/// ```
/// use floorguard_drivers::microscan3::{Message, MessageError};
///
/// assert_eq!(Message::new_checked(&[0; 20]).unwrap_err(), MessageError::Short { length: 20 });
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Message<'a> {
    bytes: &'a [u8],
}

impl<'a> Message<'a> {
    /// Checks version and the place of every block.
    ///
    /// # Errors
    /// [`MessageError`]
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, MessageError> {
        if bytes.len() < HEADER {
            return Err(MessageError::Short { length: bytes.len() });
        }
        let message = Self { bytes };
        match bytes.first() {
            Some(&VERSION_INDICATOR) => {}
            found => return Err(MessageError::Invalid { found: found.copied().unwrap_or_default() }),
        }
        for place in [STATUS, GEOMETRY, MEASURED, INTRUSION, APPLICATION] {
            let (offset, size) = message.place(place);
            let end = usize::from(offset).saturating_add(usize::from(size));
            let absent = offset == 0 && size == 0;
            if !absent && (usize::from(offset) < HEADER || end > bytes.len()) {
                return Err(MessageError::Block { offset, size });
            }
        }
        Ok(message)
    }

    fn u16_at(&self, at: usize) -> u16 {
        let pair = self.bytes.get(at..).and_then(|rest| rest.first_chunk::<2>());
        u16::from_le_bytes(pair.copied().unwrap_or_default())
    }

    fn u32_at(&self, at: usize) -> u32 {
        let four = self.bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        u32::from_le_bytes(four.copied().unwrap_or_default())
    }

    fn place(&self, at: usize) -> (u16, u16) {
        (self.u16_at(at), self.u16_at(at.saturating_add(2)))
    }

    /// `None` where the block was not sent.
    fn block(&self, at: usize) -> Option<&'a [u8]> {
        let (offset, size) = self.place(at);
        let begin = usize::from(offset);
        self.bytes.get(begin..begin.saturating_add(usize::from(size))).filter(|block| !block.is_empty())
    }

    /// Of the device.
    #[must_use]
    pub fn serial_number(&self) -> u32 {
        self.u32_at(4)
    }

    /// Of the plug that holds the configuration.
    #[must_use]
    pub fn plug_serial_number(&self) -> u32 {
        self.u32_at(8)
    }

    /// Rises with each message of the channel.
    #[must_use]
    pub fn sequence_number(&self) -> u32 {
        self.u32_at(16)
    }

    /// Rises with each scan.
    #[must_use]
    pub fn scan_number(&self) -> u32 {
        self.u32_at(20)
    }

    /// Days since 1972-01-01, by the device.
    #[must_use]
    pub fn date_days(&self) -> u16 {
        self.u16_at(24)
    }

    /// Milliseconds of the day, by the device.
    #[must_use]
    pub fn time_of_day_ms(&self) -> u32 {
        self.u32_at(28)
    }

    /// State of the device; `None` where it was not sent or is too short.
    #[must_use]
    pub fn status(&self) -> Option<DeviceStatus> {
        self.block(STATUS).and_then(DeviceStatus::new_checked)
    }

    /// Angles and units; `None` where they were not sent or are too short.
    #[must_use]
    pub fn geometry(&self) -> Option<Geometry> {
        self.block(GEOMETRY).and_then(Geometry::new_checked)
    }

    /// The beams; `None` where they were not sent, or where there are fewer than they say.
    #[must_use]
    pub fn measured(&self) -> Option<Measured<'a>> {
        self.block(MEASURED).and_then(Measured::new_checked)
    }

    /// Which beams are intruded upon, per cut-off path; `None` where it was not sent.
    #[must_use]
    pub fn intrusion(&self) -> Option<Intrusion<'a>> {
        self.block(INTRUSION).map(Intrusion::new)
    }

    /// Inputs and outputs as they stand on the wire; parts of their layout are not established (book, microScan3:
    /// Blocks).
    #[must_use]
    pub fn application(&self) -> Option<&'a [u8]> {
        self.block(APPLICATION)
    }
}
