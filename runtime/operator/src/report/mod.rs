//! The report of a recording as one page, and the parts of which every report is made.

pub mod charts;
mod document;
mod folder;
mod grids;
mod history;
mod mission;
mod sketch;
pub mod style;

pub use document::document;
pub use folder::make_folder;
pub use history::{History, read_history};
