//! Many seeded runs in parallel, each in its own virtual time, and one table of what came of them.

mod summary;

pub use summary::{CampaignSummary, RunOutcome, run_all};
