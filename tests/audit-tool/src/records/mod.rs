//! What longer runs found out, kept in the tree: read, judged, and moved with the code.

mod kept;
mod moved;
pub mod mutation;
pub mod since;

pub use kept::{Records, read};
pub use moved::{Options, run};
