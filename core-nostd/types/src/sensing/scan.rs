//! A revolution of a two-dimensional safety scanner.

use crate::number::{nearest_f32, saturating_usize};
use crate::profile::{List, ListOf, Native, Profile, Size};
use crate::time::Stamp;

/// What one beam says. Three values, not two: "no data" must never look like "no obstacle".
///
/// ```
/// use floorguard_types::sensing::BeamReturn;
///
/// // A field ends 1.2 m away along this beam.
/// assert!(BeamReturn::Hit(1_500).is_behind(1_200, 0));
/// assert!(!BeamReturn::Hit(900).is_behind(1_200, 0));
/// assert!(BeamReturn::Free(30_000).is_behind(1_200, 0));
/// assert!(!BeamReturn::Unknown.is_behind(1_200, 0));
/// ```
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

impl BeamReturn {
    /// It ends nearer than neither limit; a free one, which ends nowhere, has seen as far as `limit_mm`. One that says
    /// nothing is behind nothing.
    #[must_use]
    pub const fn is_behind(self, limit_mm: u16, warning_mm: u16) -> bool {
        match self {
            Self::Hit(range_mm) => range_mm >= limit_mm && range_mm >= warning_mm,
            Self::Free(range_mm) => range_mm >= limit_mm,
            Self::Unknown => false,
        }
    }
}

/// A scan. Beams run counter-clockwise from `first_angle_rad`.
///
/// ```
/// use floorguard_types::sensing::{BeamReturn, Scan};
/// use floorguard_types::units::radians;
///
/// let mut scan = Scan { first_angle_rad: radians(-135.0), step_rad: radians(0.5), ..Scan::EMPTY };
/// scan.beams.extend((0..541).map(|_| BeamReturn::Free(30_000)));
/// scan.beams[270] = BeamReturn::Hit(2_000);
/// let ahead_rad = scan.first_angle_rad + 270.0 * scan.step_rad;
/// assert!(ahead_rad.abs() < 1.0e-5);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScanOf<P: Profile> {
    /// The middle of the scan, on the robot's clock.
    pub stamp: Stamp,
    /// The device's own scan counter; one that stands still means a frozen device.
    pub sequence: u32,
    /// Angle of beam 0 in the sensor's frame, radians; 0 is straight ahead.
    pub first_angle_rad: f32,
    /// Angle from beam to beam, radians, > 0.
    pub step_rad: f32,
    /// The beams.
    pub beams: ListOf<BeamReturn, P::Beams>,
}

/// A scan in the memory of the target.
pub type Scan = ScanOf<Native>;

impl<P: Profile> ScanOf<P> {
    /// Nothing. A place to measure into.
    pub const EMPTY: Self =
        Self { stamp: Stamp::ZERO, sequence: 0, first_angle_rad: 0.0, step_rad: 0.0, beams: List::EMPTY };

    /// Becomes equal to another one without a copy on the way.
    pub fn copy_from(&mut self, other: &Self) {
        self.stamp = other.stamp;
        self.sequence = other.sequence;
        self.first_angle_rad = other.first_angle_rad;
        self.step_rad = other.step_rad;
        self.beams.clear();
        for beam in other.beams.iter() {
            // Same capacity: never full.
            let _ = self.beams.push(*beam);
        }
    }

    /// Becomes equal to every n-th beam of another one, so that its step is about this or coarser by less than a half.
    ///
    /// ```
    /// use floorguard_types::sensing::{BeamReturn, Scan};
    ///
    /// let mut fine = Scan { step_rad: 0.1, ..Scan::EMPTY };
    /// fine.beams.extend((0..9).map(BeamReturn::Hit));
    /// let mut thin = Scan::EMPTY;
    /// thin.copy_thinned(&fine, 0.4);
    /// assert_eq!(thin.beams, [0, 4, 8].map(BeamReturn::Hit));
    /// assert_eq!(thin.step_rad, 0.4);
    /// ```
    pub fn copy_thinned(&mut self, other: &Self, step_rad: f32) {
        let steps = libm::roundf(step_rad / other.step_rad);
        let every = if steps.is_finite() { saturating_usize(steps).clamp(1, P::Beams::N) } else { 1 };
        self.stamp = other.stamp;
        self.sequence = other.sequence;
        self.first_angle_rad = other.first_angle_rad;
        self.step_rad = other.step_rad * nearest_f32(every);
        self.beams.clear();
        for beam in other.beams.iter().step_by(every) {
            // Same capacity: never full.
            let _ = self.beams.push(*beam);
        }
    }

    /// Puts the last beam first: a scanner that is mounted upside down.
    ///
    /// ```
    /// use floorguard_types::sensing::{BeamReturn, Scan};
    ///
    /// let mut scan = Scan::EMPTY;
    /// scan.beams.extend([1, 2, 3].map(BeamReturn::Hit));
    /// scan.turn_round();
    /// assert_eq!(scan.beams, [3, 2, 1].map(BeamReturn::Hit));
    /// ```
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

    /// Beams stay at their angles; a scan that is coarse already stays as it is.
    #[test]
    fn thinned_beams_keep_their_angles() {
        let fine = Scan { first_angle_rad: -2.4, step_rad: 0.001_745, sequence: 7, ..Scan::default() };
        let fine = Scan { beams: (0..501).map(BeamReturn::Hit).collect(), ..fine };
        let mut thin = Scan::EMPTY;
        thin.copy_thinned(&fine, 0.008_726);
        assert_eq!((thin.beams.len(), thin.sequence), (101, 7));
        for (index, beam) in thin.beams.iter().enumerate() {
            assert_eq!(*beam, BeamReturn::Hit(index as u16 * 5));
        }
        assert!((thin.step_rad - 5.0 * fine.step_rad).abs() < 1.0e-9);
        let before = thin.clone();
        let mut again = Scan::EMPTY;
        again.copy_thinned(&before, 0.008_726);
        assert_eq!(again, before);
        for step_rad in [0.0, f32::NAN] {
            again.copy_thinned(&Scan { step_rad, ..before.clone() }, 0.008_726);
            assert_eq!(again.beams, before.beams, "a step of {step_rad}");
        }
    }

    #[test]
    fn beam_without_return_hides_nothing() {
        assert!(BeamReturn::Hit(700).is_behind(500, 700) && !BeamReturn::Hit(699).is_behind(500, 700));
        assert!(BeamReturn::Hit(500).is_behind(500, 0) && !BeamReturn::Hit(499).is_behind(500, 0));
        assert!(BeamReturn::Free(500).is_behind(500, 700) && !BeamReturn::Free(499).is_behind(500, 0));
        assert!(!BeamReturn::Unknown.is_behind(0, 0));
    }

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
