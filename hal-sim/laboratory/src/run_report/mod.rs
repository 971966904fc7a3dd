//! What is left of a simulated run for people: a summary in words, and a folder with a page and pictures.

mod cleaning;
mod facts;
mod page;
mod seen_dirt;
mod summary;
mod view;

pub use page::write_report;
pub use summary::summary;
pub use view::outlines;
