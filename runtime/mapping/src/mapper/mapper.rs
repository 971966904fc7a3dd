//! Tracking, loops, optimisation, alignment.

use crate::front_end::{FrontEndConfig, Step, Tracker, sequence_edges};
use crate::input::ScanRecord;
use crate::loops::{LoopCloser, LoopConfig};
use crate::pose_graph::{Edge, Graph, RobustConfig, Unsolvable, optimise_robustly};
use crate::refine::{AlignConfig, ScanView, align};
use crate::se2::Se2;

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
    /// Counts corrections of the map.
    pub map_revision: u32,
    views: Vec<ScanView>,
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
            map_revision: 0,
            views: Vec::new(),
        }
    }

    /// Takes the next scan.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn push(&mut self, record: &ScanRecord) -> Result<(), Unsolvable> {
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
        let mut edges = sequence_edges(&self.tracker.nodes);
        edges.extend(self.loops.iter().copied());
        let mut graph = Graph { poses: std::mem::take(&mut self.poses), edges };
        let outcome = optimise_robustly(&mut graph, &self.config.robust);
        self.poses = graph.poses;
        self.map_revision += 1;
        outcome.map(|_| ())
    }

    /// The last stretch, and the alignment of all scans.
    ///
    /// # Errors
    /// The graph cannot be solved.
    pub fn finish(&mut self) -> Result<(), Unsolvable> {
        let found = self.closer.advance(&self.tracker.nodes, &self.views, &self.poses, true);
        self.close(found)?;
        let edges = sequence_edges(&self.tracker.nodes);
        align(&self.views, &mut self.poses, &edges, &self.config.align)
    }
}
