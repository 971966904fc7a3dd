//! Which poses a search looks at.

use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{nearest_f32, saturating_i32};

use super::candidate::{Candidate, CellOffset, TurnedPoints};

/// Poses around a guess: a square of cells, and turns in equal steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchWindow {
    /// The guess, in the field's frame.
    pub centre: Pose2,
    /// Cells to each side of the guess, ≥ 0.
    pub half_side_cells: i32,
    /// Steps of the heading to each side of the guess, ≥ 0.
    pub half_turn_steps: i32,
    /// A step of the heading, radians.
    pub turn_step_rad: f32,
    /// What a pose away from the guess costs.
    pub penalty: MotionPenalty,
    /// Poses that do not count: used to ask for the second best place.
    pub excluded: Option<Exclusion>,
    /// Mean value of the returns, 0 to 1, below which a pose does not count.
    pub minimum_score: f32,
}

/// Loss of score by distance from the guess; the score lies within 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionPenalty {
    /// Loss a square metre.
    pub per_square_metre: f32,
    /// Loss a squared radian.
    pub per_square_radian: f32,
}

/// Poses near another one, relative to the window's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exclusion {
    /// The pose in the middle, in cells from the centre of the window.
    pub column: i32,
    /// The same along y.
    pub row: i32,
    /// The same of the heading, in steps.
    pub turn: i32,
    /// Cells to each side.
    pub half_side_cells: i32,
    /// Steps of the heading to each side.
    pub half_turn_steps: i32,
}

impl SearchWindow {
    /// Writes the cells of the points for a turn: of as many as there are cells for.
    pub(super) fn rotate<'a>(
        &self,
        turn: i32,
        frame: &Raster,
        points: &[Point2],
        cells: &'a mut [CellOffset],
    ) -> TurnedPoints<'a> {
        let heading = self.centre.heading_rad + nearest_f32(turn) * self.turn_step_rad;
        let (sin, cos) = libm::sincosf(heading);
        let mut low = CellOffset { column: i16::MAX, row: i16::MAX };
        let mut high = CellOffset { column: i16::MIN, row: i16::MIN };
        for (point, place) in points.iter().zip(cells.iter_mut()) {
            let x = self.centre.x_m + cos * point.x_m - sin * point.y_m;
            let y = self.centre.y_m + sin * point.x_m + cos * point.y_m;
            let cell = frame.cell(Point2::new(x, y));
            low = CellOffset { column: low.column.min(cell.column), row: low.row.min(cell.row) };
            high = CellOffset { column: high.column.max(cell.column), row: high.row.max(cell.row) };
            *place = cell;
        }
        let count = points.len().min(cells.len());
        TurnedPoints { cells: cells.get(..count).unwrap_or_default(), low, high }
    }

    /// The least that any pose of a block of 2^`shift` cells loses, as a share of the score.
    pub(super) fn least_penalty(&self, candidate: &Candidate, shift: u8, edge_m: f32) -> f32 {
        let side = 1_i32 << shift.min(15);
        let nearest = |first: i32| {
            nearest_f32(0_i32.clamp(first, first.saturating_add(side).saturating_sub(1))) * edge_m
        };
        let (x, y) = (nearest(candidate.column), nearest(candidate.row));
        let turn = nearest_f32(candidate.turn) * self.turn_step_rad;
        self.penalty.per_square_metre * (x * x + y * y) + self.penalty.per_square_radian * turn * turn
    }

    /// Whether a single pose counts.
    pub(super) fn admits(&self, candidate: &Candidate) -> bool {
        let inside = candidate.column <= self.half_side_cells && candidate.row <= self.half_side_cells;
        inside && !self.excluded.is_some_and(|excluded| excluded.holds(candidate))
    }

    /// The pose of a candidate, in the field's frame.
    pub(super) fn pose(&self, candidate: &Candidate, edge_m: f32) -> Pose2 {
        Pose2::new(
            self.centre.x_m + nearest_f32(candidate.column) * edge_m,
            self.centre.y_m + nearest_f32(candidate.row) * edge_m,
            self.centre.heading_rad + nearest_f32(candidate.turn) * self.turn_step_rad,
        )
    }
}

impl Exclusion {
    fn holds(&self, candidate: &Candidate) -> bool {
        let near = |a: i32, b: i32, limit: i32| a.saturating_sub(b).saturating_abs() <= limit;
        near(candidate.column, self.column, self.half_side_cells)
            && near(candidate.row, self.row, self.half_side_cells)
            && near(candidate.turn, self.turn, self.half_turn_steps)
    }
}

/// Corner and scale of a raster.
pub(super) struct Raster {
    pub(super) origin: Point2,
    pub(super) cells_per_metre: f32,
}

impl Raster {
    fn cell(&self, point: Point2) -> CellOffset {
        let cell = |value: f32, origin: f32| floor((value - origin) * self.cells_per_metre);
        CellOffset { column: cell(point.x_m, self.origin.x_m), row: cell(point.y_m, self.origin.y_m) }
    }
}

/// Towards −∞; a point beyond the numbers is outside every field.
#[inline]
fn floor(value: f32) -> i16 {
    let whole = saturating_i32(value);
    let below = if value < nearest_f32(whole) { whole.saturating_sub(1) } else { whole };
    i16::try_from(below).unwrap_or(if below < 0 { i16::MIN } else { i16::MAX })
}
