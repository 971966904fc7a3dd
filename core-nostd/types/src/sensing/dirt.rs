//! What a dirt sensor counts under the robot.

use crate::time::Stamp;

/// A message of the dirt sensor. It counts on from power on, so that a lost message loses nothing.
///
/// ```
/// use floorguard_types::sensing::DirtReading;
///
/// let earlier = DirtReading { count: 65_534, ..DirtReading::default() };
/// let later = DirtReading { count: 3, ..DirtReading::default() };
/// assert_eq!(later.hits_since(&earlier), Some(5));
/// // A count that has fallen belongs to a sensor that has restarted.
/// assert_eq!(earlier.hits_since(&later), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DirtReading {
    /// When the message arrived.
    pub stamp: Stamp,
    /// Hits so far; wraps.
    pub count: u16,
    /// The brush is down and turns; only then ground is cleaned.
    pub brush_turns: bool,
    /// Number of the message; wraps.
    pub sequence: u8,
}

impl DirtReading {
    /// Hits since an earlier reading. `None` when the sensor has restarted in between: its count began anew, and what it
    /// counted in the meantime is not known. A count that seems to run on by more than
    /// half its range has fallen.
    #[must_use]
    pub fn hits_since(&self, earlier: &Self) -> Option<u16> {
        let hits = self.count.wrapping_sub(earlier.count);
        (hits < u16::MAX / 2).then_some(hits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn count_wraps_and_restart_counts_nothing() {
        let reading = |count| DirtReading { count, ..DirtReading::default() };
        assert_eq!(reading(3).hits_since(&reading(65_534)), Some(5));
        assert_eq!(reading(7).hits_since(&reading(7)), Some(0));
        assert_eq!(reading(0).hits_since(&reading(500)), None);
    }
}
