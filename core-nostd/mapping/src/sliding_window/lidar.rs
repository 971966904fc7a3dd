//! A two-dimensional lidar on its side: each scan is a vertical column of beams, and a motor turns it about a vertical
//! axis.
//!
//! Point of beam k in the frame of the axis, with elevation ε = ε₀ + k·Δε, range ρ, lever arm a and tilt τ of the scan
//! plane: (a + ρ·cos ε, −ρ·sin ε·sin τ, ρ·sin ε·cos τ), then turned by the motor's angle at the time of the beam
//! (Dalmedico et al. 2019).

use floorguard_types::geometry::{Point3, Pose2};
use floorguard_types::number::{nearest_f32, saturating_u64};
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

use super::capacities::WINDOW_BEAMS_MAX;
use super::error::ScanError;
use super::motor::MotorTrack;

/// Sines and cosines are exact at the ends of so many beams; between them the motor turns by two milliradians at 0.3 rad/s.
const BLOCK: usize = 64;
const BLOCKS_MAX: usize = WINDOW_BEAMS_MAX.div_ceil(BLOCK);
const METRES: f32 = 1.0e-3;

/// How the lidar is mounted: geometry in the base frame, calibration offsets, valid ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LidarMount {
    /// The motor's axis, metres in the base frame: forward and left.
    pub axis_x_m: f32,
    /// See `axis_x_m`.
    pub axis_y_m: f32,
    /// Height of the optical centre above the floor, metres.
    pub height_m: f32,
    /// From the axis to the optical centre along the beam of elevation 0, metres.
    pub lever_arm_m: f32,
    /// Tilt of the scan plane about its beam of elevation 0, radians; 0 is vertical.
    pub tilt_rad: f32,
    /// Nearer returns are error codes, millimetres.
    pub range_min_mm: u16,
    /// Farther returns are not inserted, millimetres.
    pub range_max_mm: u16,
}

impl LidarMount {
    /// The published sensor: 0.57 m above the floor, over the robot's centre, a Hokuyo URG-04LX with 20 mm to 4 m
    /// (Dalmedico et al. 2019).
    pub const PUBLISHED: Self = Self {
        axis_x_m: 0.0,
        axis_y_m: 0.0,
        height_m: 0.57,
        lever_arm_m: 0.0,
        tilt_rad: 0.0,
        range_min_mm: 20,
        range_max_mm: 4_000,
    };
}

/// One scan: a column of beams from the floor upwards.
#[derive(Clone, Copy, Debug)]
pub struct ColumnScan<'a> {
    /// When the first beam was measured.
    pub first_beam: Stamp,
    /// From beam to beam, microseconds; a URG-04LX: 100,000 / 1,024.
    pub beam_period_us: f32,
    /// Elevation of the first beam, radians, up positive.
    pub first_elevation_rad: f32,
    /// From beam to beam, radians, > 0.
    pub step_rad: f32,
    /// The beams, upwards; 2 to 768.
    pub beams: &'a [BeamReturn],
}

impl ColumnScan<'_> {
    pub(super) fn check(&self) -> Result<(), ScanError> {
        let beams = self.beams.len();
        if !(2..=WINDOW_BEAMS_MAX).contains(&beams) {
            return Err(ScanError::BeamCount { beams });
        }
        let is_finite = self.first_elevation_rad.is_finite()
            && self.step_rad > 0.0
            && self.step_rad.is_finite()
            && self.beam_period_us >= 0.0
            && self.beam_period_us.is_finite();
        if is_finite { Ok(()) } else { Err(ScanError::NotFinite) }
    }

    pub(super) fn stamp_of(&self, beam: usize) -> Stamp {
        self.first_beam.plus_micros(saturating_u64(nearest_f32(beam) * self.beam_period_us))
    }
}

/// The motor's angles of the first and of the last beam, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ScanAngles {
    pub(super) first_rad: f32,
    pub(super) last_rad: f32,
}

/// Gives each valid return as a point in the frame `window_from_base` leads to, upwards. Cost: two angles of the motor and
/// three sines a block of 64 beams, 20 operations a beam.
///
/// # Errors
/// An angle is missing; points of earlier beams may have been given.
pub(super) fn for_each_point(
    scan: &ColumnScan<'_>,
    mount: &LidarMount,
    (motor, window_from_base): (&MotorTrack, Pose2),
    mut take: impl FnMut(Point3),
) -> Result<ScanAngles, ScanError> {
    let axis = window_from_base.compose(Pose2::new(mount.axis_x_m, mount.axis_y_m, 0.0));
    let (tilt_sin, tilt_cos) = libm::sincosf(mount.tilt_rad);
    let (step_sin, step_cos) = libm::sincosf(scan.step_rad);
    let first_rad = motor.angle_at(scan.stamp_of(0))?;
    let mut begin_rad = first_rad;
    for (number, block) in scan.beams.chunks(BLOCK).enumerate().take(BLOCKS_MAX) {
        let first = number.saturating_mul(BLOCK);
        let end_rad = motor.angle_at(scan.stamp_of(first.saturating_add(block.len()).saturating_sub(1)))?;
        let (begin_sin, begin_cos) = libm::sincosf(axis.heading_rad + begin_rad);
        let (end_sin, end_cos) = libm::sincosf(axis.heading_rad + end_rad);
        let (mut sin, mut cos) = libm::sincosf(scan.first_elevation_rad + nearest_f32(first) * scan.step_rad);
        let per_beam = 1.0 / nearest_f32(block.len());
        for (index, beam) in block.iter().enumerate().take(BLOCK) {
            if let BeamReturn::Hit(range_mm) = *beam
                && (mount.range_min_mm..=mount.range_max_mm).contains(&range_mm)
            {
                let range_m = f32::from(range_mm) * METRES;
                let part = nearest_f32(index) * per_beam;
                let (turn_cos, turn_sin) =
                    (begin_cos + part * (end_cos - begin_cos), begin_sin + part * (end_sin - begin_sin));
                let (ahead_m, up_m) = (mount.lever_arm_m + range_m * cos, range_m * sin);
                let left_m = -up_m * tilt_sin;
                take(Point3::new(
                    axis.x_m + ahead_m * turn_cos - left_m * turn_sin,
                    axis.y_m + ahead_m * turn_sin + left_m * turn_cos,
                    mount.height_m + up_m * tilt_cos,
                ));
            }
            (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
        }
        begin_rad = end_rad;
    }
    Ok(ScanAngles { first_rad, last_rad: begin_rad })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sliding_window::MotorSample;
    use std::vec::Vec;

    /// The published formula in double precision, beam by beam.
    #[test]
    fn points_follow_the_formula() {
        let mount = LidarMount {
            axis_x_m: 0.1,
            axis_y_m: -0.05,
            lever_arm_m: 0.03,
            tilt_rad: 0.02,
            ..LidarMount::PUBLISHED
        };
        let beams: Vec<BeamReturn> = (0..511_u16).map(|k| BeamReturn::Hit(500 + 5 * k)).collect();
        let scan = ColumnScan {
            first_beam: Stamp::from_micros(1_000_000),
            beam_period_us: 97.656_25,
            first_elevation_rad: -1.56,
            step_rad: 0.006_136,
            beams: &beams,
        };
        let mut motor = MotorTrack::new();
        for step in 0..20_u16 {
            let stamp = Stamp::from_micros(950_000 + 10_000 * u64::from(step));
            motor
                .push(MotorSample { stamp, angle_rad: 0.7 + 0.006 * f32::from(step), commanded_radps: 0.6 })
                .unwrap();
        }
        let mut points = Vec::new();
        let frames = (&motor, Pose2::default());
        let angles = for_each_point(&scan, &mount, frames, |point| points.push(point)).unwrap();
        assert_eq!(points.len(), 511);
        assert!((angles.first_rad - 0.73).abs() < 1e-5 && (angles.last_rad - 0.759_88).abs() < 1e-4);
        for (k, point) in points.iter().enumerate() {
            let (k, range) = (k as f64, 0.5 + 0.005 * k as f64);
            let elevation = -1.56 + 0.006_136 * k;
            let turn = 0.73 + 0.6 * k * 97.656_25e-6;
            let (tilt, ahead, up) = (0.02_f64, 0.03 + range * elevation.cos(), range * elevation.sin());
            let left = -up * tilt.sin();
            let expected = [
                0.1 + ahead * turn.cos() - left * turn.sin(),
                -0.05 + ahead * turn.sin() + left * turn.cos(),
                0.57 + up * tilt.cos(),
            ];
            let found = [point.x_m, point.y_m, point.z_m].map(f64::from);
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 3e-4, "beam {k}: {found} instead of {expected}");
            }
        }
    }

    #[test]
    fn invalid_returns_give_no_points() {
        let beams =
            [BeamReturn::Hit(19), BeamReturn::Unknown, BeamReturn::Free(4_000), BeamReturn::Hit(4_001)];
        let scan = ColumnScan {
            first_beam: Stamp::ZERO,
            beam_period_us: 0.0,
            first_elevation_rad: 0.0,
            step_rad: 0.01,
            beams: &beams,
        };
        let mut motor = MotorTrack::new();
        motor.push(MotorSample::default()).unwrap();
        let frames = (&motor, Pose2::default());
        for_each_point(&scan, &LidarMount::PUBLISHED, frames, |point| panic!("{point:?}")).unwrap();
        assert_eq!(ColumnScan { beams: &beams[..1], ..scan }.check(), Err(ScanError::BeamCount { beams: 1 }));
        assert_eq!(ColumnScan { step_rad: f32::NAN, ..scan }.check(), Err(ScanError::NotFinite));
    }
}
