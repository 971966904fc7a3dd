//! Emergency messages.

use core::fmt;

/// What a device complains about. Code 0 means that it has recovered.
///
/// ```
/// use floorguard_drivers::canopen::Emergency;
///
/// let emergency = Emergency::decode(&[0x10, 0x23, 0x02, 0, 0, 0, 0, 0]).unwrap();
/// assert_eq!((emergency.code, emergency.register), (0x2310, 2));
/// assert!(Emergency::decode(&[0; 8]).unwrap().is_cleared());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Emergency {
    /// Error code of CiA 301 and the device profile.
    pub code: u16,
    /// Error register 1001h.
    pub register: u8,
    /// Bytes of the manufacturer.
    pub manufacturer: [u8; 5],
}

impl Emergency {
    /// From the payload of an EMCY frame; all eight bytes are required.
    #[must_use]
    pub fn decode(payload: &[u8]) -> Option<Self> {
        let &[low, high, register, a, b, c, d, e] = payload else { return None };
        Some(Self { code: u16::from_le_bytes([low, high]), register, manufacturer: [a, b, c, d, e] })
    }

    /// The device says that nothing is wrong any more.
    #[must_use]
    pub const fn is_cleared(&self) -> bool {
        self.code == 0
    }
}

impl fmt::Display for Emergency {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let class = match self.code {
            0 => "no error",
            0x8110 => "CAN overrun",
            0x8120 => "CAN error passive",
            0x8130 => "heartbeat lost",
            0x8140 => "recovered from bus-off",
            0x8210 | 0x8220 => "process data of the wrong length",
            0x8611 => "following error",
            0x1000..=0x1FFF => "generic",
            0x2000..=0x2FFF => "current",
            0x3000..=0x3FFF => "voltage",
            0x4000..=0x4FFF => "temperature",
            0x5000..=0x5FFF => "hardware",
            0x6000..=0x6FFF => "software",
            0x7000..=0x7FFF => "sensor or module",
            0x8000..=0x8FFF => "monitoring",
            0x9000..=0x90FF => "external",
            _ => "device",
        };
        write!(out, "{class} ({:04X}h, register {:02X}h)", self.code, self.register)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn published_vectors() {
        let lost = Emergency::decode(&[0x30, 0x81, 0x11, 1, 2, 3, 4, 5]).unwrap();
        assert_eq!(lost, Emergency { code: 0x8130, register: 0x11, manufacturer: [1, 2, 3, 4, 5] });
        assert_eq!(lost.to_string(), "heartbeat lost (8130h, register 11h)");
        assert!(Emergency::decode(&[0; 8]).unwrap().is_cleared());
        assert_eq!(Emergency::decode(&[0; 7]), None);
    }
}
