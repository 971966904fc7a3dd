//! A revolution of a two-dimensional safety scanner.

use heapless::Vec;

use crate::capacities::SCAN_BEAMS_MAX;
use crate::time::Stamp;

/// What one beam says. Three values, not two: "no data" must never look like "no obstacle".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BeamReturn {
    /// Something stands there, this many millimetres away.
    Hit(u16),
    /// The device itself says that there is nothing up to its range, in millimetres.
    Free(u16),
    /// Dazzled, dirty, out of order, below the minimum range, or not measured.
    #[default]
    Unknown,
}

/// A scan. Beams run counter-clockwise from `first_angle_rad`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// The middle of the scan, on the robot's clock.
    pub stamp: Stamp,
    /// The device's own scan counter; one that stands still means a frozen device.
    pub sequence: u32,
    /// Angle of beam 0 in the sensor's frame, radians; 0 is straight ahead.
    pub first_angle_rad: f32,
    /// Angle from beam to beam, radians, > 0.
    pub step_rad: f32,
    /// The beams.
    pub beams: Vec<BeamReturn, SCAN_BEAMS_MAX>,
}

impl Scan {
    /// Nothing. A place to measure into.
    pub const EMPTY: Self =
        Self { stamp: Stamp::ZERO, sequence: 0, first_angle_rad: 0.0, step_rad: 0.0, beams: Vec::new() };

    /// Becomes equal to another one without a copy on the way.
    pub fn copy_from(&mut self, other: &Self) {
        self.stamp = other.stamp;
        self.sequence = other.sequence;
        self.first_angle_rad = other.first_angle_rad;
        self.step_rad = other.step_rad;
        self.beams.clear();
        for beam in &other.beams {
            // Same capacity: never full.
            let _ = self.beams.push(*beam);
        }
    }

    /// Puts the last beam first: a scanner that is mounted upside down.
    pub fn turn_round(&mut self) {
        // `reverse` keeps a panic in the image where the compiler shares it between two callers.
        let half = self.beams.len() / 2;
        let (front, back) = self.beams.split_at_mut_checked(half).unwrap_or_default();
        for (first, last) in front.iter_mut().zip(back.iter_mut().rev()) {
            core::mem::swap(first, last);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_round_twice_changes_nothing() {
        for beams in 0..6_u16 {
            let mut scan = Scan { beams: (0..beams).map(BeamReturn::Hit).collect(), ..Scan::default() };
            scan.turn_round();
            assert!(
                scan.beams.iter().eq((0..beams)
                    .rev()
                    .map(BeamReturn::Hit)
                    .collect::<std::vec::Vec<_>>()
                    .iter())
            );
            scan.turn_round();
            assert!(
                scan.beams.iter().eq((0..beams).map(BeamReturn::Hit).collect::<std::vec::Vec<_>>().iter())
            );
        }
    }
}
