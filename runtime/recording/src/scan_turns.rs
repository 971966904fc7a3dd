//! How long the turns of a scanner take.

use floorguard_types::sensing::Scan;
use floorguard_types::time::Stamp;

/// A turn of a scanner's mirror where it is not known yet, seconds: that of the S300 and the microScan3.
const SCAN_S: f32 = 0.04;
/// Turns of scanners, microseconds: from 100 to 2.5 a second.
const TURN_US: std::ops::RangeInclusive<u64> = 10_000..=400_000;

/// The time of a turn, from one scan to a later one.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScanTurns {
    last: Option<(Stamp, u32)>,
}

impl ScanTurns {
    /// Seconds that a turn takes, by this scan and the one before.
    pub fn turn_s(&mut self, scan: &Scan) -> f32 {
        let before = self.last.replace((scan.stamp, scan.sequence));
        let turn_us = before.and_then(|(stamp, sequence)| {
            let passed_us = scan.stamp.as_micros().checked_sub(stamp.as_micros())?;
            passed_us.checked_div(scan.sequence.wrapping_sub(sequence).into())
        });
        turn_us.filter(|turn_us| TURN_US.contains(turn_us)).map_or(SCAN_S, |turn_us| turn_us as f32 * 1.0e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode::laser_scan;
    use crate::messages;
    use floorguard_types::sensing::BeamReturn;

    /// Ten turns a second, one scan lost; then another scanner, whose numbers say nothing.
    #[test]
    fn turns_are_counted_by_sequence_numbers() {
        let mut turns = ScanTurns::default();
        let scan = |millis: u64, sequence| Scan {
            stamp: Stamp::from_micros(1_000 * millis),
            sequence,
            ..Scan::default()
        };
        let seen = [(100, 7), (200, 8), (400, 10), (440, 10), (430, 11), (470, 12), (900, 13)];
        let seen = seen.map(|(millis, sequence)| (1.0e3 * turns.turn_s(&scan(millis, sequence))).round());
        assert_eq!(seen, [40.0, 100.0, 100.0, 40.0, 40.0, 40.0, 40.0]);
    }

    /// As ROS has it, a scan bears the stamp of its first beam; its middle is what our driver has stamped.
    #[test]
    fn scans_bear_the_stamp_of_their_first_beam() {
        let mut scan =
            Scan { stamp: Stamp::from_micros(5_000_000), step_rad: 0.008_726_646, ..Scan::default() };
        for _ in 0..541 {
            scan.beams.push(BeamReturn::Hit(1_000)).unwrap();
        }
        let read = laser_scan(&messages::laser_scan(&scan, 0.1, "scanner")).unwrap();
        // Three quarters of a tenth of a second, from end to end.
        assert!(read.header.stamp.as_micros().abs_diff(5_000_000 - 37_500) <= 1, "{:?}", read.header.stamp);
        assert!(read.middle().as_micros().abs_diff(5_000_000) <= 1, "{:?}", read.middle());
    }
}
