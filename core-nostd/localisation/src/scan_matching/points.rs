//! Returns of a scan as points, with the motion during the scan taken out.

use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::number::nearest_f32;
use floorguard_types::sensing::{BeamReturn, Scan};

/// Which ranges are believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeLimits {
    /// Nearer returns belong to the robot itself, metres.
    pub least_m: f32,
    /// Farther returns are too coarse, metres.
    pub most_m: f32,
}

/// How the scanner moved while it measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeamTiming {
    /// Velocity of the scanner in its own frame.
    pub twist: Twist2,
    /// From beam to beam, seconds; negative where beams run against their numbers.
    pub step_s: f32,
}

/// Writes the returns as points in the scanner's frame at the stamp of the scan (its middle); answers how many there
/// was room for. Beams that say nothing and free ones give none.
///
/// Each beam is moved by what the scanner travelled between the beam and the middle of the scan, at constant velocity.
pub fn scan_points(scan: &Scan, limits: RangeLimits, timing: BeamTiming, points: &mut [Point2]) -> usize {
    let middle = nearest_f32(scan.beams.len().saturating_sub(1)) * 0.5;
    let mut room = points.iter_mut();
    let mut count = 0_usize;
    for (index, beam) in scan.beams.iter().enumerate() {
        let BeamReturn::Hit(range_mm) = *beam else { continue };
        let range_m = f32::from(range_mm) * 0.001;
        if range_m < limits.least_m || range_m > limits.most_m {
            continue;
        }
        let (sin, cos) = libm::sincosf(scan.first_angle_rad + nearest_f32(index) * scan.step_rad);
        let measured = Point2::new(range_m * cos, range_m * sin);
        let after_s = (nearest_f32(index) - middle) * timing.step_s;
        let Some(place) = room.next() else { break };
        *place = travelled(timing.twist, after_s).transform(measured);
        count = count.saturating_add(1);
    }
    count
}

/// Where a body with constant velocity stands after a time, seen from where it was: an arc, by its chord.
fn travelled(twist: Twist2, time_s: f32) -> Pose2 {
    let turn = twist.angular_radps * time_s;
    let (sin, cos) = libm::sincosf(turn * 0.5);
    let distance = twist.linear_mps * time_s;
    Pose2::new(distance * cos, distance * sin, turn)
}
