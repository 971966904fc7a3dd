//! What this machine lacks, and how Debian calls it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;

use crate::shell;

/// The compiler target of the Cortex-M7.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The standard library for a target is there.
pub fn has_target(target: &str) -> bool {
    let mut query = Command::new("rustc");
    query.current_dir(shell::root()).args(["--print", "target-libdir", "--target", target]);
    shell::output(&mut query).is_some_and(|path| Path::new(path.trim()).is_dir())
}

/// Lets rustup add a target. False if that did not work.
pub fn add_target(target: &str) -> Result<bool> {
    if !shell::is_installed("rustup") {
        return Ok(false);
    }
    let mut add = Command::new("rustup");
    add.current_dir(shell::root()).args(["target", "add", target]);
    Ok(shell::succeeds(&mut add)? && has_target(target))
}

/// The emulator of the Cortex-M7 board.
const EMULATOR: &str = "qemu-system-arm";

/// The emulator is there.
pub fn has_emulator() -> bool {
    shell::is_installed(EMULATOR)
}

/// The emulator of 64-bit ARM programs, under either of its names.
pub fn user_emulator() -> Option<&'static str> {
    ["qemu-aarch64-static", "qemu-aarch64"].into_iter().find(|name| shell::is_installed(name))
}

/// Lets apt install the emulator, which needs root. False if that did not work.
pub fn add_emulator() -> Result<bool> {
    Ok(install(&[EMULATOR])? && has_emulator())
}

/// The broker that fleets are tested with.
pub const BROKER: &str = "mosquitto";

/// The broker is there: Debian puts it where a shell of an ordinary user does not look.
pub fn has_broker() -> bool {
    Path::new("/usr/sbin").join(BROKER).exists()
}

/// Lets apt install the broker, which needs root. False if that did not work.
pub fn add_broker() -> Result<bool> {
    Ok(install(&[BROKER])? && has_broker())
}

/// What `cargo xtask vcan` needs: a Linux that runs as a process, and what its file system is made with.
pub const VCAN_PACKAGES: [&str; 3] = ["user-mode-linux", "busybox-static", "cpio"];

/// All of it is there.
pub fn has_user_mode_linux() -> bool {
    ["linux.uml", "busybox", "cpio"].into_iter().all(shell::is_installed)
}

/// Lets apt install it. False if that did not work.
pub fn add_user_mode_linux() -> Result<bool> {
    Ok(install(&VCAN_PACKAGES)? && has_user_mode_linux())
}

/// The folder of its kernel modules.
pub fn user_mode_modules() -> Option<PathBuf> {
    let versions = std::fs::read_dir("/usr/lib/uml/modules").ok()?;
    versions.filter_map(Result::ok).map(|entry| entry.path()).find(|path| path.join("kernel").is_dir())
}

fn install(packages: &[&str]) -> Result<bool> {
    if !shell::is_installed("apt-get") {
        return Ok(false);
    }
    println!("setup: installing {} with apt-get", packages.join(", "));
    let mut refresh = Command::new("apt-get");
    refresh.args(["update", "--quiet"]);
    let mut install = Command::new("apt-get");
    // No service is to start: tests start their own.
    install.env("DEBIAN_FRONTEND", "noninteractive").env("RUNLEVEL", "1");
    install.args(["install", "--yes", "--quiet", "--no-install-recommends"]).args(packages);
    // Old package lists may do: what counts is whether the programs are there in the end.
    let _ = shell::succeeds(&mut refresh)?;
    shell::succeeds(&mut install)
}
