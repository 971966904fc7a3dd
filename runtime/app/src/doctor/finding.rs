//! One observation about the computer, with its remedy.

use std::fmt;

use serde::Serialize;

/// How much an observation matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum State {
    /// As it should be.
    Good,
    /// The robot runs; something is worse than it could be, or is not known.
    Warning,
    /// The robot does not run, or not in time.
    Bad,
}

/// One observation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Finding {
    /// What was looked at.
    pub what: String,
    /// How it is.
    pub state: State,
    /// What was found, with units.
    pub found: String,
    /// What to do; empty where nothing needs to be done.
    pub remedy: String,
}

impl Finding {
    pub(super) fn good(what: impl Into<String>, found: impl Into<String>) -> Self {
        Self { what: what.into(), state: State::Good, found: found.into(), remedy: String::new() }
    }

    pub(super) fn warning(
        what: impl Into<String>,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { what: what.into(), state: State::Warning, found: found.into(), remedy: remedy.into() }
    }

    pub(super) fn bad(what: impl Into<String>, found: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { what: what.into(), state: State::Bad, found: found.into(), remedy: remedy.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let state = match self.state {
            State::Good => "good   ",
            State::Warning => "WARNING",
            State::Bad => "BAD    ",
        };
        write!(f, "{state} {}: {}", self.what, self.found)?;
        if !self.remedy.is_empty() {
            write!(f, "\n          -> {}", self.remedy)?;
        }
        Ok(())
    }
}
