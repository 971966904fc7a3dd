//! The recordings and answer keys beside the project. They are read there and never copied.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder beside the project that holds recordings and benchmark inputs.
pub fn shared_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared")
}

/// A recording, by its path below `shared/data`. `None`, with a line on standard error that the harness does not
/// swallow, where it is absent: the caller returns and the run says what it skipped.
pub fn recording(path: &str) -> Option<PathBuf> {
    present(shared_folder().join("data").join(path), path)
}

/// A benchmark input, by its path below `shared/bench`; absent ones as in [`recording`].
pub fn bench_input(path: &str) -> Option<PathBuf> {
    present(shared_folder().join("bench").join(path), path)
}

fn present(full: PathBuf, path: &str) -> Option<PathBuf> {
    if full.exists() {
        return Some(full);
    }
    // The harness captures `println!`, not a write to the stream itself.
    let _ = writeln!(std::io::stderr(), "skipped: {path} is absent");
    None
}
