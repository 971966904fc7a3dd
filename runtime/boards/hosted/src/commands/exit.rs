//! Exit codes: 0 passed, 1 the verdict failed, 2 wrong usage (also clap's own), 3 bad input.

/// The run ended, and what it showed is not good enough.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("verdict: failed: {0}")]
pub struct VerdictFailed(pub String);

/// A file, a device or a scenario name that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// The exit code of an error. What is no verdict is bad input; wrong usage ends in clap with 2.
#[must_use]
pub fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<VerdictFailed>() { 1 } else { 3 }
}
