//! `cargo xtask bench`: times of the stages, in release; with `--peers` side by side with what one installs today.

mod history;
mod machine;
mod peers;
mod table;

use anyhow::Result;
use clap::Args;

use crate::shell;

/// What to measure.
#[derive(Args)]
pub struct Options {
    /// Compare with what one installs today: packages of the Python registry in a virtual environment of their own, and programs in
    /// C++ where their libraries are; rewrites the table of BENCHMARKS.md.
    #[arg(long)]
    peers: bool,
    /// With --peers: one JSON object a row on standard output, everything else on standard error.
    #[arg(long, requires = "peers")]
    json: bool,
    /// Write the last measurement of docs/evidence/benchmarks.json into BENCHMARKS.md and README.md; measures nothing.
    #[arg(long, conflicts_with = "peers")]
    render: bool,
    /// With --peers: only these tasks, for example `tracker`; BENCHMARKS.md stays as it is.
    #[arg(long, requires = "peers", value_name = "TASK")]
    task: Vec<String>,
}

/// Builds and runs the measurement. False if the guard decides too late.
pub fn run(options: &Options) -> Result<bool> {
    if options.render {
        peers::render(&shell::root())?;
        return Ok(true);
    }
    if options.peers {
        peers::run(options.json, &options.task)?;
        return Ok(true);
    }
    shell::succeeds(&mut bench())
}

/// The measuring program.
fn bench() -> std::process::Command {
    let mut command = shell::cargo();
    command.args(["run", "--quiet", "--release", "--package", "floorguard-tests"]);
    command.args(["--bin", "floorguard-bench", "--"]);
    command
}
