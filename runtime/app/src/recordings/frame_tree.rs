//! Where sensors are mounted, by the frames that a bag names.

use std::collections::BTreeMap;

use floorguard_recording::decode::Frame;
use floorguard_types::geometry::{Point3, Pose2, Transform3};

/// Links from a sensor to the robot; more are a ring.
const LINKS_MAX: usize = 16;
/// Frames that stand for the robot.
const BASES: [&str; 3] = ["base_link", "base_footprint", "base"];

/// Frames below the robot's own, each with its parent.
#[derive(Clone, Debug, Default)]
pub struct FrameTree(BTreeMap<String, (String, Transform3)>);

/// A frame without the slash of older recorders.
fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

/// The frame stands for the robot.
pub fn is_base(frame: &str) -> bool {
    BASES.contains(&bare(frame))
}

impl FrameTree {
    /// Enters a frame. What moves above the robot's own frame is odometry, not mounting, and is left out.
    pub fn enter(&mut self, frame: &Frame) {
        if !is_base(&frame.child) {
            let parent = bare(&frame.header.frame).to_owned();
            self.0.insert(bare(&frame.child).to_owned(), (parent, frame.transform));
        }
    }

    /// A sensor on the robot, if the frames tell.
    pub fn mounting(&self, frame: &str) -> Option<Transform3> {
        let mut at = bare(frame);
        let mut mounting = Transform3::IDENTITY;
        for _ in 0..LINKS_MAX {
            if is_base(at) {
                return Some(mounting);
            }
            let (parent, transform) = self.0.get(at)?;
            mounting = composed(transform, &mounting);
            at = parent;
        }
        None
    }
}

/// Place and heading on the floor.
pub fn flat(transform: &Transform3) -> Pose2 {
    let [[cos, ..], [sin, ..], _] = transform.rotation;
    Pose2::new(transform.translation.x_m, transform.translation.y_m, libm::atan2f(sin, cos))
}

fn composed(outer: &Transform3, inner: &Transform3) -> Transform3 {
    let columns = [0, 1, 2].map(|column| inner.rotation.map(|row| row[column]));
    let rotation = outer
        .rotation
        .map(|row| columns.map(|column| row.iter().zip(column).map(|(a, b)| a * b).sum::<f32>()));
    let Point3 { x_m, y_m, z_m } = outer.transform(inner.translation);
    Transform3 { translation: Point3::new(x_m, y_m, z_m), rotation }
}
