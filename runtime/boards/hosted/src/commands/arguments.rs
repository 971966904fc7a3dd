//! The command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

/// On-robot software for a floor-cleaning robot among people: perceives, guards, records.
#[derive(Debug, Parser)]
#[command(name = "floorguard", version, about)]
pub struct Arguments {
    /// What to do; without a command: the demo.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// One thing to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Check a configuration: every mistake with line, limit and remedy.
    Check {
        /// The configuration.
        file: PathBuf,
    },
}
