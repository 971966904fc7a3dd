//! Learning on the robot while it works: `[learning]` of robot.toml.
//!
//! Tracks label what was seen, a bounded model corrects the shipped classifier (`floorguard_perception::online_learning`), and
//! what was taken over is kept in a file. The tracker and the guard's advice go on with the shipped classifier: what is
//! learned can only add a person to the advice.

mod anchors;
mod learning_slot;
mod live;
mod report;
mod setup;
mod weights_file;

pub use anchors::{anchors_file, anchors_fingerprint, read_anchors, shipped_anchors};
pub use learning_slot::{LearningSlot, LearningWriter};
pub use live::{PeopleLearner, own_detection};
pub use report::LearningReport;
pub use setup::LearningSetup;
pub use weights_file::{Kept, decode_weights, encode_weights, load_weights, save_weights};
