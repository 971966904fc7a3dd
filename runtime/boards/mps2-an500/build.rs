//! Link arguments of the images.

use std::path::PathBuf;

use anyhow::Context;

fn main() -> anyhow::Result<()> {
    // Cargo does not follow linker scripts.
    println!("cargo:rerun-if-changed=../../../memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    // What the log tells; without this only errors.
    println!("cargo:rustc-env=DEFMT_LOG=info");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").context("cargo gives OUT_DIR")?);
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "none") {
        // The start-up code asks for the interrupt names of a device; ours are all defined in Rust.
        std::fs::write(folder.join("device.x"), "/* every handler is defined in Rust */\n")?;
        println!("cargo:rustc-link-search={}", folder.display());
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
        // The strings of the log stay in the image file, where the reader of the log finds them.
        println!("cargo:rustc-link-arg-bin=floorguard-mps2-an500=-Tdefmt.x");
        println!("cargo:rustc-link-arg-bins=--defsym=_board_mps2=1");
    }
    Ok(())
}
