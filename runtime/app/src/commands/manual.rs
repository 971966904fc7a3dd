//! `floorguard manual`: man pages and completions, made from the command line itself.

use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory, ValueEnum};
use clap_complete::Shell;

use super::Arguments;
use super::exit::BadInput;

/// Where to write.
#[derive(Clone, Debug, Args)]
pub struct ManualArguments {
    /// The folder; made if there is none.
    #[arg(long, value_name = "FOLDER", default_value = "manual")]
    pub out: PathBuf,
}

/// Runs the command.
///
/// # Errors
/// The folder cannot be written.
pub fn run(arguments: &ManualArguments) -> anyhow::Result<()> {
    let folder = &arguments.out;
    let bad = |error: std::io::Error| {
        BadInput(format!("{}: cannot be written ({error}); give another folder", folder.display()))
    };
    std::fs::create_dir_all(folder).map_err(bad)?;
    let pages = write_pages(folder).map_err(bad)?;
    let shells = Shell::value_variants();
    for shell in shells {
        clap_complete::generate_to(*shell, &mut Arguments::command(), "floorguard", folder).map_err(bad)?;
    }
    say!("manual: {pages} man pages and completions for {} shells in {}", shells.len(), folder.display());
    Ok(())
}

/// `help COMMAND` shows what `COMMAND --help` does: no pages of its own.
fn without_help(command: clap::Command) -> clap::Command {
    command.disable_help_subcommand(true).mut_subcommands(without_help)
}

/// A page for the program and one for each of its commands.
fn write_pages(folder: &Path) -> std::io::Result<usize> {
    clap_mangen::generate_to(without_help(Arguments::command()), folder)?;
    Ok(std::fs::read_dir(folder)?
        .filter_map(Result::ok)
        .filter(|file| file.path().extension().is_some_and(|extension| extension == "1"))
        .count())
}
