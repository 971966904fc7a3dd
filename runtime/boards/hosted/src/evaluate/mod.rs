//! Evaluation on recorded data: what a stage says, compared with a key that somebody else made.
//!
//! Each file answers one question and returns a report that serialises to the keys of the command's JSON.

mod clusters;
mod curve;
mod dirt;
mod dirt_detectors;
mod dirt_figures;
mod dirt_folder;
mod dirt_memory;
mod floor;
mod frames;
mod images;
mod legs;
mod motion;
mod motion_key;
mod motion_play;
mod rgbd_key;
mod rgbd_people;
mod rgbd_picture;
pub mod roc;
mod svm;
mod text;
mod tracks;

pub use clusters::{ClustersReport, clusters};
pub use curve::draw_legs;
pub use dirt::{DirtReport, dirt};
pub use dirt_detectors::{DirtAnswer, DirtDetectors};
pub use dirt_figures::{DirtFigures, DirtTotals};
pub use dirt_folder::{DirtFolder, DirtFrame, FRAME_FOLDERS, picture_files};
pub use dirt_memory::NoveltyBuffers;
pub use floor::{FloorReport, FloorTask, ObjectReport, floor, parse_intrinsics};
pub use frames::{capture_frames, standing_context};
pub use images::{ColourFile, DepthFile, MaskFile, is_cut_jpeg, read_colour, read_depth, read_mask};
pub use legs::{
    FoldReport, LegsReport, Recording, in_any_room, learn_legs, legs, recordings, training_samples,
};
pub use motion::{MotionReport, TrackReport, motion};
pub use rgbd_people::{RgbdAccount, RgbdPersonReport, RgbdPictureReport, RgbdReport, RgbdTask, rgbd_people};
pub use svm::{SvmReport, svm};
pub use text::read_text;
pub use tracks::{TracksReport, tracks};
