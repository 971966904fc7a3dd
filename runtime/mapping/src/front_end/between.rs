//! Scans between two kept ones.

use super::node::{Node, Passage};
use crate::se2::Se2;

/// Where such a scan stands: odometry from the kept scan before it, and as much of what odometry missed on the way to the
/// next one as it had gone. `poses` are those of the kept scans, in the map.
#[must_use]
pub fn interpolated(nodes: &[Node], poses: &[Se2], passage: &Passage) -> Option<Se2> {
    let pose = *poses.get(passage.node)?;
    let by_odometry = pose.compose(passage.from_node);
    let kept = |node: usize| nodes.get(node).and_then(|node| node.odometry);
    let (Some(next), Some(before), Some(after)) =
        (poses.get(passage.node + 1), kept(passage.node), kept(passage.node + 1))
    else {
        return Some(by_odometry);
    };
    let whole = before.between(after);
    let length = |step: Se2| step.length_m() + step.heading_rad.abs();
    let share = (length(passage.from_node) / length(whole).max(1.0e-6)).min(1.0);
    let missed = pose.compose(whole).between(*next);
    let part = Se2::new(share * missed.x_m, share * missed.y_m, share * missed.heading_rad);
    // The correction acts at the far end; carried back to here by the rest of the way.
    let rest = passage.from_node.between(whole);
    Some(by_odometry.compose(rest).compose(part).compose(rest.inverse()))
}
