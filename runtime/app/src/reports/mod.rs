//! Recordings as pages for people: `floorguard report`.

mod report;

pub use report::{ReportArguments, language, run};
