//! Compares the two channels of one input.

use floorguard_types::sensing::SafetyInput;
use floorguard_types::time::{Age, Stamp};

/// One input of the equivalent kind: both channels 1 in the operating state.
///
/// Either channel at 0 is danger at once. Channels that differ for longer than the discrepancy time are a fault, which
/// stays until both channels were at 0 (book, Safety inputs: Two channels).
///
/// ```
/// use floorguard_drivers::discrete_inputs::DualChannel;
/// use floorguard_types::sensing::SafetyInput::{Active, Clear, Fault};
/// use floorguard_types::time::Stamp;
///
/// // One channel stays open: danger at once, a fault after 100 ms, and closing it does not clear the fault.
/// let mut button = DualChannel::new(100_000);
/// let mut judge = |millis: u64, channels| button.judge(channels, Stamp::from_micros(millis * 1_000));
/// assert_eq!(judge(0, [true, true]), Clear);
/// assert_eq!(judge(10, [true, false]), Active);
/// assert_eq!(judge(120, [true, false]), Fault);
/// assert_eq!(judge(130, [true, true]), Fault);
/// assert_eq!(judge(140, [false, false]), Active);
/// assert_eq!(judge(150, [true, true]), Clear);
/// ```
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

    /// Channels may differ for this long, microseconds.
    #[must_use]
    pub const fn discrepancy_us(&self) -> u64 {
        self.discrepancy_us
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
    use proptest::prelude::*;

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
    fn lasting_discrepancy_needs_a_full_press() {
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

    proptest! {
        /// Against the rules of the book, Safety inputs: Two channels, each judged over the whole history.
        #[test]
        fn as_the_specification_says(
            steps in proptest::collection::vec((0_u64..80, any::<[bool; 2]>()), 1..60)
        ) {
            let mut now_ms = 0;
            let history: std::vec::Vec<(u64, [bool; 2])> =
                steps.iter().map(|(step_ms, channels)| { now_ms += step_ms; (now_ms, *channels) }).collect();
            for (end, seen) in judged(&history).into_iter().enumerate() {
                let past = &history[..=end];
                let (_, [a, b]) = past[end];
                // The fault: some run of different channels lasted too long, and no full press since.
                let since = past.iter().rposition(|(_, channels)| *channels == [false, false]).map_or(0, |at| at + 1);
                let lasted_too_long = (since..=end).any(|last| {
                    let run = past[since..=last].iter().rev().take_while(|(_, [a, b])| a != b);
                    run.last().is_some_and(|(first_ms, _)| past[last].0 - first_ms > 100)
                });
                let expected = match (lasted_too_long, a && b) {
                    (true, _) => Fault,
                    (false, true) => Clear,
                    (false, false) => Active,
                };
                prop_assert_eq!(seen, expected);
            }
        }
    }

    #[test]
    fn a_clock_that_ran_backwards_is_a_fault() {
        assert_eq!(judged(&[(1_000, [true, false]), (0, [true, false])]), [Active, Fault]);
    }
}
