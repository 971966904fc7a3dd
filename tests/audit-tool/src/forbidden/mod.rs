//! What must not stand in the audited sources, and what must not be named by what runs on a microcontroller.

pub mod circles;
pub mod hosted_only;
mod visitor;
mod words;

pub use visitor::{Forbidden, inspect};
