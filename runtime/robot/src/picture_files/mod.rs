//! Pictures and tables from files, and the detectors of dirt with their memory on the heap.

mod dirt_detectors;
mod dirt_folder;
mod dirt_memory;
mod images;
mod text;

pub use dirt_detectors::{DirtAnswer, DirtDetectors};
pub use dirt_folder::{DirtFolder, DirtFrame, FRAME_FOLDERS, picture_files};
pub use dirt_memory::NoveltyBuffers;
pub use images::{
    ColourFile, DepthFile, MaskFile, is_cut_jpeg, make_folder, read_colour, read_depth, read_mask,
};
pub use text::{number, numbers, read_text};
