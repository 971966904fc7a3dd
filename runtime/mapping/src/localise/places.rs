//! The places of a whole map at which a cloud of returns can lie: coarse everywhere, then exact at the best.

use floorguard_localisation::scan_matching::{Guess, refine};
use floorguard_mapping::match_field::FieldLevel;
use floorguard_types::geometry::{Point2, Pose2};
use nalgebra::Matrix3;

use super::config::LocaliseConfig;
use super::known_map::KnownMap;
use crate::se2::{Se2, wrap};

/// Binary logarithm of the cells along a block, and the cells.
const BLOCK_SHIFT: u8 = 2;
const BLOCK: i32 = 1 << BLOCK_SHIFT;
/// Returns that judge blocks.
const COARSE_POINTS: usize = 120;
/// Returns between two looks at what is still possible.
const CHUNK: usize = 24;
/// Blocks that are judged finely.
const BLOCKS_KEPT: usize = 4_000;
/// Poses that are refined.
const REFINED: usize = 160;
/// Places nearer than this are one place: metres and radians.
pub const APART: (f64, f64) = (0.4, 0.2);

/// A square of cells and a heading, with the most that any of its poses can reach.
#[derive(Clone, Copy, Debug)]
struct Block {
    bound: u32,
    turn: u32,
    column: i32,
    row: i32,
}

/// Cells of the returns for one heading, seen from the cell of the scanner, and the square around them.
#[derive(Default)]
struct Turned {
    cells: Vec<[i32; 2]>,
    low: [i32; 2],
    high: [i32; 2],
}

impl Turned {
    fn set(&mut self, points: &[Point2], heading_rad: f32, cells_per_metre: f32) {
        let (sin, cos) = libm::sincosf(heading_rad);
        self.cells.clear();
        (self.low, self.high) = ([i32::MAX; 2], [i32::MIN; 2]);
        for point in points {
            let cell = |value: f32| (value * cells_per_metre + 0.5).floor() as i32;
            let cell = [cell(cos * point.x_m - sin * point.y_m), cell(sin * point.x_m + cos * point.y_m)];
            for (axis, value) in cell.into_iter().enumerate() {
                self.low[axis] = self.low[axis].min(value);
                self.high[axis] = self.high[axis].max(value);
            }
            self.cells.push(cell);
        }
    }

    /// Sum of the values below the returns with the scanner in a cell; `None` once it cannot exceed `floor`.
    fn sum(&self, level: &FieldLevel<'_>, [column, row]: [i32; 2], floor: u32) -> Option<u32> {
        let (width, height) = (level.geometry.columns() as i32, level.geometry.rows() as i32);
        let is_inside = column + self.low[0] >= 0
            && row + self.low[1] >= 0
            && column + self.high[0] < width
            && row + self.high[1] < height;
        let (mut sum, mut left) = (0_u32, self.cells.len() as u32);
        for cells in self.cells.chunks(CHUNK) {
            sum += if is_inside {
                let index = |cell: &[i32; 2]| ((row + cell[1]) * width + column + cell[0]) as usize;
                cells.iter().map(|cell| u32::from(level.values[index(cell)])).sum::<u32>()
            } else {
                cells.iter().map(|cell| u32::from(level.at(column + cell[0], row + cell[1]))).sum::<u32>()
            };
            left -= cells.len() as u32;
            if sum + left * 255 <= floor {
                return None;
            }
        }
        Some(sum)
    }
}

/// At most `most` places, the best first: poses of the cloud's frame in the map. Places of which the returns reach less than
/// the least score of the settings do not count. Cost: blocks of free floor times headings times 120 returns.
pub fn places(map: &KnownMap, points: &[Point2], config: &LocaliseConfig, most: usize) -> Vec<Se2> {
    let levels = map.levels();
    let Some((fine, coarse)) = levels.first().zip(levels.get(usize::from(BLOCK_SHIFT))) else {
        return Vec::new();
    };
    let thin: Vec<Point2> =
        points.iter().step_by(points.len().div_ceil(COARSE_POINTS).max(1)).copied().collect();
    if thin.is_empty() {
        return Vec::new();
    }
    let blocks = coarse_blocks(map, coarse, &thin, config);
    let poses = fine_poses(fine, &thin, blocks, config);
    let origin = fine.geometry.origin_in_map();
    let edge_m = fine.geometry.resolution_m();
    let mut refined: Vec<(f32, Se2)> = Vec::new();
    for pose in poses {
        let centre = |cell: i32, origin: f32| (cell as f32 + 0.5) * edge_m + origin;
        let heading_rad = pose.turn as f32 * config.turn_step_rad;
        let start = Pose2::new(centre(pose.column, origin.x_m), centre(pose.row, origin.y_m), heading_rad);
        let guess = Guess { start, expected: start, information: Matrix3::zeros() };
        let found = refine(fine, points, &guess, &config.descent);
        let place = Se2::from(found.pose);
        if found.score >= config.score_least && refined.iter().all(|(_, other)| are_apart(*other, place)) {
            refined.push((found.score, place));
        }
    }
    refined.sort_by(|a, b| b.0.total_cmp(&a.0));
    refined.into_iter().take(most).map(|(_, place)| place).collect()
}

/// Whether two poses are different places.
pub fn are_apart(a: Se2, b: Se2) -> bool {
    a.distance(b) > APART.0 || wrap(a.heading_rad - b.heading_rad).abs() > APART.1
}

/// The blocks of free floor that can hold the best poses.
fn coarse_blocks(
    map: &KnownMap,
    level: &FieldLevel<'_>,
    points: &[Point2],
    config: &LocaliseConfig,
) -> Vec<Block> {
    let starts = map.free_blocks(BLOCK);
    let turns = (std::f32::consts::TAU / config.turn_step_rad).ceil() as u32;
    let mut floor = (config.score_least * 255.0 * points.len() as f32) as u32;
    let mut turned = Turned::default();
    let mut kept: Vec<Block> = Vec::with_capacity(2 * BLOCKS_KEPT);
    for turn in 0..turns {
        turned.set(points, turn as f32 * config.turn_step_rad, level.geometry.cells_per_metre());
        for &[column, row] in &starts {
            let Some(bound) = turned.sum(level, [column, row], floor) else { continue };
            kept.push(Block { bound, turn, column, row });
            if kept.len() >= 2 * BLOCKS_KEPT {
                floor = floor.max(cut(&mut kept, BLOCKS_KEPT));
            }
        }
    }
    cut(&mut kept, BLOCKS_KEPT);
    kept.sort_unstable_by_key(order);
    kept
}

/// The best first; equal ones by their place, so that the order is always the same.
fn order(block: &Block) -> (std::cmp::Reverse<u32>, u32, i32, i32) {
    (std::cmp::Reverse(block.bound), block.turn, block.row, block.column)
}

/// Keeps the best; answers the least bound among them.
fn cut(blocks: &mut Vec<Block>, most: usize) -> u32 {
    if blocks.len() > most {
        blocks.select_nth_unstable_by_key(most - 1, order);
        blocks.truncate(most);
    }
    blocks.iter().map(|block| block.bound).min().unwrap_or(0)
}

/// The best pose of each block, the best first; of poses near each other one.
fn fine_poses(
    level: &FieldLevel<'_>,
    points: &[Point2],
    mut blocks: Vec<Block>,
    config: &LocaliseConfig,
) -> Vec<Block> {
    blocks.sort_by_key(|block| (block.turn, order(block)));
    let mut turned = Turned::default();
    let mut turn = u32::MAX;
    let mut poses: Vec<Block> = Vec::new();
    for block in &blocks {
        if block.turn != turn {
            turn = block.turn;
            turned.set(points, turn as f32 * config.turn_step_rad, level.geometry.cells_per_metre());
        }
        let mut best: Option<Block> = None;
        for row in block.row..block.row + BLOCK {
            for column in block.column..block.column + BLOCK {
                let floor = best.map_or(0, |best| best.bound);
                if let Some(bound) = turned.sum(level, [column, row], floor) {
                    best = Some(Block { bound, turn, column, row });
                }
            }
        }
        poses.extend(best);
    }
    poses.sort_by_key(order);
    let edge_m = f64::from(level.geometry.resolution_m());
    let place = |block: &Block| {
        let heading_rad = f64::from(block.turn) * f64::from(config.turn_step_rad);
        Se2::new(f64::from(block.column) * edge_m, f64::from(block.row) * edge_m, heading_rad)
    };
    let mut chosen: Vec<Block> = Vec::new();
    for pose in poses {
        if chosen.len() >= REFINED {
            break;
        }
        if chosen.iter().all(|other| are_apart(place(other), place(&pose))) {
            chosen.push(pose);
        }
    }
    chosen
}
