//! Recordings as pages for people: `floorguard report`, `floorguard explain`.

mod explain;
mod report;

pub use explain::{ExplainArguments, run as explain};
pub use report::{ReportArguments, run};
