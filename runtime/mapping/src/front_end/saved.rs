//! The tracking as bytes. Local maps are written again from their scans.

use floorguard_types::geometry::Point2;
use nalgebra::Matrix3;

use super::config::FrontEndConfig;
use super::local_map::LocalMap;
use super::node::{Node, Passage};
use super::packed::PackedScan;
use super::tracker::{LastAlone, Tracker};
use crate::saved::{Reading, Saving};

impl Tracker {
    /// `returns` of each kept scan, by its number.
    pub(crate) fn save(&self, to: &mut Saving<'_>, returns: impl Fn(usize) -> Box<[Point2]>) {
        to.count(self.nodes.len());
        for (index, node) in self.nodes.iter().enumerate() {
            to.number(node.time_s);
            to.pose(node.pose);
            to.pose_if_any(node.odometry);
            to.points(&returns(index));
            node.information.iter().for_each(|value| to.single(*value));
            to.single(node.score);
        }
        to.count(self.passages.len());
        for passage in &self.passages {
            to.number(passage.time_s);
            to.count(passage.node);
            to.pose(passage.from_node);
            passage.scan.save(to);
        }
        to.count(self.maps.len());
        for map in &self.maps {
            to.pose(map.origin);
            to.count(map.first_node);
            to.number(map.travelled_m);
        }
        to.count(usize::from(self.last_alone.is_some()));
        if let Some(last) = self.last_alone {
            to.number(last.time_s);
            to.pose(last.pose);
            to.pose(last.speed);
            to.pose(last.step);
        }
    }

    pub(crate) fn read(from: &mut Reading<'_>, config: FrontEndConfig) -> Option<Self> {
        let mut tracker = Self::new(config);
        tracker.nodes = from.all(node)?;
        tracker.passages = from.all(passage)?;
        for _ in 0..from.count()? {
            let (origin, first_node, travelled_m) = (from.pose()?, from.count()?, from.number()?);
            let mut map = LocalMap::new(origin, first_node, &config)?;
            map.travelled_m = travelled_m;
            for node in tracker.nodes.get(first_node..)? {
                map.insert(node.pose, &node.points);
            }
            tracker.maps.push(map);
        }
        if from.count()? == 1 {
            let (time_s, pose, speed, step) = (from.number()?, from.pose()?, from.pose()?, from.pose()?);
            tracker.last_alone = Some(LastAlone { time_s, pose, speed, step });
        }
        Some(tracker)
    }
}

fn node(from: &mut Reading<'_>) -> Option<Node> {
    let (time_s, pose, odometry, points) =
        (from.number()?, from.pose()?, from.pose_if_any()?, from.points()?);
    let mut information = Matrix3::zeros();
    for value in information.iter_mut() {
        *value = from.single()?;
    }
    Some(Node { time_s, pose, odometry, points, information, score: from.single()? })
}

fn passage(from: &mut Reading<'_>) -> Option<Passage> {
    let (time_s, node) = (from.number()?, from.count()?);
    Some(Passage { time_s, node, from_node: from.pose()?, scan: PackedScan::read(from)? })
}
