//! The beams of the last metres by which the places of a map are compared.
//!
//! Every piece of surface counts once. A box beside the robot takes a third of the beams of all scans, and yet is one box; walls that are
//! seen from afar say more, because they stand where they stood. So the beams that end in one cell share its weight.

use std::collections::BTreeMap;

use floorguard_mapping::Occupancy;
use floorguard_types::geometry::Point2;

use super::known_map::KnownMap;
use super::permanence::StraightPieces;
use super::support::{AskedBeam, Support, thinned};
use crate::front_end::Node;
use crate::grid_map::GridMap;
use crate::se2::Se2;

/// Scans, and beams of each, that are asked about a place.
const ASKED_SCANS: usize = 24;
const ASKED_BEAMS: usize = 60;
/// The newest of them, which must fit by themselves.
const NEWEST_SCANS: usize = 2;
/// Edge of a piece of surface, metres: the returns of a search are thinned as much.
const SURFACE_M: f64 = 0.2;
/// Edge of the cells in which the scans show what is long and straight, metres: that of most maps.
const SEEN_CELL_M: f64 = 0.05;

/// A scan whose beams are asked.
struct AskedScan {
    /// Its pose in the frame of the last one.
    from_last: Se2,
    beams: Vec<AskedBeam>,
}

/// Scans of the last metres, the newest first.
pub struct Evidence {
    scans: Vec<AskedScan>,
}

impl Evidence {
    /// Of the scans of a path.
    pub fn new(nodes: &[Node]) -> Self {
        let Some(last) = nodes.last() else { return Self { scans: Vec::new() } };
        let asked: Vec<&Node> =
            nodes.iter().rev().step_by(nodes.len().div_ceil(ASKED_SCANS).max(1)).collect();
        let mut returns = BTreeMap::new();
        for node in &asked {
            for point in thinned(&node.points, ASKED_BEAMS) {
                *returns.entry(surface(node.pose.transform(*point))).or_insert(0.0) += 1.0;
            }
        }
        let seen = Seen::new(nodes);
        let beams = |node: &Node| {
            let beam = |point: &Point2| {
                let place = node.pose.transform(*point);
                let sharing: f64 = returns.get(&surface(place)).copied().unwrap_or(1.0);
                AskedBeam { point: *point, weight: 1.0 / sharing, permanence: seen.permanence_at(place) }
            };
            thinned(&node.points, ASKED_BEAMS).map(beam).collect()
        };
        let scan = |node: &&Node| AskedScan { from_last: last.pose.between(node.pose), beams: beams(node) };
        Self { scans: asked.iter().map(scan).collect() }
    }

    /// What all scans say of a place of the last one in a map, and what the newest of them say alone, at most 1.
    pub fn support_at(&self, map: &KnownMap, pose: Se2) -> (Support, f64) {
        let (mut whole, mut newest) = (Support::default(), 0.0);
        for (index, scan) in self.scans.iter().enumerate() {
            let place = pose.compose(scan.from_last);
            scan.beams.iter().for_each(|beam| whole.ask(map, place, beam));
            if index < NEWEST_SCANS {
                newest = whole.value();
            }
        }
        (whole, newest)
    }
}

/// The piece of surface at a place.
fn surface([x_m, y_m]: [f64; 2]) -> (i64, i64) {
    ((x_m / SURFACE_M).floor() as i64, (y_m / SURFACE_M).floor() as i64)
}

/// What of the scans themselves is long and straight.
struct Seen {
    grid: GridMap,
    pieces: StraightPieces,
}

impl Seen {
    fn new(nodes: &[Node]) -> Self {
        let places =
            || nodes.iter().flat_map(|node| node.points.iter().map(|point| node.pose.transform(*point)));
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places() {
            low = [low[0].min(place[0]), low[1].min(place[1])];
            high = [high[0].max(place[0]), high[1].max(place[1])];
        }
        let side = |axis: usize| ((high[axis] - low[axis]).max(0.0) / SEEN_CELL_M) as usize + 2;
        let (columns, rows) = (side(0), side(1));
        let cells = vec![Occupancy::Free; columns * rows];
        let mut grid = GridMap { columns, rows, cell_m: SEEN_CELL_M, corner_m: low, cells };
        for place in places() {
            let [column, row] = grid.cell_of(place);
            if let Some(cell) = grid.cells.get_mut((row * columns as i64 + column) as usize) {
                *cell = Occupancy::Occupied;
            }
        }
        let pieces = StraightPieces::new(&grid);
        Self { grid, pieces }
    }

    fn permanence_at(&self, place: [f64; 2]) -> f64 {
        self.pieces.permanence_at(self.grid.cell_of(place))
    }
}

#[cfg(test)]
mod tests {
    use floorguard_mapping::Occupancy::{Free, Occupied};
    use nalgebra::Matrix3;

    use super::super::config::LocaliseConfig;
    use super::*;

    fn scan(x_m: f64, points: Vec<Point2>) -> Node {
        let pose = Se2::new(x_m, 0.0, 0.0);
        let information = Matrix3::zeros();
        Node { time_s: 0.0, pose, odometry: None, points: points.into(), information, score: 1.0 }
    }

    /// Returns of a straight front four metres ahead, so many centimetres apart.
    fn front(width_m: f32, apart_m: f32) -> Vec<Point2> {
        let count = (width_m / apart_m) as usize;
        (0..count).map(|index| Point2::new(4.05, apart_m * index as f32 - 0.5 * width_m)).collect()
    }

    #[test]
    fn surfaces_count_once_for_all_scans() {
        // A wall in pieces of 0.25 m and a post that takes as many beams, in ten scans from one place.
        let mut points = front(7.5, 0.25);
        points.extend((0..30).map(|_| Point2::new(1.1, 0.1)));
        let evidence = Evidence::new(&vec![scan(0.0, points); 10]);
        let weight = |is_post: bool| {
            let beams = evidence.scans.iter().flat_map(|scan| &scan.beams);
            beams.filter(|beam| (beam.point.x_m < 2.0) == is_post).map(|beam| beam.weight).sum::<f64>()
        };
        assert!((weight(true) - 1.0).abs() < 1.0e-9, "{}", weight(true));
        assert!((weight(false) - 30.0).abs() < 1.0e-9, "{}", weight(false));
    }

    #[test]
    fn unmapped_walls_contradict_boxes_do_not() {
        // An empty room of 20 × 20 m, in which the scans show a front four metres ahead.
        let is_wall = |index: usize| [0, 199].contains(&(index % 200)) || [0, 199].contains(&(index / 200));
        let cells = (0..40_000).map(|index| if is_wall(index) { Occupied } else { Free }).collect();
        let room = GridMap { columns: 200, rows: 200, cell_m: 0.1, corner_m: [-10.0, -10.0], cells };
        let map = KnownMap::new(room, &LocaliseConfig::default()).expect("walls");
        let contradiction = |width_m: f32| {
            let evidence = Evidence::new(&[scan(0.0, front(width_m, 0.04))]);
            evidence.support_at(&map, Se2::default()).0.contradiction()
        };
        assert!(contradiction(6.0) > 4.0, "a wall: {}", contradiction(6.0));
        assert!(contradiction(1.2) < 1.0e-9, "a box: {}", contradiction(1.2));
    }

    #[test]
    fn nothing_seen_says_nothing() {
        assert!(Evidence::new(&[]).scans.is_empty());
        assert!(Evidence::new(&[scan(0.0, Vec::new())]).scans[0].beams.is_empty());
    }
}
