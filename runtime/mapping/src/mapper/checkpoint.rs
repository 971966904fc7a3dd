//! A mapping that was interrupted goes on where it was, to the same bits.

use std::io::{self, Write};

use nalgebra::Matrix3;

use super::whole::{MapConfig, Mapper};
use crate::front_end::{Node, Tracker};
use crate::loops::LoopCloser;
use crate::pose_graph::{Edge, EdgeKind};
use crate::refine::ScanView;
use crate::saved::{Reading, Saving};

/// The form of the bytes; another one is not read.
const FORM: usize = 0x4647_4D41_5005;

/// A mapping that goes on.
pub struct Resumed {
    /// As it was.
    pub mapper: Mapper,
    /// Scans that it has taken.
    pub scans: u64,
}

impl Mapper {
    /// Writes the mapping so far, after so many scans; false, and nothing is written, while loops are worked in, which takes some
    /// scans. `key` says of which input it is: the same one must be given again.
    ///
    /// # Errors
    /// Something could not be written.
    pub fn checkpoint(&self, scans: u64, key: u64, to: &mut dyn Write) -> io::Result<bool> {
        if !self.is_settled() {
            return Ok(false);
        }
        let mut to = Saving::new(to);
        to.count(FORM);
        to.count(key as usize);
        to.count(scans as usize);
        to.single(self.step_rad);
        self.tracker.save(&mut to, |node| self.views[node].returns());
        self.closer.save(&mut to);
        to.count(self.poses.len());
        self.poses.iter().for_each(|pose| to.pose(*pose));
        to.count(self.loops.len());
        for edge in &self.loops {
            to.count(edge.from);
            to.count(edge.to);
            to.pose(edge.measured);
            edge.information.iter().for_each(|value| to.number(*value));
        }
        to.count(self.loop_weights.len());
        self.loop_weights.iter().for_each(|weight| to.number(*weight));
        to.count(self.map_revision as usize);
        to.finish().map(|()| true)
    }

    /// Goes on from a checkpoint; `None` if it is cut, damaged, of another input, or of another version. The settings must be
    /// those with which it was made.
    #[must_use]
    pub fn resume(config: MapConfig, bytes: &[u8], key: u64) -> Option<Resumed> {
        let mut from = Reading::new(bytes)?;
        if from.count()? != FORM || from.count()? != key as usize {
            return None;
        }
        let scans = from.count()? as u64;
        let step_rad = from.single()?;
        let mut tracker = Tracker::read(&mut from, config.front_end)?;
        let view = |node: &mut Node| ScanView::new(&std::mem::take(&mut node.points), step_rad);
        let views: Vec<ScanView> = tracker.nodes.iter_mut().map(view).collect();
        let closer = LoopCloser::read(&mut from, (&tracker.nodes, &views), config.loops)?;
        let mut mapper = Self::new(config);
        mapper.poses = from.all(Reading::pose)?;
        mapper.loops = from.all(|from| edge(from, tracker.nodes.len()))?;
        mapper.loop_weights = from.all(Reading::number)?;
        mapper.map_revision = u32::try_from(from.count()?).ok()?;
        mapper.step_rad = step_rad;
        mapper.views = views;
        mapper.tracker = tracker;
        mapper.closer = closer;
        (mapper.poses.len() == mapper.tracker.nodes.len()).then_some(Resumed { mapper, scans })
    }
}

fn edge(from: &mut Reading<'_>, nodes: usize) -> Option<Edge> {
    let (first, second, measured) = (from.count()?, from.count()?, from.pose()?);
    let mut information = Matrix3::zeros();
    for value in information.iter_mut() {
        *value = from.number()?;
    }
    let edge = Edge { from: first, to: second, measured, information, kind: EdgeKind::Loop };
    (first < nodes && second < nodes).then_some(edge)
}
