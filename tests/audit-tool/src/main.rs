//! The tool by itself, for a project without an automation of its own.

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};
use embedded_audit::{audit, campaign, facts, records, structure};

/// Evidence for embedded Rust. Exit codes: 0 good, 1 verdict negative, 2 usage, 3 bad input.
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Check every claim of the safety evidence and write it to target/audit.
    Audit(audit::Options),
    /// Check which crate and module knows which, and how long files are; --write draws the graph.
    Structure(structure::Options),
    /// Let the records of evidence follow code that only moved since a commit.
    Moved(records::Options),
    /// Run one of the long campaigns on all cores, or go on where it was cut.
    Campaign(campaign::Options),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match facts::check().and_then(|()| run(&arguments.command)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(3)
        }
    }
}

fn run(command: &Command) -> Result<bool> {
    match command {
        Command::Audit(options) => audit::run(options),
        Command::Structure(options) => structure::run(options),
        Command::Moved(options) => records::run(options),
        Command::Campaign(options) => campaign::run(options),
    }
}
