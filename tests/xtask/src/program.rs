//! The workspace's own programs, built with the features that the tests have: otherwise most dependencies are compiled twice.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, bail};
use embedded_audit::shell;

/// Builds one program, not optimised for release, and gives its path.
pub fn built(name: &str) -> Result<PathBuf> {
    made(name, "debug", &[])
}

/// The program as a robot has it, for checks that measure time.
pub fn released(name: &str) -> Result<PathBuf> {
    made(name, "release", &["--release"])
}

fn made(name: &str, folder: &str, profile: &[&str]) -> Result<PathBuf> {
    // Cargo unites the features of the packages that are selected: all of them, of which one program is made.
    let mut build = shell::cargo();
    build.args(["build", "--quiet", "--workspace", "--bin", name]).args(profile);
    if !shell::succeeds(&mut build)? {
        bail!("{name} does not build; repeat it with: {build:?}");
    }
    Ok(shell::target_folder().join(folder).join(name))
}

/// A program, ready for its arguments; it runs in the root of the workspace.
pub fn command(name: &str) -> Result<Command> {
    let mut command = Command::new(built(name)?);
    command.current_dir(shell::root());
    Ok(command)
}
