//! Compares the two channels of one input.

use floorguard_core::sensing::SafetyInput;
use floorguard_core::time::{Age, Stamp};

/// One input of the equivalent kind: both channels 1 in the operating state.
///
/// Either channel at 0 is danger at once. Channels that differ for longer than the discrepancy time are a fault, which
/// stays until both channels were at 0 (wire-formats 7.1).
#[derive(Clone, Copy, Debug)]
pub struct DualChannel {
    discrepancy_us: u64,
    differs_since: Option<Stamp>,
    faulty: bool,
}

impl DualChannel {
    /// With a discrepancy time, microseconds.
    #[must_use]
    pub const fn new(discrepancy_us: u64) -> Self {
        Self { discrepancy_us, differs_since: None, faulty: false }
    }

    /// Judges both channels, `true` = operating state.
    pub fn judge(&mut self, channels: [bool; 2], now: Stamp) -> SafetyInput {
        let [a, b] = channels;
        if a == b {
            self.differs_since = None;
            if !a {
                self.faulty = false;
            }
        } else {
            let since = *self.differs_since.get_or_insert(now);
            // A clock that ran backwards proves nothing about the time: fault.
            let too_long = match since.age(now) {
                Age::Past(us) => us > self.discrepancy_us,
                Age::Future(_) => true,
            };
            self.faulty |= too_long;
        }
        match (self.faulty, a && b) {
            (true, _) => SafetyInput::Fault,
            (false, true) => SafetyInput::Clear,
            (false, false) => SafetyInput::Active,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use SafetyInput::{Active, Clear, Fault};

    fn judged(steps: &[(u64, [bool; 2])]) -> std::vec::Vec<SafetyInput> {
        let mut input = DualChannel::new(100_000);
        steps.iter().map(|(ms, channels)| input.judge(*channels, Stamp::from_micros(ms * 1_000))).collect()
    }

    #[test]
    fn either_channel_stops_at_once() {
        let seen =
            judged(&[(0, [true, true]), (10, [false, true]), (20, [false, false]), (30, [true, true])]);
        assert_eq!(seen, [Clear, Active, Active, Clear]);
    }

    #[test]
    fn a_lasting_difference_is_a_fault_that_only_a_full_press_clears() {
        let seen = judged(&[
            (0, [true, false]),
            (100, [true, false]),
            (101, [true, false]),
            (200, [true, true]),
            (300, [false, false]),
            (400, [true, true]),
        ]);
        assert_eq!(seen, [Active, Active, Fault, Fault, Active, Clear]);
    }

    #[test]
    fn a_clock_that_ran_backwards_is_a_fault() {
        assert_eq!(judged(&[(1_000, [true, false]), (0, [true, false])]), [Active, Fault]);
    }
}
