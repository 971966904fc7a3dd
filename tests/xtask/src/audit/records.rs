//! What other commands measured and the report shows: instruction counts, the equal fingerprint, long campaigns.

use std::fs;
use std::path::Path;

use serde_json::Value;

/// Records of other commands; each may be absent, and the report says so.
#[derive(Default)]
pub struct Records {
    /// `tests/goldens/firmware.json`: counts on the emulated Cortex-M7, and the fingerprint of all outputs.
    pub firmware: Option<Value>,
    /// `tests/goldens/worst-inputs.json`: the inputs that cost a stage the most.
    pub worst: Option<Value>,
    /// `docs/evidence/campaigns.json`: long campaigns that were run, with their counts.
    pub campaigns: Option<Value>,
    /// `docs/safety-manual.md`, of which the report quotes a chapter.
    pub manual: String,
}

/// Reads what there is.
pub fn read(root: &Path) -> Records {
    let value = |path: &str| serde_json::from_str(&fs::read_to_string(root.join(path)).ok()?).ok();
    Records {
        firmware: value("tests/goldens/firmware.json"),
        worst: value(crate::worst::GOLDEN),
        campaigns: value("docs/evidence/campaigns.json"),
        manual: fs::read_to_string(root.join("docs/safety-manual.md")).unwrap_or_default(),
    }
}
