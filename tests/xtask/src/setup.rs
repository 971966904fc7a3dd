//! `cargo xtask setup`: a bare machine becomes one on which everything runs.

use anyhow::Result;

use crate::machine::{self, TARGET};

/// Installs what is missing. False, with the exact remedy on the terminal, where it cannot.
pub fn run() -> Result<bool> {
    if machine::has_target() {
        println!("setup: compiler target {TARGET} is there");
    } else {
        println!("setup: adding the compiler target {TARGET} with rustup");
        if !machine::add_target()? {
            eprintln!("setup: cannot add it here; please run: rustup target add {TARGET}");
            return Ok(false);
        }
    }
    if machine::has_emulator() {
        println!("setup: the emulator of the Cortex-M7 board is there");
    } else if !machine::add_emulator()? {
        eprintln!(
            "setup: cannot install it here; please run as root: apt-get install --no-install-recommends qemu-system-arm"
        );
        return Ok(false);
    }
    Ok(true)
}
