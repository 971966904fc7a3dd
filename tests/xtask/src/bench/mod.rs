//! `cargo xtask bench`: times of the stages, in release; with `--peers` side by side with what one installs today.

mod documents;
mod history;
mod line;
mod machine;
mod peers;
mod table;

use std::process::Command;

use anyhow::Result;
use clap::Args;

use crate::shell;

/// What to measure.
#[derive(Args)]
pub struct Options {
    /// Compare with what one installs today: packages of the Python registry in a virtual environment of their own, and programs in
    /// C++ where their libraries are. Keeps the measurement in docs/evidence/benchmarks.json and rewrites the tables of BENCHMARKS.md
    /// and README.md; at a load above the number of cores nothing is written, and the exit code is 1.
    #[arg(long)]
    peers: bool,
    /// With --peers: one JSON object a row on standard output, everything else on standard error.
    #[arg(long, requires = "peers")]
    json: bool,
    /// Write the kept measurements into BENCHMARKS.md and README.md; measures nothing.
    #[arg(long, conflicts_with = "peers")]
    render: bool,
    /// With --peers: only these tasks, for example `tracker`, at any load; nothing is written.
    #[arg(long, requires = "peers", value_name = "TASK")]
    task: Vec<String>,
}

/// Builds and runs the measurement. False if the guard decides too late, or the machine is too busy for the table.
pub fn run(options: &Options) -> Result<bool> {
    if options.render {
        documents::render(&shell::root())?;
        return Ok(true);
    }
    if options.peers {
        return peers::run(options.json, &options.task);
    }
    shell::succeeds(&mut bench())
}

/// The measuring program.
fn bench() -> Command {
    let mut command = cargo("run");
    command.arg("--");
    command
}

/// Only builds it.
fn build() -> Command {
    cargo("build")
}

fn cargo(what: &str) -> Command {
    let mut command = shell::cargo();
    command.args([
        what,
        "--quiet",
        "--release",
        "--package",
        "floorguard-tests",
        "--bin",
        "floorguard-bench",
    ]);
    command
}
