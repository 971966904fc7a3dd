//! Slamtec RPLidars of the A and S series: requests, answers, and the samples of a turning head (book, RPLidar).

mod answer;
mod capsule;
mod device;

pub use answer::{AnswerKind, Descriptor, NodeError, Sample, decode_node};
pub use capsule::{CAPSULE_BYTES, Capsule, CapsuleError};
pub use device::{Device, DeviceEvent, DeviceFamily};

#[cfg(test)]
mod vector_tests;
