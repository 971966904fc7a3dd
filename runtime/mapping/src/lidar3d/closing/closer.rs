//! Searches, measures and closes loops while the drive goes on.

use floorguard_mapping::lidar_odometry::Pose3;
use nalgebra::{Matrix6, Vector3};

use super::config::SpaceCloserConfig;
use super::horizontal::{BEAM_STEP_RAD, flat, node, upright};
use super::key_sweep::KeySweep;
use super::registration::{LocalMap, Measured};
use crate::front_end::Node;
use crate::loops::LoopCloser;
use crate::pose_graph::{Edge, EdgeKind, SpaceEdge, SpaceGraph, Unsolvable};
use crate::refine::ScanView;
use crate::se2::Se2;

/// What was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpaceCloserCounters {
    /// Pairs of places compared on the plane.
    pub searched: usize,
    /// Recognised there.
    pub recognised: usize,
    /// Of these: not confirmed in space.
    pub refused: usize,
    /// Confirmed; counts in the graph unless the others contradict it.
    pub closed: usize,
}

/// The key sweeps of a drive, and their best poses.
pub struct SpaceCloser {
    config: SpaceCloserConfig,
    search: LoopCloser,
    nodes: Vec<Node>,
    views: Vec<ScanView>,
    /// The sweeps.
    pub keys: Vec<KeySweep>,
    /// Best pose of each, in the map.
    pub poses: Vec<Pose3>,
    /// The same on the plane.
    places: Vec<Se2>,
    loops: Vec<SpaceEdge>,
    weights: Vec<f64>,
    refused: usize,
    recognised: usize,
}

/// Key sweeps around a place that its map is made of, and that are laid onto the map of the other, at most.
const MAPPED: usize = 12;
const QUERIES: usize = 4;
/// Points that are laid onto a map, about.
const POINTS: usize = 4_000;

impl SpaceCloser {
    /// Nothing yet.
    #[must_use]
    pub fn new(config: SpaceCloserConfig) -> Self {
        Self {
            config,
            search: LoopCloser::new(config.search),
            nodes: Vec::new(),
            views: Vec::new(),
            keys: Vec::new(),
            poses: Vec::new(),
            places: Vec::new(),
            loops: Vec::new(),
            weights: Vec::new(),
            refused: 0,
            recognised: 0,
        }
    }

    /// What was found so far.
    #[must_use]
    pub fn counters(&self) -> SpaceCloserCounters {
        SpaceCloserCounters {
            searched: self.search.statistics.searched,
            recognised: self.recognised,
            refused: self.refused,
            closed: self.loops.len(),
        }
    }

    /// Loops that count.
    #[must_use]
    pub fn believed(&self) -> usize {
        self.weights.iter().filter(|weight| **weight > 0.5).count()
    }

    /// Takes the next key sweep, and all its returns in the frame of the sensor at its end.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn push(
        &mut self,
        key: KeySweep,
        returns: impl Iterator<Item = Vector3<f32>>,
    ) -> Result<(), Unsolvable> {
        let scan = node(returns, &key.pose, key.time_s, self.config.elevation_rad);
        self.views.push(ScanView::new(&scan.points, BEAM_STEP_RAD));
        self.nodes.push(scan);
        let pose = match self.keys.last().zip(self.poses.last()) {
            Some((last, pose)) => pose.compose(&last.pose.inverse().compose(&key.pose)),
            None => key.pose,
        };
        self.places.push(flat(&pose));
        self.poses.push(pose);
        self.keys.push(key);
        self.close(false)
    }

    /// Searches the last part of the drive, too.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn finish(&mut self) -> Result<(), Unsolvable> {
        self.close(true)
    }

    fn close(&mut self, is_last: bool) -> Result<(), Unsolvable> {
        let found = self.search.search_all((&self.nodes, &self.views), &self.places, is_last);
        self.recognised += found.len();
        let known = self.loops.len();
        for edge in &found {
            match self.measure(edge) {
                Some(edge) => self.loops.push(edge),
                None => self.refused += 1,
            }
        }
        if self.loops.len() == known { Ok(()) } else { self.optimise() }
    }

    /// A recognised place in space: the points of one around those of the other.
    fn measure(&self, edge: &Edge) -> Option<SpaceEdge> {
        let (from, to) = (self.stretch_of(edge.from)?, self.stretch_of(edge.to)?);
        let step = from.len().div_ceil(MAPPED).max(1);
        let map = LocalMap::new(from.step_by(step).flat_map(|key| self.seen_from(key, edge.from)));
        let step = to.len().div_ceil(QUERIES).max(1);
        let mut points: Vec<_> = to.step_by(step).flat_map(|key| self.seen_from(key, edge.to)).collect();
        let step = (points.len() / POINTS).max(1);
        points = points.into_iter().step_by(step).collect();
        let guesses = self.guesses(edge);
        let measured = guesses.iter().filter_map(|start| map.measure(&points, start));
        let best = measured.max_by(|a, b| a.share.total_cmp(&b.share))?;
        self.is_good(&best, edge).then_some(SpaceEdge {
            from: edge.from,
            to: edge.to,
            measured: best.pose,
            information: best.information,
            kind: EdgeKind::Loop,
        })
    }

    /// On the plane as it was found; height and tilt by the odometry so far, or the same height as before.
    fn guesses(&self, edge: &Edge) -> [Pose3; 2] {
        let tilt = |pose: &Pose3| upright(flat(pose), 0.0).inverse().compose(pose);
        let (from, to) = (self.poses[edge.from], self.poses[edge.to]);
        let guess = |to_height_m: f64| {
            let mut far = tilt(&to);
            far.place_m.z = to_height_m;
            tilt(&from).inverse().compose(&upright(edge.measured, 0.0)).compose(&far)
        };
        [guess(to.place_m.z), guess(from.place_m.z)]
    }

    fn is_good(&self, measured: &Measured, edge: &Edge) -> bool {
        let off = edge.measured.distance(flat(&measured.pose));
        measured.share >= self.config.share_least
            && measured.misfit_m <= self.config.misfit_most_m
            && off <= self.config.away_most_m
    }

    fn stretch_of(&self, key: usize) -> Option<std::ops::Range<usize>> {
        let stretch =
            self.search.stretches.iter().find(|stretch| (stretch.first..stretch.end).contains(&key))?;
        Some(stretch.first..stretch.end)
    }

    /// The means of a key sweep in the frame of another one, by the odometry.
    fn seen_from(&self, key: usize, frame: usize) -> impl Iterator<Item = Vector3<f32>> {
        let to_frame = self.keys[frame].pose.inverse().compose(&self.keys[key].pose);
        let rotation = to_frame.rotation.map(|part| part as f32);
        let origin = to_frame.place_m.map(|part| part as f32);
        self.keys[key].means.iter().map(move |point| rotation * point + origin)
    }

    fn optimise(&mut self) -> Result<(), Unsolvable> {
        let mut edges: Vec<SpaceEdge> = self.keys.windows(2).enumerate().filter_map(sequence_edge).collect();
        let first_loop = edges.len();
        edges.extend(self.loops.iter().copied());
        let mut graph = SpaceGraph { poses: std::mem::take(&mut self.poses), edges };
        let weights = graph.optimise_robustly(&self.config.robust);
        self.poses = graph.poses;
        self.places = self.poses.iter().map(flat).collect();
        self.weights = weights?.split_off(first_loop);
        Ok(())
    }

    /// A pose of the odometry in the corrected map: `sweep` is its number in the drive. Between two key sweeps the correction
    /// passes evenly from one to the other.
    #[must_use]
    pub fn corrected(&self, sweep: usize, pose: &Pose3) -> Pose3 {
        let after = self.keys.partition_point(|key| key.sweep <= sweep);
        let correction = |key: usize| self.poses[key].compose(&self.keys[key].pose.inverse());
        let Some(before) = after.checked_sub(1) else {
            return if self.keys.is_empty() { *pose } else { correction(0).compose(pose) };
        };
        let first = correction(before).compose(pose);
        let Some(next) = self.keys.get(after) else { return first };
        let second = correction(after).compose(pose);
        let span = (next.sweep - self.keys[before].sweep) as f64;
        let share = (sweep - self.keys[before].sweep) as f64 / span;
        let between = first.inverse().compose(&second);
        first.moved(between.rotation_vector() * share, between.place_m * share)
    }
}

/// From a key sweep to the next, by the odometry.
fn sequence_edge((from, pair): (usize, &[KeySweep])) -> Option<SpaceEdge> {
    let [a, b] = pair else { return None };
    let information: Matrix6<f64> = b.covariance.try_inverse()?;
    let measured = a.pose.inverse().compose(&b.pose);
    Some(SpaceEdge { from, to: from + 1, measured, information, kind: EdgeKind::Sequence })
}

#[cfg(test)]
#[path = "closer_tests.rs"]
mod tests;
