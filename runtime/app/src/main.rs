//! `floorguard`, the program.

use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser;
use floorguard_app::commands::{Arguments, dispatch, exit_code, is_broken_pipe};

fn main() -> ExitCode {
    match dispatch(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        // `| head`: who reads has seen enough.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(anstream::stderr(), "{error:#}");
            ExitCode::from(exit_code(&error))
        }
    }
}
