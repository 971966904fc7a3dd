//! Follows the scanner, keeps scans, closes loops.

use floorguard_mapping::GridGeometry;
use floorguard_mapping::match_field::MatchField;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{count_u32, nearest_f32};
use heapless::Vec;
use nalgebra::Matrix3;

use super::config::GraphMappingConfig;
use super::edges::GraphEdge;
use super::gradient::Gradient;
use super::kept::{KeptScan, index};
use super::lines::Nearest;
use super::loops::SEARCHED_MAX;
use super::outcome::{LoopCounters, MappingStep};
use super::solve::solve;
use super::tracking::{Match, SCORE_LEAST};
use crate::scan_matching::{Candidate, CellOffset, Refined};

/// Cells along a side of the field of returns: 19.2 m.
const FIELD_SIDE: u16 = 192;
/// Edge of its cells, metres.
pub(super) const FIELD_CELL_M: f32 = 0.1;
/// Cells of the field.
pub const FIELD_CELLS: usize = 192 * 192;
/// Blocks that a search can keep.
const BLOCKS: usize = 256;
/// Deviation of a step that the match did not hold, at rest and for each metre and radian of it: metres and radians.
const STEP: ([f32; 2], f32) = ([0.05, 0.03], 0.1);
/// A scan of which a larger share lies on those around shows nothing new.
const SHARE_KNOWN: f32 = 0.8;
/// So far from a place that was met again the others around it are believed, metres: the drift is some centimetres.
pub(super) const KNOWN_PATH_M: f32 = 3.0;
/// Path from a place that was met again to the next search for one, metres.
const LOOP_EVERY_M: f32 = 1.5;

/// 368 scans of 40 returns: 198,000 bytes in all, a building of 30 × 30 m.
pub type OfMicrocontroller = GraphMapper<368, 40, 432, FIELD_CELLS>;

/// Room that searches need.
#[derive(Clone, Debug)]
pub(super) struct Searching {
    pub(super) points: [Point2; SEARCHED_MAX],
    pub(super) cells: [CellOffset; SEARCHED_MAX],
    pub(super) blocks: [Candidate; BLOCKS],
    pub(super) nearest: [Nearest; SEARCHED_MAX],
}

/// A map under construction: `NODES` kept scans of `POINTS` returns, `EDGES` of what is known about pairs of them, a field of `CELLS` cells
/// ([`FIELD_CELLS`]).
#[derive(Clone, Debug)]
pub struct GraphMapper<const NODES: usize, const POINTS: usize, const EDGES: usize, const CELLS: usize> {
    pub(super) config: GraphMappingConfig,
    pub(super) scans: Vec<KeptScan<POINTS>, NODES>,
    pub(super) edges: Vec<GraphEdge, EDGES>,
    pub(super) field: MatchField<[u8; CELLS]>,
    pub(super) searching: Searching,
    pub(super) counters: LoopCounters,
    gradient: Gradient<NODES>,
    /// The scan in whose frame the robot is followed.
    pub(super) reference: u16,
    /// The field holds the surroundings of the reference.
    pub(super) field_is_fresh: bool,
    /// Scanner in the frame of the reference, at the last match; and odometry there.
    matched: (Pose2, Pose2),
    /// Odometry since then.
    since: Pose2,
    /// Path since the first scan, metres; and at the last place that had been met before.
    pub(super) path_m: f32,
    pub(super) known_path_m: f32,
    revision: u32,
}

impl<const NODES: usize, const POINTS: usize, const EDGES: usize, const CELLS: usize>
    GraphMapper<NODES, POINTS, EDGES, CELLS>
{
    /// An empty map. `None`: `CELLS` is less than [`FIELD_CELLS`].
    #[must_use]
    pub fn new(config: GraphMappingConfig) -> Option<Self> {
        let half_m = -0.5 * FIELD_CELL_M * nearest_f32(FIELD_SIDE);
        let geometry = GridGeometry::new(FIELD_SIDE, FIELD_SIDE, FIELD_CELL_M, Point2::new(half_m, half_m))?;
        let field = MatchField::new(geometry, [[0; CELLS], [0; CELLS]], config.descent.reach_m).ok()?;
        Some(Self {
            config,
            scans: Vec::new(),
            edges: Vec::new(),
            field,
            searching: Searching {
                points: [Point2::default(); SEARCHED_MAX],
                cells: [CellOffset::default(); SEARCHED_MAX],
                blocks: [Candidate::default(); BLOCKS],
                nearest: [Nearest::NONE; SEARCHED_MAX],
            },
            counters: LoopCounters::default(),
            gradient: Gradient::new(),
            reference: 0,
            field_is_fresh: false,
            matched: (Pose2::default(), Pose2::default()),
            since: Pose2::default(),
            path_m: 0.0,
            known_path_m: f32::NEG_INFINITY,
            revision: 0,
        })
    }

    /// Takes the next scan: its returns in the scanner's frame, in the order of the beams, and the scanner in odometry's frame. Returns
    /// beyond the limits of the settings are left out, and a scan whose odometry is not finite. Cost: a search over a small window; with a
    /// kept scan two more over large ones, and with a loop the solution of all poses.
    ///
    /// Scans and odometry are taken for what they are: frozen, repeated or late ones are to be left out before, as `floorguard map` does.
    pub fn push(&mut self, returns: &[Point2], odometry: Pose2) -> MappingStep {
        if !(odometry.x_m.is_finite() && odometry.y_m.is_finite() && odometry.heading_rad.is_finite()) {
            self.counters.scans_unlike = self.counters.scans_unlike.saturating_add(1);
            return MappingStep::Unlike;
        }
        let count = self.take(returns);
        if self.scans.is_empty() {
            return self.keep(count, odometry, None);
        }
        let moved = self.matched.1.inverse().compose(odometry);
        let length = libm::hypotf(moved.x_m, moved.y_m);
        let turn = libm::fabsf(moved.heading_rad);
        self.since = moved;
        if length < self.config.travel_m && turn < self.config.turn_rad {
            return MappingStep::Passed;
        }
        self.path_m += length;
        let expected = self.matched.0.compose(moved);
        let half = [0.1 + 0.25 * length + 0.1 * turn, 0.05 + 0.25 * turn + 0.05 * length];
        let Match { refined, share } = self.locate(count, expected, half);
        let is_like = refined.score >= SCORE_LEAST;
        self.matched = (if is_like { refined.pose } else { expected }, odometry);
        self.since = Pose2::default();
        if !is_like {
            self.counters.scans_unlike = self.counters.scans_unlike.saturating_add(1);
        }
        let away = libm::hypotf(self.matched.0.x_m, self.matched.0.y_m);
        if away < self.config.keep_m && libm::fabsf(self.matched.0.heading_rad) < self.config.keep_rad {
            return if is_like { MappingStep::Matched } else { MappingStep::Unlike };
        }
        if share >= SHARE_KNOWN && self.follow_known() {
            return MappingStep::Matched;
        }
        self.keep(count, odometry, Some((refined, is_like)))
    }

    /// Keeps the scan, and looks whether its place was met before.
    fn keep(&mut self, count: usize, odometry: Pose2, refined: Option<(Refined, bool)>) -> MappingStep {
        let pose = self.pose();
        let returns = self.searching.points.get(..count).unwrap_or_default();
        let scan = KeptScan::new(pose, self.path_m, returns);
        let edge = refined.map(|(refined, is_like)| {
            let information = if is_like { refined.information } else { Matrix3::zeros() };
            self.step_edge(&information)
        });
        let number = u16::try_from(self.scans.len()).unwrap_or(u16::MAX);
        let has_room = self.edges.len() < EDGES;
        if !has_room || self.scans.push(scan).is_err() {
            self.counters.scans_without_room = self.counters.scans_without_room.saturating_add(1);
            self.follow_nearest();
            let is_lost = refined.is_some_and(|(_, is_like)| !is_like);
            return if is_lost { MappingStep::Unlike } else { MappingStep::Full };
        }
        if let Some(edge) = edge {
            let _ = self.edges.push(GraphEdge { to: number, ..edge });
        }
        self.reference = number;
        self.matched = (Pose2::default(), odometry);
        self.field_is_fresh = false;
        let is_due = self.path_m - self.known_path_m > LOOP_EVERY_M;
        if is_due && self.search_loops() {
            self.known_path_m = self.path_m;
            solve(&mut self.scans, &self.edges, (&mut self.gradient, self.config.loop_trusted));
            self.revision = self.revision.saturating_add(1);
        }
        MappingStep::Kept(number)
    }

    /// What the match says of the step from the reference, and what odometry adds where the match leaves a direction open.
    fn step_edge(&self, information: &Matrix3<f32>) -> GraphEdge {
        let measured = self.matched.0;
        let (length, turn) = (libm::hypotf(measured.x_m, measured.y_m), libm::fabsf(measured.heading_rad));
        let ([rest_m, rest_rad], share) = STEP;
        let (off_m, off_rad) = (rest_m + share * (length + turn), rest_rad + share * (turn + 0.3 * length));
        let (place, heading) = (1.0 / (off_m * off_m), 1.0 / (off_rad * off_rad));
        let odometry = Matrix3::from_diagonal(&[place, place, heading].into());
        GraphEdge::new([self.reference, 0], measured, &(information + odometry), true)
    }

    /// Where an earlier scan was kept here already it becomes the reference, and none is kept: a robot that cleans the same hall again needs no
    /// more room. True: there is one.
    fn follow_known(&mut self) -> bool {
        let pose = self.pose();
        let is_known = self.is_known();
        let mut best: Option<(f32, u16)> = None;
        for (number, scan) in (0_u16..).zip(&self.scans) {
            let away = libm::hypotf(scan.pose.x_m - pose.x_m, scan.pose.y_m - pose.y_m);
            let is_recent = self.path_m - scan.path_m < KNOWN_PATH_M;
            let is_here = away < 1.5 * self.config.keep_m && (is_known || is_recent);
            if is_here && best.is_none_or(|(least, _)| away < least) {
                best = Some((away, number));
            }
        }
        let Some((_, number)) = best else { return false };
        if is_known {
            self.known_path_m = self.path_m;
        }
        self.follow(number);
        true
    }

    /// The scan nearest to the robot becomes the reference, where one more does not fit.
    fn follow_nearest(&mut self) {
        let pose = self.pose();
        let away = |scan: &KeptScan<POINTS>| libm::hypotf(scan.pose.x_m - pose.x_m, scan.pose.y_m - pose.y_m);
        let nearest = (0_u16..).zip(&self.scans).min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        if let Some((number, _)) = nearest {
            self.follow(number);
        }
    }

    /// A scan becomes the reference.
    fn follow(&mut self, number: u16) {
        let matched = self.matched_in_map();
        let Some(scan) = self.scans.get(index(number)) else { return };
        self.matched.0 = scan.pose.inverse().compose(matched);
        self.reference = number;
        self.field_is_fresh = false;
    }

    fn matched_in_map(&self) -> Pose2 {
        let reference = self.scans.get(index(self.reference)).map_or(Pose2::default(), |scan| scan.pose);
        reference.compose(self.matched.0)
    }

    /// The scanner in the map.
    #[must_use]
    pub fn pose(&self) -> Pose2 {
        self.matched_in_map().compose(self.since)
    }

    /// The scanner in the frame of a kept scan, and which one: a pose in this form follows the map's corrections.
    #[must_use]
    pub fn pose_in_scan(&self) -> (u16, Pose2) {
        (self.reference, self.matched.0.compose(self.since))
    }

    /// The kept scans.
    #[must_use]
    pub fn scans(&self) -> &[KeptScan<POINTS>] {
        &self.scans
    }

    /// What is known about pairs of them.
    #[must_use]
    pub fn edges(&self) -> &[GraphEdge] {
        &self.edges
    }

    /// What was searched.
    #[must_use]
    pub const fn counters(&self) -> LoopCounters {
        self.counters
    }

    /// How often all poses were solved: poses in the map are to be read again.
    #[must_use]
    pub const fn revision(&self) -> u32 {
        self.revision
    }

    /// No more scans can be kept.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.scans.is_full() || self.edges.is_full()
    }

    /// The scan that was kept last.
    pub(super) fn newest(&self) -> Option<u16> {
        u16::try_from(count_u32(self.scans.len()).checked_sub(1)?).ok()
    }
}
