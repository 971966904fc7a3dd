//! How long the parts that wear out have been in use.

use serde::{Deserialize, Serialize};

/// A part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PartUse {
    /// Driven with it, seconds.
    pub used_s: f64,
    /// When a technician acknowledged that it was changed, RFC 3339; empty before the first time.
    pub changed: String,
    /// The alert of its end was given.
    #[serde(default)]
    pub is_reported: bool,
}

impl PartUse {
    /// Adds driving; true when its life has ended with it, once.
    pub fn add(&mut self, driven_s: f64, life_h: f32) -> bool {
        self.used_s += driven_s;
        let ends = !self.is_reported && self.used_s >= f64::from(life_h) * 3_600.0;
        self.is_reported |= ends;
        ends
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_of_a_part_is_reported_once() {
        let mut part = PartUse::default();
        assert!(!part.add(3_599.0, 1.0));
        assert!(part.add(2.0, 1.0) && !part.add(3_600.0, 1.0));
    }
}
