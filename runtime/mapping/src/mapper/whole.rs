//! Tracking, loops, optimisation, alignment.

use floorguard_types::geometry::Point2;

use crate::front_end::{FrontEndConfig, Step, Tracker, interpolated, sequence_edges};
use crate::input::ScanRecord;
use crate::loops::{LoopCloser, LoopConfig};
use crate::pose_graph::{Edge, Graph, RobustConfig, RobustDescent, Unsolvable};
use crate::refine::{AlignConfig, LocateConfig, ScanView, align, locate};
use crate::se2::Se2;

/// A loop that is off by less is closed by the alignment, metres.
const REACH_OF_ALIGNMENT_M: f64 = 0.2;

/// Pairs in the queue for which each scan takes one more step of the search.
const PAIRS_A_STEP: usize = 4;

/// All settings.
#[derive(Clone, Debug, PartialEq)]
pub struct MapConfig {
    /// Tracking.
    pub front_end: FrontEndConfig,
    /// Loops.
    pub loops: LoopConfig,
    /// Optimisation.
    pub robust: RobustConfig,
    /// Alignment.
    pub align: AlignConfig,
    /// Scans between the kept ones.
    pub locate: LocateConfig,
    /// Poses that are optimised with a scan, at most, unless the graph has more: some milliseconds.
    pub poses_a_scan: usize,
}

impl Default for MapConfig {
    fn default() -> Self {
        Self {
            front_end: FrontEndConfig::default(),
            loops: LoopConfig::default(),
            robust: RobustConfig::default(),
            align: AlignConfig::default(),
            locate: LocateConfig::default(),
            poses_a_scan: 6_000,
        }
    }
}

/// Makes a map of scans.
pub struct Mapper {
    config: MapConfig,
    /// Tracking.
    pub tracker: Tracker,
    /// Loops.
    pub closer: LoopCloser,
    /// Best poses of the kept scans, in the map.
    pub poses: Vec<Se2>,
    /// Accepted loops.
    pub loops: Vec<Edge>,
    /// Weight of each loop in the last optimisation: 1, or 0 where it contradicts the others.
    pub loop_weights: Vec<f64>,
    /// Counts corrections of the map.
    pub map_revision: u32,
    /// The returns of the kept scans, by bearing.
    pub views: Vec<ScanView>,
    pub(super) step_rad: f32,
    /// Loops that wait for the next optimisation.
    pub(super) found: Vec<Edge>,
    descent: Option<RobustDescent>,
    /// Edges of the sequence in that optimisation.
    sequence_edges: usize,
}

impl Mapper {
    /// Nothing yet.
    #[must_use]
    pub fn new(config: MapConfig) -> Self {
        Self {
            tracker: Tracker::new(config.front_end),
            closer: LoopCloser::new(config.loops),
            config,
            poses: Vec::new(),
            loops: Vec::new(),
            loop_weights: Vec::new(),
            map_revision: 0,
            views: Vec::new(),
            step_rad: 0.01,
            found: Vec::new(),
            descent: None,
            sequence_edges: 0,
        }
    }

    /// Takes the next scan.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn push(&mut self, record: &ScanRecord) -> Result<(), Unsolvable> {
        self.step_rad = record.step_rad;
        let Step::Node(index) = self.tracker.push(record) else {
            self.work(self.config.poses_a_scan);
            return Ok(());
        };
        // The view holds them, too.
        let points = std::mem::take(&mut self.tracker.nodes[index].points);
        self.views.push(ScanView::new(&points, record.step_rad));
        let node = &self.tracker.nodes[index];
        let pose = match index.checked_sub(1).and_then(|before| Some((before, self.poses.get(before)?))) {
            Some((before, pose)) => pose.compose(self.tracker.nodes[before].pose.between(node.pose)),
            None => node.pose,
        };
        self.poses.push(pose);
        self.closer.advance((&self.tracker.nodes, &self.views), &self.poses, false);
        self.work(self.config.poses_a_scan);
        Ok(())
    }

    /// The next piece of work on loops, so that no scan takes long: a step of the search, more of them the more pairs wait, and
    /// steps of the optimisation, in all of so many poses.
    fn work(&mut self, poses_most: usize) {
        for _ in 0..=self.closer.waiting() / PAIRS_A_STEP {
            let found = self.closer.search_next(&self.tracker.nodes, &self.views, &self.poses);
            self.found.extend(found);
        }
        if let Some(descent) = &mut self.descent {
            let count = descent.graph.poses.len().max(1);
            let ended = (0..(poses_most / count).max(1)).find_map(|_| descent.step());
            if let Some(outcome) = ended {
                self.adopt(outcome.weights);
            }
        } else if !self.found.is_empty() && !self.closer.goes_on() {
            self.begin(sequence_edges(&self.tracker.nodes));
        }
    }

    /// Begins the search for the poses that agree best with the edges of the sequence and with the loops.
    fn begin(&mut self, mut edges: Vec<Edge>) {
        self.loops.append(&mut self.found);
        self.sequence_edges = edges.len();
        edges.extend(self.loops.iter().copied());
        let graph = Graph { poses: self.poses.clone(), edges };
        self.descent = Some(RobustDescent::new(graph, self.config.robust));
    }

    /// Whether no work on loops is left over for the next scans.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.descent.is_none() && self.found.is_empty() && !self.closer.is_searching()
    }

    /// Does all the work that is left.
    fn settle(&mut self) {
        while !self.is_settled() {
            self.work(usize::MAX);
        }
    }

    /// Takes over the optimised poses; scans that came meanwhile move with the last of them.
    fn adopt(&mut self, mut weights: Vec<f64>) {
        let Some(descent) = self.descent.take() else { return };
        let corrected = descent.graph.poses;
        if let Some((last, before)) =
            corrected.last().zip(corrected.len().checked_sub(1).and_then(|last| self.poses.get(last)))
        {
            let correction = last.compose(before.inverse());
            self.poses.iter_mut().skip(corrected.len()).for_each(|pose| *pose = correction.compose(*pose));
        }
        self.poses.iter_mut().zip(corrected).for_each(|(pose, corrected)| *pose = corrected);
        self.map_revision += 1;
        self.loop_weights = weights.split_off(self.sequence_edges.min(weights.len()));
    }

    /// The poses of the kept scans, and what is known about pairs of them; loops that contradict the others are left out.
    #[must_use]
    pub fn graph(&self) -> Graph {
        let mut edges = sequence_edges(&self.tracker.nodes);
        let believed = self.loops.iter().zip(&self.loop_weights).filter(|(_, weight)| **weight > 0.5);
        edges.extend(believed.map(|(edge, _)| *edge));
        Graph { poses: self.poses.clone(), edges }
    }

    /// The last stretch, and the alignment of all scans; nothing can be pushed from then on. Loops are then searched once more: a stretch that was bent while
    /// it was tracked, as when the robot turned fast on the spot, fits other stretches only once it is aligned.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn finish(&mut self) -> Result<(), Unsolvable> {
        self.settle();
        self.closer.advance((&self.tracker.nodes, &self.views), &self.poses, true);
        self.settle();
        self.tracker.forget_maps();
        self.closer.forget_fields();
        let edges = sequence_edges(&self.tracker.nodes);
        let config = self.config.align.clone();
        align(&self.views, &mut self.poses, &edges, (&config, &config.rounds))?;
        if self.search_again() {
            align(&self.views, &mut self.poses, &edges, (&config, &config.rounds))?;
        }
        align(&self.views, &mut self.poses, &edges, (&config, &config.last_rounds))
    }

    /// Searches loops between the aligned stretches; whether one of them moved the poses.
    fn search_again(&mut self) -> bool {
        // The sequence counts as it is aligned.
        let tracked: Vec<Se2> = self.tracker.nodes.iter().map(|node| node.pose).collect();
        self.tracker.nodes.iter_mut().zip(&self.poses).for_each(|(node, pose)| node.pose = *pose);
        let mut closer = self.closer.again();
        let mut found = closer.search_all((&self.tracker.nodes, &self.views), &self.poses, true);
        drop(closer);
        let edges = sequence_edges(&self.tracker.nodes);
        self.tracker.nodes.iter_mut().zip(tracked).for_each(|(node, pose)| node.pose = pose);
        found.retain(|edge| {
            let is_known = self.loops.iter().any(|known| [known.from, known.to] == [edge.from, edge.to]);
            let error = edge.error(self.poses[edge.from], self.poses[edge.to]);
            !is_known && error.xy().norm() > REACH_OF_ALIGNMENT_M
        });
        let Some(_) = found.first() else { return false };
        self.found = found;
        self.begin(edges);
        self.settle();
        true
    }

    /// The kept scans: where each stood in the map, and its returns in its own frame, made when they are asked for.
    pub fn scans(&self) -> impl Iterator<Item = (Se2, Box<[Point2]>)> {
        self.poses.iter().zip(&self.views).map(|(pose, view)| (*pose, view.returns()))
    }

    /// Moves the times of all scans, as where their stamps are early.
    pub fn shift_times(&mut self, later_s: f64) {
        self.tracker.nodes.iter_mut().for_each(|node| node.time_s += later_s);
        self.tracker.passages.iter_mut().for_each(|passage| passage.time_s += later_s);
    }

    /// The trajectory of all scans by odometry between the kept ones, ordered by time.
    #[must_use]
    pub fn trajectory(&self) -> Vec<(f64, Se2)> {
        let nodes = &self.tracker.nodes;
        let kept = nodes.iter().zip(&self.poses).map(|(node, pose)| (node.time_s, *pose));
        let passed = self
            .tracker
            .passages
            .iter()
            .filter_map(|passage| Some((passage.time_s, interpolated(nodes, &self.poses, passage)?)));
        let mut all: Vec<(f64, Se2)> = kept.chain(passed).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// The same, with every scan that the tracking passed over matched against the kept ones around it.
    #[must_use]
    pub fn matched_trajectory(&self) -> Vec<(f64, Se2)> {
        let nodes = &self.tracker.nodes;
        let mut all: Vec<(f64, Se2)> =
            nodes.iter().zip(&self.poses).map(|(node, pose)| (node.time_s, *pose)).collect();
        for passage in &self.tracker.passages {
            let Some(guess) = interpolated(nodes, &self.poses, passage) else { continue };
            let view = ScanView::new(&passage.scan.points(), self.step_rad);
            let to_each_side = self.config.locate.partners;
            let first = (passage.node + 1).saturating_sub(to_each_side);
            let last = (passage.node + 1 + to_each_side).min(nodes.len());
            let partners: Vec<_> = (first..last).map(|node| (&self.views[node], self.poses[node])).collect();
            all.push((passage.time_s, locate(&view, guess, &partners, &self.config.locate)));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }
}
