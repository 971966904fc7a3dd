//! Whether the code is still the one that a record was made with.

use serde::Serialize;

/// What became of core and drivers since a record.
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

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Same => "the same",
            Self::Changed => "changed",
            Self::NotRecorded => "not recorded",
        }
    }
}
