//! Ranges of any two-dimensional scanner as a scan of the robot.

use floorguard_types::capacities::SCAN_BEAMS_MAX;
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

/// Ranges in metres as a scan; clockwise ones are turned round, and of more beams than fit every so manieth is taken.
/// A range within the limits is a hit; one at or beyond `limits_m[1]` is unknown: few recorders tell "nothing" from
/// "no answer".
pub fn to_scan(
    stamp: Stamp,
    (first_rad, step_rad): (f32, f32),
    ranges_m: &[f32],
    limits_m: [f32; 2],
) -> Scan {
    let every = ranges_m.len().div_ceil(SCAN_BEAMS_MAX).max(1);
    let [min_m, max_m] = limits_m;
    let beam = |range_m: &f32| {
        let usable = range_m.is_finite() && *range_m > min_m.max(0.01) && *range_m < max_m.min(65.0);
        if usable { BeamReturn::Hit((range_m * 1_000.0) as u16) } else { BeamReturn::Unknown }
    };
    let mut scan =
        Scan { stamp, first_angle_rad: first_rad, step_rad: step_rad * every as f32, ..Scan::default() };
    scan.beams.extend(ranges_m.iter().step_by(every).take(SCAN_BEAMS_MAX).map(beam));
    if step_rad < 0.0 {
        scan.first_angle_rad += scan.step_rad * scan.beams.len().saturating_sub(1) as f32;
        scan.step_rad = -scan.step_rad;
        scan.turn_round();
    }
    scan
}

/// Beams with a return.
pub fn hits(scan: &Scan) -> u32 {
    scan.beams.iter().filter(|beam| matches!(beam, BeamReturn::Hit(_))).count() as u32
}
