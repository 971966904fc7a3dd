//! What this machine lacks, and how Debian calls it.

use std::process::Command;

use anyhow::Result;

use crate::shell;

/// The compiler target of the Cortex-M7.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The standard library for the target is there.
pub fn has_target() -> bool {
    let mut query = Command::new("rustc");
    query.current_dir(shell::root()).args(["--print", "target-libdir", "--target", TARGET]);
    shell::output(&mut query).is_some_and(|path| std::path::Path::new(path.trim()).is_dir())
}

/// Lets rustup add the target. False if that did not work.
pub fn add_target() -> Result<bool> {
    if !shell::is_installed("rustup") {
        return Ok(false);
    }
    let mut add = Command::new("rustup");
    add.current_dir(shell::root()).args(["target", "add", TARGET]);
    Ok(shell::succeeds(&mut add)? && has_target())
}
