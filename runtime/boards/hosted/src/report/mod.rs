//! What is left of a run for people: a summary in words, and a folder with a page and a picture.

mod page;
mod summary;
mod view;

pub use page::write_report;
pub use summary::summary;
pub use view::outlines;
