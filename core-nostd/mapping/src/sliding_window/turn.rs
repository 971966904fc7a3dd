//! A movement of the window as one grid sees it, in the steps of its cells.
//!
//! A turn about the vertical is the same turn in the plane of normal and grid: with elevation E in eighths of a millimetre and
//! place U along the grid in 256ths of a cell, E′ = cos δ·E − sin δ·a·U + c and U′ = sin δ·b·E + cos δ·U + d. That are four
//! multiplications for a cell.

use floorguard_types::number::{
    exact_usize, nearest_f32, saturating_i32, saturating_u32, truncating_u8, truncating_u16,
};

use super::cell::ELEVATION_STEP_M;
use super::compensation::Rigid;
use super::face::{Face, Normal};
use super::geometry::WindowGeometry;

/// Steps of a place within a cell, over its whole edge, as binary places.
const STEP_PLACES: u32 = 8;
const STEPS_IN_CELL: f32 = 256.0;
const HALF_CELL: i32 = 128;
/// Tangent of 37.5°.
const BORDER: f32 = 0.767_327;
/// The highest elevation that a cell keeps: 8.19 m.
const ELEVATION_STEPS_MAX: u32 = 65_520;

/// The movement for the cells of one grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    cos: f32,
    /// sin δ in 256ths of a cell for each step of elevation.
    along_of_elevation: f32,
    /// −sin δ in steps of elevation for each 256th of a cell.
    elevation_of_along: f32,
    /// With half a step, so that cutting rounds.
    along_constant: f32,
    elevation_constant: f32,
    /// The middle of the grid, with half a step too.
    middle: f32,
    /// 256ths of a cell aside for each step of elevation, where the next grid begins.
    border: f32,
}

/// Where a cell has come to, within its grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turned {
    pub(super) elevation: u16,
    /// May lie beyond the last one.
    pub(super) column: usize,
    pub(super) along: i8,
}

/// What became of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    Stays(Turned),
    /// Nearer to another grid's normal, or behind the robot.
    Leaves,
    /// Too far, or before the first column.
    Outside,
}

impl Turn {
    /// The movement `new_from_old` of the window's frame as a grid sees it.
    pub(super) fn of(face: Face, geometry: &WindowGeometry, new_from_old: &Rigid) -> Self {
        let Normal { cos, sin } = face.normal();
        let (x, y) = (new_from_old.x_m, new_from_old.y_m);
        let (ahead_m, aside_m) = (x * cos + y * sin, y * cos - x * sin);
        // 256ths of a cell, and steps of elevation, for each metre; a cell has at least 0.01 m.
        let (along, steps) = (STEPS_IN_CELL / geometry.resolution_m(), 1.0 / ELEVATION_STEP_M);
        let half_m = geometry.half_width_m();
        let (turn_cos, turn_sin) = (new_from_old.cos, new_from_old.sin);
        Self {
            cos: turn_cos,
            along_of_elevation: turn_sin * along / steps,
            elevation_of_along: -turn_sin * steps / along,
            along_constant: (aside_m + half_m * (1.0 - turn_cos)) * along + 0.5,
            elevation_constant: (ahead_m + half_m * turn_sin) * steps + 0.5,
            middle: half_m * along + 0.5,
            border: BORDER * along / steps,
        }
    }

    /// Where the content of a cell of a column comes to. 25 operations.
    #[inline]
    pub(super) fn apply(&self, elevation: u16, column: i32, along: i8) -> Fate {
        let along = (column << STEP_PLACES).wrapping_add(HALF_CELL).wrapping_add(i32::from(along));
        let (elevation, along) = (f32::from(elevation), nearest_f32(along));
        let new_along = self.along_constant + self.cos * along + self.along_of_elevation * elevation;
        let new_elevation = self.elevation_constant + self.cos * elevation + self.elevation_of_along * along;
        let is_ours = (new_along - self.middle).abs() <= new_elevation * self.border;
        if !is_ours {
            // Also what is not a number.
            return Fate::Leaves;
        }
        // Not negative: it was compared with a distance.
        let elevation = saturating_u32(new_elevation);
        let along = saturating_i32(new_along);
        if elevation > ELEVATION_STEPS_MAX || along < 0 {
            return Fate::Outside;
        }
        Fate::Stays(Turned {
            elevation: truncating_u16(elevation),
            column: exact_usize(along.unsigned_abs() >> STEP_PLACES),
            // The place within the cell is in the low eight bits.
            along: truncating_u8(along.wrapping_sub(HALF_CELL)).cast_signed(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Pose2;

    /// The same movement in double precision through the frame of the window.
    #[test]
    fn turns_agree_with_the_movement_of_points() {
        for (resolution_m, half_m) in [(0.01, 3.1), (0.05, 3.1), (0.1, 3.1), (0.5, 20.0)] {
            let geometry = WindowGeometry::new(resolution_m, half_m, 2.4).unwrap();
            for (number, pose) in (0_u16..).zip([
                Pose2::new(0.03, 0.0, 0.0),
                Pose2::new(0.02, -0.01, 0.02),
                Pose2::new(-0.4, 0.3, -1.1),
                Pose2::new(0.0, 0.0, 3.0),
            ]) {
                let rigid = Rigid::of(pose);
                for face in Face::ALL {
                    let turn = Turn::of(face, &geometry, &rigid);
                    for step in 0..400_u16 {
                        let column =
                            i32::from(step * 7 + number) % i32::try_from(geometry.columns()).unwrap();
                        let (elevation, along) =
                            (step.wrapping_mul(163), i8::try_from(i32::from(step % 255) - 127).unwrap());
                        check(&turn, (face, &geometry), (pose, elevation, column, along));
                    }
                }
            }
        }
    }

    fn check(turn: &Turn, (face, geometry): (Face, &WindowGeometry), cell: (Pose2, u16, i32, i8)) {
        let (pose, elevation, column, along) = cell;
        let azimuth = f64::from(face.azimuth_rad());
        let e = f64::from(elevation) * 1.25e-4;
        let u = (f64::from(column) + 0.5 + f64::from(along) / 256.0) * f64::from(geometry.resolution_m())
            - f64::from(geometry.half_width_m());
        let (x, y) = (e * azimuth.cos() - u * azimuth.sin(), e * azimuth.sin() + u * azimuth.cos());
        let turned = f64::from(pose.heading_rad);
        let new_x = f64::from(pose.x_m) + x * turned.cos() - y * turned.sin();
        let new_y = f64::from(pose.y_m) + x * turned.sin() + y * turned.cos();
        let expected =
            (new_x * azimuth.cos() + new_y * azimuth.sin(), new_y * azimuth.cos() - new_x * azimuth.sin());
        match turn.apply(elevation, column, along) {
            Fate::Stays(Turned { column, .. }) if column >= geometry.columns() => {
                assert!(expected.1 > f64::from(geometry.half_width_m()) - 0.01, "{expected:?}");
            }
            Fate::Stays(Turned { elevation, column, along }) => {
                let e = f64::from(elevation) * 1.25e-4;
                let u = (column as f64 + 0.5 + f64::from(along) / 256.0) * f64::from(geometry.resolution_m())
                    - f64::from(geometry.half_width_m());
                // Half a step of each, and the single precision of the pose.
                let step_m = f64::from(geometry.resolution_m()) / 512.0;
                assert!((e - expected.0).abs() < 7e-5 + 4e-6 && (u - expected.1).abs() < step_m + 4e-6);
                assert!(
                    Face::of_direction(new_x as f32, new_y as f32) == Some(face)
                        || expected.1.abs() > expected.0 * 0.766
                );
            }
            Fate::Leaves => {
                assert!(expected.1.abs() > expected.0 * 0.766 - 1e-4, "{expected:?}");
            }
            Fate::Outside => {
                let edge_m = f64::from(geometry.half_width_m()) - 0.01;
                assert!(expected.0 > 8.18 || expected.1.abs() > edge_m, "{expected:?}");
            }
        }
    }

    #[test]
    fn far_movements_lead_outside() {
        let geometry = WindowGeometry::of_resolution(0.05).unwrap();
        for x_m in [1.0e3, -1.0e3, 1.0e12, f32::MAX] {
            let turn = Turn::of(Face::Front, &geometry, &Rigid::of(Pose2::new(x_m, 0.0, 0.0)));
            let fate = turn.apply(8_000, 60, 0);
            assert!(!matches!(fate, Fate::Stays(turned) if turned.column < 124), "{x_m}: {fate:?}");
        }
    }
}
