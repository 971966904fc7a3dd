//! Follows the scanner from scan to scan.

use floorguard_localisation::scan_matching::{
    Candidate, CellOffset, Guess, MotionPenalty, Refined, SearchScratch, SearchWindow, refine, search,
};
use floorguard_types::geometry::Point2;
use nalgebra::Matrix3;

use super::config::FrontEndConfig;
use super::local_map::LocalMap;
use super::node::{Node, Passage};
use super::packed::PackedScan;
use crate::input::ScanRecord;
use crate::se2::Se2;

/// What a record became.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// A kept scan: its index.
    Node(usize),
    /// The robot has hardly moved.
    Passed,
}

/// Tracking without loop closing: its frame begins at the first scan and drifts.
pub struct Tracker {
    config: FrontEndConfig,
    /// The kept scans.
    pub nodes: Vec<Node>,
    /// The scans between them.
    pub passages: Vec<Passage>,
    pub(super) maps: Vec<LocalMap>,
    pub(super) last_alone: Option<LastAlone>,
    cells: Vec<CellOffset>,
    blocks: Vec<Candidate>,
}

/// The last scan without odometry.
#[derive(Clone, Copy)]
pub(super) struct LastAlone {
    pub(super) time_s: f64,
    pub(super) pose: Se2,
    /// Motion a second, in the scanner's frame.
    pub(super) speed: Se2,
    /// Motion since the scan before it.
    pub(super) step: Se2,
}

/// Motions that differ by more, metres and radians, are both tried.
const UNLIKE: [f64; 2] = [0.05, 0.03];
/// No robot that cleans is faster, m/s and rad/s: stamps that say so are uneven.
const SPEED_MAX: [f64; 2] = [2.0, 2.5];

/// Blocks that a search of the tracking can keep.
const BLOCKS: usize = 8_192;

impl Tracker {
    /// Nothing yet.
    #[must_use]
    pub fn new(config: FrontEndConfig) -> Self {
        Self {
            config,
            nodes: Vec::new(),
            passages: Vec::new(),
            maps: Vec::new(),
            last_alone: None,
            cells: Vec::new(),
            blocks: vec![Candidate::default(); BLOCKS],
        }
    }

    /// Takes the next scan.
    pub fn push(&mut self, record: &ScanRecord) -> Step {
        let points = || record.points(self.config.range_least_m, self.config.range_most_m);
        let Some(node) = self.nodes.last() else {
            let start = record.odometry.unwrap_or_default();
            return self.keep(record, start, Refined::none(), points());
        };
        let (Some(before), Some(now)) = (node.odometry, record.odometry) else {
            return self.push_alone(record);
        };
        let moved = before.between(now);
        if self.has_hardly_moved(moved) {
            return self.pass(record, moved, record.motion);
        }
        let points = points();
        let expected = node.pose.compose(moved);
        let (distance, turn) = (moved.length_m(), moved.heading_rad.abs());
        let half_m = 0.1 + 0.25 * distance + 0.1 * turn;
        let half_rad = 0.05 + 0.25 * turn + 0.05 * distance;
        let refined = self.locate(&points, expected, [half_m, half_rad]);
        let pose = self.maps.first().map_or(expected, |map| map.origin.compose(refined.pose.into()));
        self.keep(record, pose, refined, points)
    }

    /// A scan without odometry: the motion since the last scan goes on, and the window is wide enough for a robot that
    /// starts or stops.
    fn push_alone(&mut self, record: &ScanRecord) -> Step {
        let Some(node) = self.nodes.last() else { return Step::Passed };
        let node_pose = node.pose;
        // The next scans are followed by their odometry once a kept scan has one.
        let begins = node.odometry.is_none() && record.odometry.is_some();
        let last = self.last_alone.filter(|last| last.time_s >= node.time_s).unwrap_or(LastAlone {
            time_s: node.time_s,
            pose: node_pose,
            speed: Se2::default(),
            step: Se2::default(),
        });
        let passed_s = (record.time_s - last.time_s).clamp(1.0e-3, 1.0);
        let (least_m, most_m) = (self.config.range_least_m, self.config.range_most_m);
        let points = record.points_in_motion(least_m, most_m, last.speed);
        let moved = last.speed.scaled(passed_s);
        let window = [(0.1 + 0.7 * passed_s).min(0.6), (0.05 + 0.7 * passed_s).min(0.5)];
        let mut expected = last.pose.compose(moved);
        let mut refined = self.locate(&points, expected, window);
        let other = last.step.between(moved);
        if other.length_m() > UNLIKE[0] || other.heading_rad.abs() > UNLIKE[1] {
            // A log that is written in bursts has uneven stamps; its scans are even.
            let by_step = last.pose.compose(last.step);
            let found = self.locate(&points, by_step, window);
            if found.score > refined.score {
                (expected, refined) = (by_step, found);
            }
        }
        let pose = self.maps.first().map_or(expected, |map| map.origin.compose(refined.pose.into()));
        let step = last.pose.between(pose);
        let slower = (step.length_m() / SPEED_MAX[0]).max(step.heading_rad.abs() / SPEED_MAX[1]);
        let speed = step.scaled(1.0 / passed_s.max(slower));
        self.last_alone = Some(LastAlone { time_s: record.time_s, pose, speed, step });
        let since_node = node_pose.between(pose);
        if !begins && self.has_hardly_moved(since_node) {
            return self.pass(record, since_node, last.speed);
        }
        self.keep(record, pose, refined, points)
    }

    /// Frees the local maps, once no scan is to come any more.
    pub fn forget_maps(&mut self) {
        self.maps = Vec::new();
        self.cells = Vec::new();
    }

    fn has_hardly_moved(&self, moved: Se2) -> bool {
        moved.length_m() < self.config.travel_m && moved.heading_rad.abs() < self.config.turn_rad
    }

    fn pass(&mut self, record: &ScanRecord, from_node: Se2, motion: Se2) -> Step {
        let node = self.nodes.len().saturating_sub(1);
        let scan = PackedScan::new(record, [self.config.range_least_m, self.config.range_most_m], motion);
        self.passages.push(Passage { time_s: record.time_s, node, from_node, scan });
        Step::Passed
    }

    /// Searches the scan in the older of the local maps; `half_m` and `half_rad` are half the window.
    fn locate(&mut self, points: &[Point2], expected: Se2, [half_m, half_rad]: [f64; 2]) -> Refined {
        let config = &self.config;
        let Some(map) = self.maps.first() else { return Refined::none() };
        let centre = map.origin.between(expected).single();
        self.cells.resize(points.len(), CellOffset::default());
        let window = SearchWindow {
            centre,
            half_side_cells: (half_m as f32 / config.cell_m) as i32,
            half_turn_steps: (half_rad as f32 / config.search_step_rad) as i32,
            turn_step_rad: config.search_step_rad,
            penalty: MotionPenalty {
                per_square_metre: config.rim_penalty / (half_m * half_m) as f32,
                per_square_radian: config.rim_penalty / (half_rad * half_rad) as f32,
            },
            excluded: None,
            minimum_score: 0.0,
        };
        let levels = map.field().levels();
        let scratch = SearchScratch { cells: &mut self.cells, blocks: &mut self.blocks };
        let found = search(&levels, points, &window, scratch);
        let start = found.map_or(centre, |found| found.pose);
        let inverse_square = |value: f32| 1.0 / (value * value);
        let place = inverse_square(0.5 * half_m as f32);
        let heading = inverse_square(0.5 * half_rad as f32);
        let information = Matrix3::from_diagonal(&[place, place, heading].into());
        let guess = Guess { start, expected: centre, information };
        refine(&levels[0], points, &guess, &config.descent)
    }

    fn keep(&mut self, record: &ScanRecord, pose: Se2, refined: Refined, points: Vec<Point2>) -> Step {
        let index = self.nodes.len();
        let travelled = self.nodes.last().map_or(0.0, |node| node.pose.distance(pose));
        for map in &mut self.maps {
            map.travelled_m += travelled;
        }
        let due = self.maps.last().is_none_or(|map| {
            map.travelled_m >= self.config.map_travel_m || map.scans >= self.config.map_nodes
        });
        if due {
            if self.maps.len() >= 2 {
                self.maps.remove(0);
            }
            self.maps.extend(LocalMap::new(pose, index, &self.config));
        }
        for map in &mut self.maps {
            map.insert(pose, &points);
        }
        self.nodes.push(Node {
            time_s: record.time_s,
            pose,
            odometry: record.odometry,
            points: points.into_boxed_slice(),
            information: in_own_frame(&refined),
            score: refined.score,
        });
        Step::Node(index)
    }
}

/// The information of a match, turned from the field's frame into the scan's.
fn in_own_frame(refined: &Refined) -> Matrix3<f32> {
    let (sin, cos) = libm::sincosf(refined.pose.heading_rad);
    let turn = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
    turn.transpose() * refined.information * turn
}
