//! Whether the code is still the one that a record was made with.

use serde::Serialize;
use serde_json::Value;

/// The fingerprints of the code as it is.
#[derive(Debug, Clone, Default)]
pub struct CodeToday {
    /// Of core and drivers.
    pub code: String,
    /// Of runtime and simulator, too.
    pub whole: String,
}

/// What became of the code since a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Since {
    /// Their fingerprint is the recorded one.
    Same,
    /// It is another.
    Changed,
    /// The record keeps none.
    NotRecorded,
}

impl Since {
    /// From the fingerprint that a record keeps, if any, and that of today.
    pub fn of(recorded: Option<&str>, today: &str) -> Self {
        match recorded {
            None | Some("") => Self::NotRecorded,
            Some(code) if code == today => Self::Same,
            Some(_) => Self::Changed,
        }
    }

    /// Of the record of a campaign: where the whole robot ran, its runtime and simulator count, too.
    pub fn of_campaign(record: &Value, today: &CodeToday) -> Self {
        match (Self::of(record["code"].as_str(), &today.code), record["whole"].as_str()) {
            (Self::Same, Some(whole)) => Self::of(Some(whole), &today.whole),
            (since, _) => since,
        }
    }

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Same => "the same",
            Self::Changed => "changed",
            Self::NotRecorded => "not recorded",
        }
    }
}
