//! Places that are met again.

use floorguard_mapping::match_field::FieldLevel;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::saturating_i32;
use nalgebra::Matrix3;

use super::compare::agreement;
use super::config::GraphMappingConfig;
use super::edges::GraphEdge;
use super::kept::{KeptScan, index};
use super::lines::onto_lines;
use super::mapper::{GraphMapper, Searching};
use crate::scan_matching::{
    Candidate, DescentConfig, Exclusion, Found, Guess, MotionPenalty, Refined, SearchScratch, SearchWindow,
    refine, search,
};

/// Path to each side of a place whose scans stand for it, metres.
const AROUND_M: f32 = 5.0;
/// Path before the newest scan whose scans are searched together with it, metres.
const TOGETHER_M: f32 = 4.0;
/// Returns of these that are searched, at most.
pub(super) const SEARCHED_MAX: usize = 160;
/// Pairs that a kept scan is compared with.
const PARTNERS: usize = 2;
/// Places that are compared with the same scan lie this many kept scans apart.
const APART: u16 = 12;
/// Places farther away than the window and this are not compared, metres.
const NEAR_M: f32 = 3.0;
/// Around the best place a second one is not looked for: metres and radians.
const BESIDE: (f32, f32) = (0.8, 0.15);
/// Never surer than this, metres and radians: the returns of two drives lie on the same walls, and not on the same bricks.
const SURE: (f32, f32) = (0.04, 0.012);

/// Half a window at a path between two places.
fn grown([least, growth, most]: [f32; 3], path_m: f32) -> f32 {
    (least + growth * path_m).min(most)
}

impl<const NODES: usize, const POINTS: usize, const EDGES: usize, const CELLS: usize>
    GraphMapper<NODES, POINTS, EDGES, CELLS>
{
    /// Compares the scan that was kept last with earlier places; whether a loop was found.
    pub(super) fn search_loops(&mut self) -> bool {
        let Some(newest) = self.newest() else { return false };
        let (mut before, mut has_found) = (None::<u16>, false);
        for _ in 0..PARTNERS {
            let Some(partner) = self.partner_of(newest, before) else { break };
            has_found |= self.compare(newest, partner);
            before = Some(partner);
        }
        has_found
    }

    /// The nearest earlier place that a scan can have met again, not near `other`.
    fn partner_of(&self, newest: u16, other: Option<u16>) -> Option<u16> {
        let scan = self.scans.get(index(newest))?;
        let mut best: Option<(f32, u16)> = None;
        for (number, earlier) in (0..newest).zip(&self.scans) {
            let path_m = scan.path_m - earlier.path_m;
            let away_m = scan.middle().distance(earlier.middle());
            let is_near = away_m <= NEAR_M + grown(self.config.loop_window_m, path_m);
            let is_other = other.is_none_or(|other| other.abs_diff(number) > APART);
            if path_m >= self.config.loop_path_least_m
                && is_near
                && is_other
                && best.is_none_or(|(least, _)| away_m < least)
            {
                best = Some((away_m, number));
            }
        }
        best.map(|(_, number)| number)
    }

    /// Searches the newest scans in the surroundings of an earlier one.
    pub(super) fn compare(&mut self, newest: u16, partner: u16) -> bool {
        self.counters.searched = self.counters.searched.saturating_add(1);
        let (Some(scan), Some(earlier)) = (self.scans.get(index(newest)), self.scans.get(index(partner)))
        else {
            return false;
        };
        let path_m = scan.path_m - earlier.path_m;
        let expected = earlier.pose.inverse().compose(scan.pose);
        let (here, earlier_pose) = (scan.pose, earlier.pose);
        let around = self.together(partner, AROUND_M);
        self.fill_field(earlier_pose, around);
        let together = self.together(newest, TOGETHER_M);
        let count = self.gather(here, together);
        let Some((found, refined)) = self.locate_place(count, expected, path_m) else { return false };
        let window_m = grown(self.config.loop_window_m, path_m);
        let aside_m = libm::hypotf(found.pose.x_m - expected.x_m, found.pose.y_m - expected.y_m);
        if aside_m > self.config.loop_inner_share * window_m {
            self.counters.at_rim = self.counters.at_rim.saturating_add(1);
            return false;
        }
        let refined = self.laid_onto_lines(count, (earlier_pose, around), &refined);
        if self.contradict((partner, around), (newest, together), refined.pose) {
            self.counters.contradicted = self.counters.contradicted.saturating_add(1);
            return false;
        }
        let edge = edge([partner, newest], &refined);
        let is_kept = edge.is_some_and(|edge| self.edges.push(edge).is_ok());
        let counter = if is_kept { &mut self.counters.accepted } else { &mut self.counters.without_room };
        *counter = counter.saturating_add(1);
        is_kept
    }

    /// The scans that were kept so near to one on the path, metres, from one to before another: one drive's drift does not bend them.
    fn together(&self, number: u16, path_m: f32) -> [usize; 2] {
        let middle = index(number);
        let Some(scan) = self.scans.get(middle) else { return [0, 0] };
        let is_near = |other: &&KeptScan<POINTS>| libm::fabsf(other.path_m - scan.path_m) <= path_m;
        let before = self.scans.get(..middle).unwrap_or_default().iter().rev().take_while(is_near).count();
        let after = self.scans.get(middle..).unwrap_or_default().iter().take_while(is_near).count();
        [middle.saturating_sub(before), middle.saturating_add(after)]
    }

    /// Returns of some scans in the frame of one, thinned evenly, into the room for searches; how many.
    fn gather(&mut self, frame: Pose2, [first, end]: [usize; 2]) -> usize {
        let of = self.scans.get(first..end).unwrap_or_default();
        let all: usize = of.iter().map(|scan| scan.points.len()).sum();
        let step = all.div_ceil(SEARCHED_MAX).max(1);
        let into_frame = frame.inverse();
        let returns = of.iter().flat_map(|scan| {
            let pose = into_frame.compose(scan.pose);
            scan.returns().map(move |point| pose.transform(point))
        });
        let mut count = 0_usize;
        for (room, point) in self.searching.points.iter_mut().zip(returns.step_by(step)) {
            *room = point;
            count = count.saturating_add(1);
        }
        count
    }

    /// The one place of the window where the gathered returns lie; `None`: there is none, or a second one.
    fn locate_place(&mut self, count: usize, expected: Pose2, path_m: f32) -> Option<(Found, Refined)> {
        let Searching { points, cells, blocks, .. } = &mut self.searching;
        let points = points.get(..count)?;
        let levels = self.field.levels();
        let mut look = |window: &SearchWindow| {
            search(&levels, points, window, SearchScratch { cells: &mut cells[..], blocks: &mut blocks[..] })
        };
        let window = window(&self.config, &levels[0], (expected, path_m));
        let Some(found) = look(&window) else {
            self.counters.unlike = self.counters.unlike.saturating_add(1);
            return None;
        };
        let descent = DescentConfig { return_deviation_m: 0.3, ..self.config.descent };
        let refined = refine(&levels[0], points, &Guess::without_odometry(found.pose), &descent);
        if refined.score < self.config.loop_score_least {
            self.counters.unlike = self.counters.unlike.saturating_add(1);
            return None;
        }
        let needed = 1.0 - (1.0 - found.score) * self.config.loop_loss_ratio;
        let edge_m = levels[0].geometry.resolution_m();
        let excluded = Some(exclusion(&found, edge_m, window.turn_step_rad));
        if look(&SearchWindow { excluded, minimum_score: needed, ..window }).is_some() {
            self.counters.ambiguous = self.counters.ambiguous.saturating_add(1);
            return None;
        }
        Some((found, refined))
    }

    /// The same place by the lines of the scans around the earlier one.
    fn laid_onto_lines(
        &mut self,
        count: usize,
        (frame, around): (Pose2, [usize; 2]),
        rough: &Refined,
    ) -> Refined {
        let Searching { points, nearest, .. } = &mut self.searching;
        let Some(points) = points.get(..count) else { return *rough };
        let [first, end] = around;
        let scans = self.scans.get(first..end).unwrap_or_default();
        let into_frame = frame.inverse();
        let placed = scans.iter().map(|scan| (into_frame.compose(scan.pose), scan));
        onto_lines((points, nearest), &Guess::without_odometry(rough.pose), placed)
    }

    /// Both places' returns against the other's scans.
    fn contradict(
        &self,
        (partner, around): (u16, [usize; 2]),
        (newest, together): (u16, [usize; 2]),
        found: Pose2,
    ) -> bool {
        let pose = |number: u16| self.scans.get(index(number)).map_or(Pose2::default(), |scan| scan.pose);
        let of = |[first, end]: [usize; 2]| self.scans.get(first..end).unwrap_or_default();
        let (there, here) = (of(around), of(together));
        // Where the newest scans stand if the loop is right.
        let moved = pose(partner).compose(found).compose(pose(newest).inverse());
        let forward = agreement(returns(here), moved, there.iter().step_by(2));
        let backward = agreement(returns(there), moved.inverse(), here.iter().step_by(2));
        forward.and(backward).exceeds(self.config.loop_conflict_most)
    }
}

/// All returns of scans, in the map.
fn returns<const POINTS: usize>(scans: &[KeptScan<POINTS>]) -> impl Iterator<Item = Point2> + '_ {
    scans.iter().flat_map(|scan| scan.returns().map(|point| scan.pose.transform(point)))
}

/// Where a place is searched around the expected one, after a path of this length between both.
fn window(
    config: &GraphMappingConfig,
    level: &FieldLevel<'_>,
    (expected, path_m): (Pose2, f32),
) -> SearchWindow {
    let cells = grown(config.loop_window_m, path_m) * level.geometry.cells_per_metre();
    let turns = grown(config.loop_turn_rad, path_m) / config.search_step_rad.max(1.0e-3);
    SearchWindow {
        centre: expected,
        half_side_cells: saturating_i32(libm::ceilf(cells)),
        half_turn_steps: saturating_i32(libm::ceilf(turns)),
        turn_step_rad: config.search_step_rad,
        penalty: MotionPenalty::default(),
        excluded: None,
        minimum_score: config.loop_score_least * 0.8,
    }
}

fn exclusion(found: &Found, edge_m: f32, turn_step_rad: f32) -> Exclusion {
    let Candidate { column, row, turn, .. } = found.place;
    Exclusion {
        column,
        row,
        turn,
        half_side_cells: saturating_i32(libm::ceilf(BESIDE.0 / edge_m.max(1.0e-3))),
        half_turn_steps: saturating_i32(libm::ceilf(BESIDE.1 / turn_step_rad.max(1.0e-3))).max(1),
    }
}

/// The loop between two scans.
fn edge(pair: [u16; 2], refined: &Refined) -> Option<GraphEdge> {
    let floor = Matrix3::from_diagonal(&[SURE.0 * SURE.0, SURE.0 * SURE.0, SURE.1 * SURE.1].into());
    let covariance = (refined.information + Matrix3::from_diagonal_element(1.0e-3)).try_inverse()? + floor;
    Some(GraphEdge::new(pair, refined.pose, &covariance.try_inverse()?, false))
}
