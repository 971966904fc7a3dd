//! The position packet: temperature, PPS, and the sentence of a satellite receiver. Source: book, Velodyne: Position
//! packet.

mod field {
    use core::ops::Range;
    pub const BYTES: usize = 512;
    pub const TOP_TEMPERATURE: usize = 187;
    pub const BOTTOM_TEMPERATURE: usize = 188;
    pub const STAMP: Range<usize> = 198..202;
    pub const PPS: usize = 202;
    pub const THERMAL_SHUTDOWN: usize = 203;
    pub const SENTENCE: Range<usize> = 206..334;
}

/// Lock of the sensor's clock to a pulse per second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PpsState {
    /// No pulse.
    Absent,
    /// Pulses are being followed.
    Synchronising,
    /// Locked.
    Locked,
    /// Pulses that make no sense.
    Error,
    /// A value that the manual does not know.
    Unknown(u8),
}

/// A datagram that is no position packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PositionError {
    /// Not 512 bytes long.
    Length {
        /// Bytes received.
        received: usize,
    },
}

impl core::fmt::Display for PositionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self::Length { received } = self;
        write!(f, "lidar position packet of {received} bytes; expected {}", field::BYTES)
    }
}

impl core::error::Error for PositionError {}

/// A checked position packet.
///
/// ```
/// use floorguard_drivers::velodyne::{PositionPacket, PpsState};
///
/// let mut bytes = [0; 512];
/// (bytes[187], bytes[202]) = (41, 2);
/// let packet = PositionPacket::new_checked(&bytes).unwrap();
/// assert_eq!(packet.pps(), PpsState::Locked);
/// assert_eq!(packet.temperatures().top_celsius, 41);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PositionPacket<'a> {
    bytes: &'a [u8; field::BYTES],
}

/// Temperatures inside of the sensor, °C; 0 with old firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardTemperatures {
    /// Of the top board.
    pub top_celsius: u8,
    /// Of the bottom board.
    pub bottom_celsius: u8,
}

impl<'a> PositionPacket<'a> {
    /// Checks a UDP payload.
    ///
    /// # Errors
    /// [`PositionError`] with the length.
    pub fn new_checked(payload: &'a [u8]) -> Result<Self, PositionError> {
        let bytes = payload.try_into().map_err(|_| PositionError::Length { received: payload.len() })?;
        Ok(Self { bytes })
    }

    /// Microseconds since the top of the hour.
    #[must_use]
    pub fn stamp_us(&self) -> u32 {
        let four = self.bytes.get(field::STAMP).and_then(|four| four.try_into().ok()).unwrap_or([0; 4]);
        u32::from_le_bytes(four)
    }

    /// Lock to the pulse per second.
    #[must_use]
    pub const fn pps(&self) -> PpsState {
        match self.bytes[field::PPS] {
            0 => PpsState::Absent,
            1 => PpsState::Synchronising,
            2 => PpsState::Locked,
            3 => PpsState::Error,
            other => PpsState::Unknown(other),
        }
    }

    /// Temperatures of the boards.
    #[must_use]
    pub const fn temperatures(&self) -> BoardTemperatures {
        BoardTemperatures {
            top_celsius: self.bytes[field::TOP_TEMPERATURE],
            bottom_celsius: self.bytes[field::BOTTOM_TEMPERATURE],
        }
    }

    /// The sensor has switched its lasers off because it is too hot or too cold.
    #[must_use]
    pub const fn is_thermally_shut_down(&self) -> bool {
        self.bytes[field::THERMAL_SHUTDOWN] == 1
    }

    /// The receiver's sentence without its line end; empty if there is none or it is no ASCII.
    #[must_use]
    pub fn sentence(&self) -> &'a str {
        let bytes = self.bytes.get(field::SENTENCE).unwrap_or_default();
        let end = bytes.iter().position(|byte| matches!(byte, 0 | b'\r' | b'\n')).unwrap_or(bytes.len());
        let line = bytes.get(..end).unwrap_or_default();
        if line.iter().all(u8::is_ascii) { core::str::from_utf8(line).unwrap_or_default() } else { "" }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_field_stands_in_its_place() {
        let mut bytes = [0; field::BYTES];
        bytes[187] = 41;
        bytes[188] = 38;
        bytes[198..202].copy_from_slice(&3_599_999_999_u32.to_le_bytes());
        bytes[202] = 2;
        let packet = PositionPacket::new_checked(&bytes).unwrap();
        assert_eq!(packet.temperatures(), BoardTemperatures { top_celsius: 41, bottom_celsius: 38 });
        assert_eq!((packet.stamp_us(), packet.pps()), (3_599_999_999, PpsState::Locked));
        assert!(!packet.is_thermally_shut_down());
        bytes[203] = 1;
        assert!(PositionPacket::new_checked(&bytes).unwrap().is_thermally_shut_down());
        assert_eq!(
            PositionPacket::new_checked(&bytes[1..]).unwrap_err(),
            PositionError::Length { received: 511 }
        );
    }
}
