//! `cargo xtask bench`: times of the stages, in release.

use anyhow::Result;

use crate::shell;

/// Builds and runs the measurement.
pub fn run() -> Result<bool> {
    let mut command = shell::cargo();
    command.args([
        "run",
        "--quiet",
        "--release",
        "--package",
        "floorguard-tests",
        "--bin",
        "floorguard-bench",
    ]);
    shell::succeeds(&mut command)
}
