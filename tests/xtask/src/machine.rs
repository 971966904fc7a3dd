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

/// The emulator of the Cortex-M7 board.
const EMULATOR: &str = "qemu-system-arm";

/// The emulator is there.
pub fn has_emulator() -> bool {
    shell::is_installed(EMULATOR)
}

/// Lets apt install the emulator, which needs root. False if that did not work.
pub fn add_emulator() -> Result<bool> {
    if !shell::is_installed("apt-get") {
        return Ok(false);
    }
    println!("setup: installing {EMULATOR} with apt-get");
    let mut refresh = Command::new("apt-get");
    refresh.args(["update", "--quiet"]);
    let mut install = Command::new("apt-get");
    install.env("DEBIAN_FRONTEND", "noninteractive");
    install.args(["install", "--yes", "--quiet", "--no-install-recommends", EMULATOR]);
    // Old package lists may do: what counts is whether the program is there in the end.
    let _ = shell::succeeds(&mut refresh)?;
    Ok(shell::succeeds(&mut install)? && has_emulator())
}
