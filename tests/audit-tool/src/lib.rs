//! Evidence for embedded Rust, from its sources and from the machine code that the compiler made of them.
//!
//! What the tool must know of a project stands in `tests/audit.toml` (see [`facts`]); its README says how another project
//! would use it.

pub mod audit;
pub mod campaign;
mod claim;
mod copied_tree;
mod counting;
mod dependencies;
pub mod facts;
mod forbidden;
pub mod image;
mod loops;
mod mutants;
pub mod records;
mod report;
pub mod shell;
pub mod sources;
pub mod structure;
mod trace;
