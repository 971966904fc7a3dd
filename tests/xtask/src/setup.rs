//! `cargo xtask setup`: a bare machine becomes one on which everything runs. Commands with a prerequisite check it
//! here.

use anyhow::{Result, ensure};

use crate::machine::{self, TARGET};

/// Installs what is missing.
///
/// # Errors
/// What cannot be installed here, with the command that does.
pub fn run() -> Result<bool> {
    need_target()?;
    println!("setup: compiler target {TARGET} is there");
    need_emulator()?;
    println!("setup: the emulator of the Cortex-M7 board is there");
    println!("setup: {}", broker());
    Ok(true)
}

/// Sees to it that the compiler knows the Cortex-M7.
///
/// # Errors
/// It does not and cannot be taught here.
pub fn need_target() -> Result<()> {
    if machine::has_target(TARGET) {
        return Ok(());
    }
    eprintln!("setup: adding the compiler target {TARGET} with rustup");
    ensure!(
        machine::add_target(TARGET)?,
        "the compiler target {TARGET} is missing and could not be added; please run: rustup target add {TARGET}"
    );
    Ok(())
}

/// Sees to it that the Cortex-M7 board can be emulated.
///
/// # Errors
/// The emulator is missing and cannot be installed here.
pub fn need_emulator() -> Result<()> {
    ensure!(
        machine::has_emulator() || machine::add_emulator()?,
        "the emulator is missing and could not be installed; please run as root: apt-get install --no-install-recommends qemu-system-arm"
    );
    Ok(())
}

/// Sees to it, if it can, that fleets are tested with a broker that others wrote; what came of it.
fn broker() -> &'static str {
    // Whatever prevents it: the tests say that they are skipped.
    if machine::has_broker() || machine::add_broker().unwrap_or(false) {
        "the broker of fleets is there"
    } else {
        "no broker: tests of fleets with Mosquitto are skipped; to run them, as root: apt-get install --no-install-recommends mosquitto"
    }
}
