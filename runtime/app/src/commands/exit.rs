//! Exit codes: 0 good, 1 the verdict is failed or not finished, 2 wrong usage (also clap's own), 3 bad input, 130 ended before there was
//! anything to judge.

pub use floorguard_host::outcome::{BadInput, NotFinished, Unfinished, VerdictFailed, WrongUsage};

use super::interrupt::INTERRUPTED;

/// The reader of standard output has gone.
#[must_use]
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let kinds = error.chain().filter_map(|cause| cause.downcast_ref::<std::io::Error>());
    kinds.into_iter().any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}

/// The exit code of an error. What is neither verdict nor wrong usage is bad input.
#[must_use]
pub fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<VerdictFailed>() || error.is::<NotFinished>() {
        1
    } else if error.is::<Unfinished>() {
        INTERRUPTED as u8
    } else if error.is::<WrongUsage>() {
        2
    } else {
        3
    }
}
