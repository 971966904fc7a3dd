//! How a command can end other than well: these errors become exit codes.

/// The run ended, and what it showed is not good enough.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("verdict: failed: {0}")]
pub struct VerdictFailed(pub String);

/// The run ended, nothing bad happened, and what was asked for was not reached.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("verdict: not finished: {0}")]
pub struct NotFinished(pub String);

/// A file, a device or a scenario name that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// Somebody has ended it before there was anything to judge.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unfinished(pub String);
