//! Branch and bound over a window of poses: the best pose of the window, exactly.

use floorguard_mapping::match_field::FieldLevel;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{nearest_f32, saturating_i32};

use super::candidate::{Candidate, CellOffset, TurnedPoints, sum_of_values};
use super::window::{Raster, SearchWindow};

/// Room that a search needs; its size limits the points and the blocks that are kept.
#[derive(Debug)]
pub struct SearchScratch<'a> {
    /// One for each point.
    pub cells: &'a mut [CellOffset],
    /// One for each block of the coarsest level that passes the minimum score.
    pub blocks: &'a mut [Candidate],
}

/// The best pose of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// In the field's frame.
    pub pose: Pose2,
    /// Mean value of the points there less the penalty, 0 to 1.
    pub score: f32,
    /// Where it lies in the window.
    pub place: Candidate,
    /// Blocks that were left out because the list was full; 0 means that the answer is exact.
    pub left_out: u32,
}

/// Blocks of one root that wait: seven levels with four children each, or two with sixteen, and what is left of them.
const PENDING_MAX: usize = 64;
/// Blocks that one root can be split into, a bound of the loop: a root of 128 × 128 cells has 21,845.
const SPLITS_MAX: usize = 32_768;

struct Search<'a> {
    levels: &'a [FieldLevel<'a>],
    points: &'a [Point2],
    window: &'a SearchWindow,
    raster: Raster,
    edge_m: f32,
    full_score: f32,
    best: Candidate,
    left_out: u32,
}

/// Finds the pose of the window at which the points lie on the highest values. `levels` come from fine to coarse, the
/// first with shift 0; every level bounds the one before. `None`: no pose reaches the minimum score, or there is no
/// point or no level.
///
/// Exact within the window (Hess et al. 2016, section V.B) as long as `left_out` is 0. Cost: points times blocks, of
/// which the bounds leave some hundred to some thousand.
#[must_use]
pub fn search(
    levels: &[FieldLevel<'_>],
    points: &[Point2],
    window: &SearchWindow,
    scratch: SearchScratch<'_>,
) -> Option<Found> {
    let geometry = levels.first()?.geometry;
    let count = points.len().min(scratch.cells.len());
    if count == 0 {
        return None;
    }
    let points = points.get(..count)?;
    let full_score = nearest_f32(count) * 255.0;
    // Strictly better than this counts.
    let floor = saturating_i32(window.minimum_score * full_score);
    let mut search = Search {
        levels,
        points,
        window,
        raster: Raster { origin: geometry.origin_in_map(), cells_per_metre: geometry.cells_per_metre() },
        edge_m: geometry.resolution_m(),
        full_score,
        best: Candidate { bound: floor, level: usize::MAX, ..Candidate::default() },
        left_out: 0,
    };
    let SearchScratch { cells, blocks } = scratch;
    let roots = search.fill_roots(cells, blocks);
    let blocks = blocks.get_mut(..roots)?;
    blocks
        .sort_unstable_by_key(|block| (core::cmp::Reverse(block.bound), block.turn, block.row, block.column));
    for block in blocks.iter() {
        if block.bound <= search.best.bound {
            break;
        }
        let turned = window.rotate(block.turn, &search.raster, points, cells);
        search.descend(*block, &turned);
    }
    let best = search.best;
    (best.level == 0).then(|| Found {
        pose: window.pose(&best, search.edge_m),
        score: nearest_f32(best.bound) / full_score,
        place: best,
        left_out: search.left_out,
    })
}

/// Cells along a block of the coarsest level that a reader needs to think of: shifts are at most 15.
const BLOCK_SIDE_MAX: i32 = 1 << 15;
/// Half a window, cells: 160 m at 1 cm.
const HALF_SIDE_MAX: i32 = 1 << 14;
/// Half a window of turns, steps: a turn of 2 π in steps of a twentieth of a degree.
const TURN_STEPS_MAX: i32 = 3_600;

impl Search<'_> {
    /// The upper bound of a block, exact where it is better than the best.
    fn judge(&self, candidate: Candidate, points: &TurnedPoints<'_>) -> Candidate {
        let Some(level) = self.levels.get(candidate.level) else { return candidate };
        let penalty = self.window.least_penalty(&candidate, level.shift, self.edge_m) * self.full_score;
        let penalty = saturating_i32(penalty);
        let needed = self.best.bound.saturating_add(penalty);
        let sum = sum_of_values(level, points, [candidate.column, candidate.row], needed);
        Candidate { bound: sum.saturating_sub(penalty), ..candidate }
    }

    /// Judges all blocks of the coarsest level; answers how many are kept.
    fn fill_roots(&mut self, cells: &mut [CellOffset], blocks: &mut [Candidate]) -> usize {
        let level = self.levels.len().saturating_sub(1);
        let side = 1_usize << self.levels.get(level).map_or(0, |level| level.shift.min(15));
        let (half, turns) = (self.window.half_side_cells.max(0), self.window.half_turn_steps.max(0));
        let mut kept = 0_usize;
        for turn in -turns..=turns.min(TURN_STEPS_MAX) {
            let turned = self.window.rotate(turn, &self.raster, self.points, cells);
            for row in (-half..=half.min(HALF_SIDE_MAX)).step_by(side) {
                for column in (-half..=half.min(HALF_SIDE_MAX)).step_by(side) {
                    let block = self.judge(Candidate { bound: 0, turn, column, row, level }, &turned);
                    if block.bound <= self.best.bound {
                        continue;
                    }
                    if level == 0 {
                        self.accept(block);
                        continue;
                    }
                    match blocks.get_mut(kept) {
                        Some(place) => *place = block,
                        None => {
                            self.left_out = self.left_out.saturating_add(1);
                            continue;
                        }
                    }
                    kept = kept.saturating_add(1);
                }
            }
        }
        kept
    }

    fn accept(&mut self, candidate: Candidate) {
        if candidate.bound > self.best.bound && self.window.admits(&candidate) {
            self.best = candidate;
        }
    }

    /// Splits a block until nothing of it can be better than the best.
    fn descend(&mut self, root: Candidate, points: &TurnedPoints<'_>) {
        let mut pending: heapless::Vec<Candidate, PENDING_MAX> = heapless::Vec::new();
        let _ = pending.push(root);
        for _ in 0..SPLITS_MAX {
            let Some(block) = pending.pop() else { return };
            if block.bound <= self.best.bound {
                continue;
            }
            let first_child = pending.len();
            self.split(block, points, &mut pending);
            // The most promising child is taken first.
            if let Some(children) = pending.get_mut(first_child..) {
                children.sort_unstable_by_key(|child| child.bound);
            }
        }
        self.left_out = self.left_out.saturating_add(1);
    }

    fn split(
        &mut self,
        block: Candidate,
        points: &TurnedPoints<'_>,
        pending: &mut heapless::Vec<Candidate, PENDING_MAX>,
    ) {
        let level = block.level.saturating_sub(1);
        let shift = |level: usize| self.levels.get(level).map_or(0, |level| level.shift.min(15));
        let (side, step) = (1_i32 << shift(block.level), 1_usize << shift(level));
        for row in (0..side.min(BLOCK_SIDE_MAX)).step_by(step) {
            for column in (0..side.min(BLOCK_SIDE_MAX)).step_by(step) {
                let child = Candidate {
                    column: block.column.saturating_add(column),
                    row: block.row.saturating_add(row),
                    level,
                    ..block
                };
                let half = self.window.half_side_cells;
                if child.column > half || child.row > half {
                    continue;
                }
                let child = self.judge(child, points);
                if level == 0 {
                    self.accept(child);
                } else if child.bound > self.best.bound && pending.push(child).is_err() {
                    self.left_out = self.left_out.saturating_add(1);
                }
            }
        }
    }
}
