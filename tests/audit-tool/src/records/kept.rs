//! What other commands measured and the report shows: instruction counts, the equal fingerprint, long campaigns.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::facts::facts;

const CAMPAIGNS: &str = "docs/evidence/campaigns.json";

/// Records of other commands; each may be absent or broken, and the report says which is and why.
#[derive(Default)]
pub struct Records {
    /// `tests/goldens/firmware.json`: counts on the emulated Cortex-M7, and the fingerprint of all outputs.
    pub firmware: Option<Value>,
    /// `tests/goldens/worst-inputs.json`: the inputs that cost a stage the most.
    pub worst: Option<Value>,
    /// `docs/evidence/campaigns.json`: long campaigns that were run, with their counts.
    pub campaigns: Option<Value>,
    /// `docs/safety-manual.md`, of which the report quotes chapters.
    pub manual: String,
    /// What could not be read: the file and why.
    pub missing: Vec<String>,
}

/// Reads what there is.
pub fn read(root: &Path) -> Records {
    let mut missing = Vec::new();
    let text = |path: &str| fs::read_to_string(root.join(path)).map_err(|error| format!("{path}: {error}"));
    let value = |path: &str, is_whole: fn(&Value) -> bool| {
        let value: Value = serde_json::from_str(&text(path)?).map_err(|error| format!("{path}: {error}"))?;
        if is_whole(&value) {
            Ok(value)
        } else {
            Err(format!("{path}: is of another form than its command writes"))
        }
    };
    let mut note = |why: String| missing.push(why);
    let firmware = value(&facts().records.instructions, |value| value["instructions"].is_object())
        .map_err(&mut note)
        .ok();
    let worst = value(&facts().records.worst_inputs, Value::is_array).map_err(&mut note).ok();
    let campaigns = value(CAMPAIGNS, Value::is_array).map_err(&mut note).ok();
    let manual = text(&facts().records.manual).map_err(&mut note).unwrap_or_default();
    Records { firmware, worst, campaigns, manual, missing }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absent_or_broken_records_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let missing = read(folder.path()).missing;
        let names = &facts().records;
        let (firmware, worst, manual) = (&names.instructions, &names.worst_inputs, &names.manual);
        let files: [&str; 4] = [firmware, worst, CAMPAIGNS, manual];
        assert!(missing.iter().zip(files).all(|(why, file)| why.starts_with(file)), "{missing:?}");
        assert_eq!(missing.len(), files.len());
        for (file, text) in files.into_iter().zip(["{}", "{}", "[{]", "# M"]) {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, text).expect("it is written");
        }
        let records = read(folder.path());
        assert_eq!(records.missing.len(), 3, "{:?}", records.missing);
        assert!(records.campaigns.is_none() && records.missing[2].starts_with(CAMPAIGNS));
    }

    #[test]
    fn the_tree_has_them_all() {
        assert_eq!(read(&crate::shell::root()).missing, Vec::<String>::new());
    }
}
