//! The steps that bring a device to measure (book, Xsens MTi: Start-up), with their requests and patience.

/// How far the start-up is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DevicePhase {
    /// Asked to stop measuring.
    #[default]
    GoingToConfig,
    /// Commanded to reset, because it did not answer.
    Resetting,
    /// Starts after the reset; asked to stop measuring.
    AfterReset,
    /// Asked for its number.
    Identifying,
    /// Asked for its name.
    Naming,
    /// Output configured.
    Configuring,
    /// Commanded to measure.
    GoingToMeasurement,
    /// Measures.
    Measuring,
    /// It is the wrong device or rejects its configuration; asked again after a pause.
    Refused,
}

/// Message identifiers (book, Xsens MTi: Start-up).
pub(super) mod id {
    pub const REQUEST_IDENTIFIER: u8 = 0x00;
    pub const IDENTIFIER: u8 = 0x01;
    pub const GO_TO_MEASUREMENT: u8 = 0x10;
    pub const MEASUREMENT_ACK: u8 = 0x11;
    pub const REQUEST_PRODUCT: u8 = 0x1C;
    pub const PRODUCT: u8 = 0x1D;
    pub const GO_TO_CONFIG: u8 = 0x30;
    pub const CONFIG_ACK: u8 = 0x31;
    pub const DATA: u8 = 0x36;
    pub const WAKE_UP: u8 = 0x3E;
    pub const WAKE_UP_ACK: u8 = 0x3F;
    pub const RESET: u8 = 0x40;
    pub const RESET_ACK: u8 = 0x41;
    pub const ERROR: u8 = 0x42;
    pub const WARNING: u8 = 0x43;
    pub const SET_OUTPUT: u8 = 0xC0;
    pub const OUTPUT_ACK: u8 = 0xC1;
}

/// How long a step waits for its answer, how often it asks, and what follows when nothing helps.
#[derive(Clone, Copy, Debug)]
pub(super) struct RetryPolicy {
    /// Asked again after this, microseconds.
    pub answer_us: u64,
    /// Asked this often.
    pub tries: u8,
    /// Without an answer to the last.
    pub then: DevicePhase,
}

/// An answer that is later than this is asked for again (book, Xsens MTi: Start-up).
const ANSWER_US: u64 = 100_000;
/// Writing the output configuration to the device's memory takes longer.
const WRITE_US: u64 = 500_000;
/// A refused device is asked again after this: it may have been replaced.
const REFUSED_US: u64 = 5_000_000;

impl DevicePhase {
    pub(super) const fn patience(self) -> RetryPolicy {
        let (answer_us, tries, then) = match self {
            Self::GoingToConfig => (ANSWER_US, 5, Self::Resetting),
            // Once: a device that is reset again while it starts never comes up.
            Self::Resetting => (ANSWER_US, 1, Self::AfterReset),
            Self::AfterReset => (ANSWER_US, 20, Self::GoingToConfig),
            Self::Configuring => (WRITE_US, 3, Self::GoingToConfig),
            Self::Refused => (REFUSED_US, 1, Self::GoingToConfig),
            _ => (ANSWER_US, 5, Self::GoingToConfig),
        };
        RetryPolicy { answer_us, tries, then }
    }

    /// The request of the step; the output configuration has data of its own.
    pub(super) const fn request(self) -> Option<u8> {
        match self {
            Self::GoingToConfig | Self::AfterReset => Some(id::GO_TO_CONFIG),
            Self::Resetting => Some(id::RESET),
            Self::Identifying => Some(id::REQUEST_IDENTIFIER),
            Self::Naming => Some(id::REQUEST_PRODUCT),
            Self::Configuring => Some(id::SET_OUTPUT),
            Self::GoingToMeasurement => Some(id::GO_TO_MEASUREMENT),
            Self::Measuring | Self::Refused => None,
        }
    }
}

/// Bytes of the robot's profile: six items of four.
const PROFILE_BYTES: usize = 24;

/// The robot's profile (book, Xsens MTi: Start-up): counter and fine time with every message; quaternion, acceleration
/// and rate of turn at `rate_hz`; status word with every message.
pub(super) const fn profile(rate_hz: u16) -> [u8; PROFILE_BYTES] {
    let [high, low] = rate_hz.to_be_bytes();
    [
        0x10, 0x20, 0xFF, 0xFF, 0x10, 0x60, 0xFF, 0xFF, 0x20, 0x10, high, low, 0x40, 0x20, high, low, 0x80,
        0x20, high, low, 0xE0, 0x20, 0xFF, 0xFF,
    ]
}

/// How the echo of an output configuration compares with the request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Echo {
    /// As asked.
    Same,
    /// The same items, some of them less often.
    Slower,
    /// Other items, or more often than asked.
    Other,
}

pub(super) fn compare(asked: &[u8], echoed: &[u8]) -> Echo {
    if asked.len() != echoed.len() {
        return Echo::Other;
    }
    let mut result = Echo::Same;
    for (wanted, given) in asked.chunks_exact(4).zip(echoed.chunks_exact(4)) {
        let (&[a, b, c, d], &[e, f, g, h]) = (wanted, given) else { return Echo::Other };
        let (rate, granted) = (u16::from_be_bytes([c, d]), u16::from_be_bytes([g, h]));
        match (a, b) == (e, f) {
            true if rate == granted => {}
            true if granted < rate && granted > 0 => result = Echo::Slower,
            _ => return Echo::Other,
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_writes_get_a_longer_timeout() {
        let patience = DevicePhase::Configuring.patience();
        assert_eq!((patience.answer_us, patience.tries), (500_000, 3));
        assert_eq!(DevicePhase::Naming.patience().answer_us, 100_000);
    }
}
