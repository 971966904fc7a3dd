//! Boxes of a detector in a recording: `vision_msgs/Detection2DArray` of ROS 2, and Foxglove's `ImageAnnotations` as CDR, JSON
//! or Protocol Buffers.

mod annotations;
mod boxes;
mod protobuf;

pub use boxes::{DetectedBox, Detections, is_detections, read_detections};

#[cfg(test)]
mod tests;
