//! Evaluation on recorded data: what a stage says, compared with a key that somebody else made.
//!
//! Each file answers one question and returns a report that serialises to the keys of the command's JSON.

mod clusters;
mod curve;
mod dirt;
mod dirt_figures;
mod floor;
mod frames;
mod legs;
mod motion;
mod motion_key;
mod motion_play;
mod people;
mod rgbd_key;
mod rgbd_people;
mod rgbd_picture;
pub mod roc;
mod svm;
mod tracks;
mod walker;

pub use clusters::{ClustersReport, clusters};
pub use curve::draw_legs;
pub use dirt::{DirtReport, dirt};
pub use dirt_figures::{DirtFigures, DirtTotals};
pub use floor::{FloorReport, FloorTask, ObjectReport, floor, parse_intrinsics};
pub use frames::{capture_frames, standing_context};
pub use legs::{
    FoldReport, LegsReport, Recording, in_any_room, learn_legs, legs, recordings, training_samples,
};
pub use motion::{MotionReport, TrackReport, motion};
pub use people::{FalsePeopleReport, false_people};
pub use rgbd_people::{RgbdAccount, RgbdPersonReport, RgbdPictureReport, RgbdReport, RgbdTask, rgbd_people};
pub use svm::{SvmReport, svm};
pub use tracks::{TracksReport, tracks};
pub use walker::{WalkerReport, walker};
