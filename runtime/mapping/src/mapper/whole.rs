//! Tracking, loops, optimisation, alignment.

use crate::front_end::{FrontEndConfig, Step, Tracker, interpolated, sequence_edges};
use crate::input::ScanRecord;
use crate::loops::{LoopCloser, LoopConfig};
use crate::pose_graph::{Edge, Graph, RobustConfig, Unsolvable, optimise_robustly};
use crate::refine::{AlignConfig, LocateConfig, ScanView, align, locate};
use crate::se2::Se2;

/// A loop that is off by less is closed by the alignment, metres.
const REACH_OF_ALIGNMENT_M: f64 = 0.2;

/// All settings.
#[derive(Clone, Debug, Default, PartialEq)]
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
    pub(super) views: Vec<ScanView>,
    pub(super) step_rad: f32,
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
        }
    }

    /// Takes the next scan.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn push(&mut self, record: &ScanRecord) -> Result<(), Unsolvable> {
        self.step_rad = record.step_rad;
        let Step::Node(index) = self.tracker.push(record) else { return Ok(()) };
        let node = &self.tracker.nodes[index];
        self.views.push(ScanView::new(&node.points, record.step_rad));
        let pose = match index.checked_sub(1).and_then(|before| Some((before, self.poses.get(before)?))) {
            Some((before, pose)) => pose.compose(self.tracker.nodes[before].pose.between(node.pose)),
            None => node.pose,
        };
        self.poses.push(pose);
        let found = self.closer.advance(&self.tracker.nodes, &self.views, &self.poses, false);
        self.close(found)
    }

    fn close(&mut self, found: Vec<Edge>) -> Result<(), Unsolvable> {
        if found.is_empty() {
            return Ok(());
        }
        self.loops.extend(found);
        let edges = sequence_edges(&self.tracker.nodes);
        self.optimise(edges)
    }

    /// The poses that agree best with the edges of the sequence and with the loops.
    fn optimise(&mut self, mut edges: Vec<Edge>) -> Result<(), Unsolvable> {
        let first_loop = edges.len();
        edges.extend(self.loops.iter().copied());
        let mut graph = Graph { poses: std::mem::take(&mut self.poses), edges };
        let outcome = optimise_robustly(&mut graph, &self.config.robust);
        self.poses = graph.poses;
        self.map_revision += 1;
        self.loop_weights = outcome?.weights.split_off(first_loop);
        Ok(())
    }

    /// The poses of the kept scans, and what is known about pairs of them; loops that contradict the others are left out.
    #[must_use]
    pub fn graph(&self) -> Graph {
        let mut edges = sequence_edges(&self.tracker.nodes);
        let believed = self.loops.iter().zip(&self.loop_weights).filter(|(_, weight)| **weight > 0.5);
        edges.extend(believed.map(|(edge, _)| *edge));
        Graph { poses: self.poses.clone(), edges }
    }

    /// The last stretch, and the alignment of all scans. Loops are then searched once more: a stretch that was bent while
    /// it was tracked, as when the robot turned fast on the spot, fits other stretches only once it is aligned.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn finish(&mut self) -> Result<(), Unsolvable> {
        let found = self.closer.advance(&self.tracker.nodes, &self.views, &self.poses, true);
        self.close(found)?;
        let edges = sequence_edges(&self.tracker.nodes);
        align(&self.views, &mut self.poses, &edges, &self.config.align)?;
        if self.search_again()? {
            align(&self.views, &mut self.poses, &edges, &self.config.align)?;
        }
        Ok(())
    }

    /// Searches loops between the aligned stretches; whether one of them moved the poses.
    fn search_again(&mut self) -> Result<bool, Unsolvable> {
        let mut nodes = self.tracker.nodes.clone();
        for (node, pose) in nodes.iter_mut().zip(&self.poses) {
            node.pose = *pose;
        }
        let mut closer = LoopCloser::new(self.config.loops);
        let mut found = closer.advance(&nodes, &self.views, &self.poses, true);
        found.retain(|edge| {
            let is_known = self.loops.iter().any(|known| [known.from, known.to] == [edge.from, edge.to]);
            let error = edge.error(self.poses[edge.from], self.poses[edge.to]);
            !is_known && error.xy().norm() > REACH_OF_ALIGNMENT_M
        });
        if found.is_empty() {
            return Ok(false);
        }
        self.loops.extend(found);
        let edges = sequence_edges(&nodes);
        self.optimise(edges)?;
        Ok(true)
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
            let view = ScanView::new(&passage.points, self.step_rad);
            let first = passage.node.saturating_sub(2);
            let last = (passage.node + 4).min(nodes.len());
            let partners: Vec<_> = (first..last).map(|node| (&self.views[node], self.poses[node])).collect();
            all.push((passage.time_s, locate(&view, guess, &partners, &self.config.locate)));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }
}
