//! How a command can end other than well: these errors become exit codes.

/// The run ended, and what it showed is not good enough.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("verdict: failed: {0}")]
pub struct VerdictFailed(pub String);

/// The run ended, nothing bad happened, and what was asked for was not reached.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("verdict: not finished: {0}")]
pub struct NotFinished(pub String);

/// A file or a device that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// A value on the command line that cannot be, or that does not go with another one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct WrongUsage(pub String);

/// Somebody has ended it before there was anything to judge.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unfinished(pub String);
