//! What was said already: the same trouble is told once, and its end once.

use floorguard_types::time::{Age, Stamp};

/// After this long without trouble it is over, microseconds: a camera that is bad every other frame is bad.
const OVER_US: u64 = 2_000_000;

/// The last trouble of a stream.
#[derive(Debug, Default)]
pub struct Said {
    last: Option<(String, Stamp)>,
}

/// Two texts that differ only in figures are the same trouble.
fn kind(text: &str) -> String {
    text.chars().filter(|letter| !letter.is_ascii_digit()).collect()
}

impl Said {
    /// There is trouble now: true if it is to be told.
    pub fn trouble(&mut self, why: &str, now: Stamp) -> bool {
        let kind = kind(why);
        let is_new = self.last.as_ref().is_none_or(|(last, _)| *last != kind);
        self.last = Some((kind, now));
        is_new
    }

    /// All is well now: true if it is to be told.
    pub fn well(&mut self, now: Stamp) -> bool {
        let is_over = |since: Stamp| matches!(since.age(now), Age::Past(age_us) if age_us > OVER_US);
        self.last.take_if(|(_, since)| is_over(*since)).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_trouble_is_told_once() {
        let at = |ms: u64| Stamp::from_micros(1_000 * ms);
        let mut said = Said::default();
        assert!(!said.well(at(0)) && said.trouble("3 bytes", at(10)) && !said.trouble("4 bytes", at(20)));
        assert!(!said.well(at(30)) && !said.trouble("5 bytes", at(1_000)), "it flickers");
        assert!(said.trouble("gone", at(1_010)));
        assert!(!said.well(at(3_010)) && said.well(at(3_011)) && !said.well(at(3_012)));
        assert!(said.trouble("gone", at(3_013)));
    }
}
