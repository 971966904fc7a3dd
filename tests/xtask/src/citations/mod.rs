//! Comments and chapters cite what a reader of this repository can find.

mod comments;
mod refused;
mod sources;
mod tests;

pub use comments::{files, paragraphs};
