//! `cargo xtask audit`: the evidence for a safety team, from the sources and from the compiled image.
//!
//! Each claim is checked afresh at every run. A claim that fails names the file and the line.

mod bounds;
mod circles;
mod claim;
mod dependencies;
mod evidence;
mod forbidden;
mod forbidden_words;
mod hosted_only;
mod image;
mod image_claims;
#[cfg(test)]
mod image_injection_tests;
#[cfg(test)]
mod injection_tests;
mod lines;
mod loop_syntax;
mod loop_visitor;
mod loop_words;
mod loops;
pub mod macros;
pub mod moved;
mod mutation;
mod picture;
mod records;
#[cfg(test)]
mod refusal_tests;
mod report;
mod results;
mod roots;
mod run;
mod same_code;
mod seen;
mod since;
#[cfg(test)]
mod sneaky_tests;
pub mod sources;
pub(crate) mod thumb;
mod trace;
mod walks;

pub use bounds::shown;
pub use claim::{Claim, Finding};
pub use hosted_only::paths_of;
pub use loops::{LoopSite, list as loops_of};
pub use run::{Options, run};
pub use seen::{RECORD, Record, numbers, written};
pub use sources::{SourceFile, read_audited};
pub use walks::chain_root;
