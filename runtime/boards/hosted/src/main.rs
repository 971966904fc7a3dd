//! `floorguard`, the program.

use std::process::ExitCode;

use clap::Parser;
use floorguard_hosted::commands::{Arguments, dispatch, exit_code};

fn main() -> ExitCode {
    match dispatch(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            anstream::eprintln!("{error:#}");
            ExitCode::from(exit_code(&error))
        }
    }
}
