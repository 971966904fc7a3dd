//! Link arguments of the image.

use std::path::PathBuf;

use anyhow::Context;

fn main() -> anyhow::Result<()> {
    // Cargo does not follow linker scripts.
    println!("cargo:rerun-if-changed=../../../memory.x");
    println!("cargo:rerun-if-changed=build.rs");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").context("cargo gives OUT_DIR")?);
    std::fs::copy("../../../memory.x", folder.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", folder.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
    // The stack has SRAM1, 2 and 3 for itself, 288 KiB from 0x3000_0000; one that grows beyond them faults.
    println!("cargo:rustc-link-arg-bins=--defsym=_stack_start=0x30048000");
    Ok(())
}
