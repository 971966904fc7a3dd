//! The robot's configuration as constants.

use std::path::{Path, PathBuf};

use anyhow::Context;
use floorguard_configuration::{bake, load};

fn main() -> anyhow::Result<()> {
    println!("cargo:rerun-if-changed=../../../robot.toml");
    println!("cargo:rerun-if-changed=build.rs");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").context("cargo gives OUT_DIR")?);
    // The same checks as on the robot's computer: a wrong file stops the build with its line and the remedy.
    let robot = load(Path::new("../../../robot.toml"))?.robot;
    std::fs::write(folder.join("robot.rs"), bake(&robot))?;
    Ok(())
}
