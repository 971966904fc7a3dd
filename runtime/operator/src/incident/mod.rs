//! An incident explained: what each sensor saw, which rule decided, what would have happened otherwise, and the ten seconds
//! before, from a recording that is played again.

mod gather;
mod otherwise;
mod page;
mod picture;
mod rule;
mod summary;

pub use gather::{Gather, Snapshot};
pub use otherwise::{Ahead, Otherwise};
pub use page::page;
pub use rule::{requirement, requirement_text};
pub use summary::{CauseLine, Incident, MomentLine, SourceLine};
