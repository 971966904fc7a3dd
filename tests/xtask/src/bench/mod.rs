//! `cargo xtask bench`: times of the stages, in release; with `--peers` side by side with what one installs today.

mod peers;
mod table;

use anyhow::Result;
use clap::Args;

use crate::shell;

/// What to measure.
#[derive(Args)]
pub struct Options {
    /// Compare with peers from the Python registry, in a virtual environment of their own, and rewrite BENCHMARKS.md.
    #[arg(long)]
    peers: bool,
}

/// Builds and runs the measurement. False if the guard decides too late.
pub fn run(options: &Options) -> Result<bool> {
    let in_time = shell::succeeds(&mut bench())?;
    if options.peers {
        peers::run()?;
    }
    Ok(in_time)
}

/// The measuring program.
fn bench() -> std::process::Command {
    let mut command = shell::cargo();
    command.args(["run", "--quiet", "--release", "--package", "floorguard-tests"]);
    command.args(["--bin", "floorguard-bench", "--"]);
    command
}
