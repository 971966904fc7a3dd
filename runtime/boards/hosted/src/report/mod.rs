//! What is left of a run for people: a summary in words, a folder with a page and a picture, and the report of a
//! recording.

mod charts;
mod cleaning;
mod document;
mod facts;
mod grids;
mod history;
mod mission;
mod page;
mod seen_dirt;
mod sketch;
mod style;
mod summary;
mod view;

pub use document::document;
pub use history::{History, read_history};
pub use page::{make_folder, write_report};
pub use summary::summary;
pub use view::outlines;
