//! Who sends, and in which order: repeated, overtaken and foreign datagrams of a bridge are refused, and gaps are counted.

use floorguard_types::time::Stamp;

/// A sequence that falls back by up to this was repeated or overtaken.
const REORDER: u32 = 2_500;
/// A longer gap is a bridge that was started anew, not a number of lost datagrams.
const LOST_MAX: u32 = 5_000;
/// After this silence another bridge may send, or the same one that counts from the beginning.
const SILENCE_US: u64 = 1_000_000;

/// A datagram of another sender, or out of order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OrderError {
    /// Another sender than the one that was understood last.
    Sender {
        /// Who sent it.
        found: u32,
        /// Who is listened to.
        expected: u32,
    },
    /// Not newer than the one before: repeated or overtaken.
    NotNewer {
        /// Its sequence.
        sequence: u32,
    },
}

impl core::fmt::Display for OrderError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Sender { found, expected } => {
                write!(f, "sender {found}; sender {expected} is listened to: end one of the two bridges")
            }
            Self::NotNewer { sequence } => {
                write!(f, "sequence {sequence}, which is not newer than the one before")
            }
        }
    }
}

impl core::error::Error for OrderError {}

/// The newest datagram that was of use.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct DatagramOrder {
    last: Option<Last>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    sender: u32,
    sequence: u32,
    arrival: Stamp,
}

impl DatagramOrder {
    /// The newest sequence of this sender; none after a silence, or before the first datagram.
    ///
    /// # Errors
    /// Somebody else is listened to.
    pub(crate) fn newest(&self, sender: u32, arrival: Stamp) -> Result<Option<u32>, OrderError> {
        match self.last.filter(|last| last.arrival.past_us(arrival) < SILENCE_US) {
            Some(last) if last.sender != sender => {
                Err(OrderError::Sender { found: sender, expected: last.sender })
            }
            last => Ok(last.map(|last| last.sequence)),
        }
    }

    /// This datagram was of use.
    pub(crate) const fn accept(&mut self, sender: u32, sequence: u32, arrival: Stamp) {
        self.last = Some(Last { sender, sequence, arrival });
    }
}

/// How many are missing between the newest one and this sequence: at most [`LOST_MAX`].
///
/// # Errors
/// It is not newer.
pub(crate) const fn lost_before(newest: Option<u32>, sequence: u32) -> Result<u32, OrderError> {
    let Some(newest) = newest else { return Ok(0) };
    if newest.wrapping_sub(sequence) <= REORDER {
        return Err(OrderError::NotNewer { sequence });
    }
    let lost = sequence.wrapping_sub(newest).saturating_sub(1);
    Ok(if lost > LOST_MAX { 0 } else { lost })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_count_and_wrap() {
        assert_eq!(lost_before(None, 7), Ok(0));
        assert_eq!(lost_before(Some(7), 8), Ok(0));
        assert_eq!(lost_before(Some(7), 10), Ok(2));
        assert_eq!(lost_before(Some(u32::MAX), 1), Ok(1));
        assert_eq!(lost_before(Some(0), 5_001), Ok(5_000));
        assert_eq!(lost_before(Some(0), 5_002), Ok(0), "a bridge that was started anew");
        for sequence in [10, 9, 10_u32.wrapping_sub(2_500)] {
            assert_eq!(lost_before(Some(10), sequence), Err(OrderError::NotNewer { sequence }));
        }
        assert_eq!(lost_before(Some(10), 10_u32.wrapping_sub(2_501)), Ok(0), "started anew");
    }

    #[test]
    fn another_sender_waits_for_silence() {
        let at = Stamp::from_micros;
        let mut order = DatagramOrder::default();
        assert_eq!(order.newest(7, at(5)), Ok(None));
        order.accept(7, 3, at(1_000_000));
        assert_eq!(order.newest(7, at(1_999_999)), Ok(Some(3)));
        assert_eq!(order.newest(9, at(1_999_999)), Err(OrderError::Sender { found: 9, expected: 7 }));
        assert_eq!(order.newest(9, at(2_000_000)), Ok(None));
        // An arrival before the newest one is no silence.
        assert_eq!(order.newest(9, at(0)), Err(OrderError::Sender { found: 9, expected: 7 }));
    }
}
