//! Link arguments: the start-up code and the memory of the emulated board.

use std::path::PathBuf;

use anyhow::Context;

fn main() -> anyhow::Result<()> {
    // Cargo does not follow linker scripts.
    println!("cargo:rerun-if-changed=../../memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").context("cargo gives OUT_DIR")?);
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "none") {
        // No interrupt is used.
        std::fs::write(folder.join("device.x"), "/* every handler is the default one */\n")?;
        println!("cargo:rustc-link-search={}", folder.display());
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bins=--defsym=_board_mps2=1");
    }
    Ok(())
}
