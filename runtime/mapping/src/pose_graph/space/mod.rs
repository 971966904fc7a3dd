//! Graphs of poses in space: six numbers a pose, solved by the equations of the plane with two blocks for each pose.

mod edge;
mod graph;

pub use edge::SpaceEdge;
pub use graph::SpaceGraph;
