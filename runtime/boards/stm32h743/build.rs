//! Link arguments of the image, and the robot's configuration as constants.

use std::path::{Path, PathBuf};

use anyhow::Context;
use floorguard_configuration::{bake, load};

fn main() -> anyhow::Result<()> {
    // Cargo does not follow linker scripts.
    println!("cargo:rerun-if-changed=../../../memory.x");
    println!("cargo:rerun-if-changed=../../../robot.toml");
    println!("cargo:rerun-if-changed=build.rs");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").context("cargo gives OUT_DIR")?);
    // The same checks as on the robot's computer: a wrong file stops the build with its line and the remedy.
    let robot = load(Path::new("../../../robot.toml"))?.robot;
    std::fs::write(folder.join("robot.rs"), bake(&robot))?;
    std::fs::copy("../../../memory.x", folder.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", folder.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
    // The stack has SRAM1, 2 and 3 for itself, 288 KiB from 0x3000_0000; one that grows beyond them faults.
    println!("cargo:rustc-link-arg-bins=--defsym=_stack_start=0x30048000");
    Ok(())
}
