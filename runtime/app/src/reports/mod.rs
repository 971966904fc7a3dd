//! Runs and stops as people read them: `floorguard report`, `floorguard explain`, `floorguard blackbox`.

mod blackbox;
mod explain;
mod report;

pub use blackbox::{BlackBoxArguments, run as blackbox};
pub use explain::{ExplainArguments, run as explain};
pub use report::{ReportArguments, run};
