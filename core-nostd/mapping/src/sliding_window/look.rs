//! Where a grid's cells lie from the lidar: quick answers that rule out what need not be asked exactly.
//!
//! Each answer errs to "perhaps": whatever it rules out, the exact question would deny as well.

use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::number::{saturating_u16, saturating_usize};
use floorguard_types::sensing::BeamReturn;

use super::cell::{ELEVATION_STEP_M, WindowCell};
use super::column::Column;
use super::compensation::Rigid;
use super::face::Face;
use super::geometry::WindowGeometry;
use super::lidar::LidarMount;
use super::window::SlidingWindow;

/// A range is cut to whole millimetres before it is compared.
const MILLIMETRE: f32 = 1.0e-3;
/// Directions are looked at as parallel to an edge below this, in metres across for each metre along.
const PARALLEL: f32 = 1.0e-6;
/// What the quick formulas may be wrong by, metres.
const ROUNDING_M: f32 = 2.0e-4;
/// Directions of beams may be wrong by this, radians: the robot moves between two scans, and elevations with it.
const UNSURE_RAD: f32 = 3.0e-3;
/// One over the tangent of 37.5°.
const SECTOR: f32 = 1.303_225;

/// A wedge around the lidar's axis in the window's frame, and the scans on both sides of it.
pub(super) struct Edges {
    pub(super) right: Point2,
    pub(super) left: Point2,
    pub(super) newest: Stand,
    pub(super) previous: Stand,
}

/// Where a scan was measured, in the window's frame: its axis, the direction of its middle, and how far it is slanted, radians.
#[derive(Clone, Copy)]
pub(super) struct Stand {
    axis: Point2,
    middle: Point2,
    slant_rad: f32,
}

impl Stand {
    pub(super) fn of(scan: &Column, window_from_odometry: &Rigid, heading_rad: f32) -> Self {
        let (sin, cos) = libm::sincosf(scan.middle_rad() - heading_rad);
        Self {
            axis: window_from_odometry.transform_flat(scan.axis()),
            middle: Point2::new(cos, sin),
            slant_rad: scan.last_rad() - scan.first_rad(),
        }
    }

    /// As a grid sees it: ahead of it as x, along it as y.
    fn seen_by(self, face: Face) -> Self {
        let seen = |point: Point2| {
            let seen = face.project(Point3::new(point.x_m, point.y_m, 0.0));
            Point2::new(seen.elevation_m, seen.along_m)
        };
        Self { axis: seen(self.axis), middle: seen(self.middle), ..self }
    }

    fn place(&self, point: Point2) -> Point2 {
        Point2::new(point.x_m - self.axis.x_m, point.y_m - self.axis.y_m)
    }

    /// How far a place is to the left of the beam at a part of the scan, metres, and nearer to 0 by what the formula may be
    /// wrong by.
    fn beside_m(&self, place: Point2, part: f32) -> f32 {
        let turn = (part.clamp(0.0, 1.0) - 0.5) * self.slant_rad;
        let (x, y) = (self.middle.x_m - turn * self.middle.y_m, self.middle.y_m + turn * self.middle.x_m);
        let beside_m = x * place.y_m - y * place.x_m;
        let unsure_m = UNSURE_RAD * (place.x_m.abs() + place.y_m.abs());
        if beside_m.abs() <= unsure_m { 0.0 } else { beside_m }
    }
}

/// The wedge and the lidar as one grid sees them, metres.
pub(super) struct Look {
    newest: Stand,
    previous: Stand,
    /// How far within an edge a place lies: what a metre of elevation and a metre along the grid add.
    right: Point2,
    left: Point2,
    geometry: WindowGeometry,
    mount: LidarMount,
}

/// Elevations of a column that lie within the wedge, in steps of a cell: the first one, and how many follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Depths {
    pub(super) first: u16,
    pub(super) span: u16,
}

/// Newest scan and the one before.
#[derive(Clone, Copy)]
pub(super) struct Scans<'a> {
    pub(super) newest: &'a Column,
    pub(super) previous: &'a Column,
}

impl Look {
    pub(super) fn of<S>(face: Face, window: &SlidingWindow<S>, edges: &Edges) -> Self {
        let seen = |point: Point2| face.project(Point3::new(point.x_m, point.y_m, 0.0));
        let (right, left) = (seen(edges.right), seen(edges.left));
        Self {
            newest: edges.newest.seen_by(face),
            previous: edges.previous.seen_by(face),
            right: Point2::new(-right.along_m, right.elevation_m),
            left: Point2::new(left.along_m, -left.elevation_m),
            geometry: window.geometry,
            mount: window.options.mount,
        }
    }

    /// Elevations of cells of a column that may lie within the wedge; `None` if there are none.
    pub(super) fn depths(&self, column: usize) -> Option<Depths> {
        let cell_m = self.geometry.resolution_m();
        let half_cell_m = 0.5 * cell_m + ROUNDING_M;
        let from_middle_m = self.geometry.along_m(column, 0);
        let along_m = from_middle_m - self.newest.axis.y_m;
        // Beyond 37.5° from its normal a grid holds nothing.
        let (mut from_m, mut to_m) = ((from_middle_m.abs() - cell_m) * SECTOR, f32::INFINITY);
        for edge in [self.right, self.left] {
            // The best that a place within the column can have.
            let within_m = edge.y_m * along_m + edge.y_m.abs() * half_cell_m;
            if edge.x_m.abs() < PARALLEL {
                if within_m < -half_cell_m {
                    return None;
                }
                continue;
            }
            // Not divided by 0: ruled out above.
            let at_m = self.newest.axis.x_m - within_m / edge.x_m;
            if edge.x_m > 0.0 {
                from_m = from_m.max(at_m);
            } else {
                to_m = to_m.min(at_m);
            }
        }
        let first = saturating_u16((from_m - ROUNDING_M) / ELEVATION_STEP_M).max(1);
        let last = saturating_u16((to_m + ROUNDING_M) / ELEVATION_STEP_M);
        last.checked_sub(first).map(|span| Depths { first, span })
    }

    /// Whether both scans may see through a cell, and it may lie between them: the beam next to the cell's elevation ends
    /// behind it. That beam is one of the three that [`Column::sees_through`] asks.
    #[inline]
    pub(super) fn may_see_through(
        &self,
        (column, row): (usize, usize),
        cell: &WindowCell,
        scans: Scans<'_>,
    ) -> bool {
        let ahead_m = f32::from(cell.elevation) * ELEVATION_STEP_M;
        let place = Point2::new(ahead_m, self.geometry.along_m(column, cell.along));
        let up_m = self.geometry.up_m(row, cell.up) - self.mount.height_m;
        let from_newest = self.newest.place(place);
        let Some(part) = self.passes(from_newest, up_m, scans.newest) else { return false };
        let from_previous = self.previous.place(place);
        let beside = self.newest.beside_m(from_newest, part) * self.previous.beside_m(from_previous, part);
        beside <= 0.0 && self.passes(from_previous, up_m, scans.previous).is_some()
    }

    /// The part of a scan at which it passes a place from its axis, if the beam there ends behind the place.
    #[inline]
    fn passes(&self, place: Point2, up_m: f32, scan: &Column) -> Option<f32> {
        let distance_m = root(place.x_m * place.x_m + place.y_m * place.y_m) - self.mount.lever_arm_m;
        if distance_m <= 0.0 {
            // Within the lever arm: not for the quick formulas.
            return Some(0.5);
        }
        let near = scan.beam_near(angle(up_m, distance_m))?;
        let limit_m = near.range_m - (self.geometry.resolution_m() - MILLIMETRE - ROUNDING_M);
        let is_behind = limit_m >= 0.0 && limit_m * limit_m >= distance_m * distance_m + up_m * up_m;
        is_behind.then_some(near.part)
    }
}

/// The square root, to 5 parts in a million: Newton's method for its reciprocal from a guess by the exponent.
#[inline]
fn root(square: f32) -> f32 {
    let guess = f32::from_bits(0x5F37_59DF_u32.wrapping_sub(square.to_bits() >> 1));
    let half = 0.5 * square;
    let better = guess * (1.5 - half * guess * guess);
    square * better * (1.5 - half * better * better)
}

/// The arc tangent of up over ahead, radians, to 1e-5 (Abramowitz and Stegun 1964, 4.4.47).
#[inline]
fn angle(up: f32, ahead: f32) -> f32 {
    let is_steep = libm::fabsf(up) > libm::fabsf(ahead);
    let slope = if is_steep { ahead / up } else { up / ahead };
    let square = slope * slope;
    let arc = slope
        * (0.999_866
            + square * (-0.330_299_5 + square * (0.180_141 + square * (-0.085_133 + square * 0.020_835_1))));
    let quarter = core::f32::consts::FRAC_PI_2;
    match (is_steep, up >= 0.0) {
        (false, _) => arc,
        (true, true) => quarter - arc,
        (true, false) => -quarter - arc,
    }
}

/// A beam, as far as it is known.
struct NearBeam {
    /// How far it surely saw, metres.
    range_m: f32,
    /// Its part of the scan, 0…1.
    part: f32,
}

impl Column {
    /// The beam nearest to an elevation that is known to a beam. `None` beyond the ends of the scan, or where it says nothing.
    #[inline]
    fn beam_near(&self, elevation_rad: f32) -> Option<NearBeam> {
        let beam = (elevation_rad - self.first_elevation_rad) * self.beams_per_rad + 0.5;
        // Not for what is not a number.
        let is_within = beam >= 0.0;
        if !is_within {
            return None;
        }
        match self.beams.get(saturating_usize(beam))? {
            BeamReturn::Hit(range_mm) | BeamReturn::Free(range_mm) => {
                Some(NearBeam { range_m: f32::from(*range_mm) * MILLIMETRE, part: beam * self.part_of_beam })
            }
            BeamReturn::Unknown => None,
        }
    }
}
