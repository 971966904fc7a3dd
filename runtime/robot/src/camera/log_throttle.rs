//! Log throttle: a persistent fault is logged once, and its end once.

use floorguard_types::time::{Age, Stamp};

/// After this long without trouble it is over, microseconds: a camera that is bad every other frame is bad.
const OVER_US: u64 = 2_000_000;

/// The last trouble of a stream.
#[derive(Debug, Default)]
pub struct LogThrottle {
    last: Option<(String, Stamp)>,
}

/// Two texts that differ only in figures are the same trouble.
fn kind(text: &str) -> String {
    text.chars().filter(|letter| !letter.is_ascii_digit()).collect()
}

impl LogThrottle {
    /// There is a fault now: true if it is to be logged.
    pub fn trouble(&mut self, why: &str, now: Stamp) -> bool {
        let kind = kind(why);
        let is_new = self.last.as_ref().is_none_or(|(last, _)| *last != kind);
        self.last = Some((kind, now));
        is_new
    }

    /// There is no fault now: true if that is to be logged.
    pub fn well(&mut self, now: Stamp) -> bool {
        let is_over = |since: Stamp| matches!(since.age(now), Age::Past(age_us) if age_us > OVER_US);
        self.last.take_if(|(_, since)| is_over(*since)).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn same_fault_is_logged_once() {
        let at = |ms: u64| Stamp::from_micros(1_000 * ms);
        let mut throttle = LogThrottle::default();
        assert!(
            !throttle.well(at(0))
                && throttle.trouble("3 bytes", at(10))
                && !throttle.trouble("4 bytes", at(20))
        );
        assert!(!throttle.well(at(30)) && !throttle.trouble("5 bytes", at(1_000)), "it flickers");
        assert!(throttle.trouble("gone", at(1_010)));
        assert!(!throttle.well(at(3_010)) && throttle.well(at(3_011)) && !throttle.well(at(3_012)));
        assert!(throttle.trouble("gone", at(3_013)));
    }
}
