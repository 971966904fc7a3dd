//! `cargo xtask panel-check`: the operator's panel in a headless browser, walked through as by a person.
//!
//! The browser is the system's Chromium; what drives it (playwright-core) and what judges it (axe-core) come from the npm
//! registry into a folder under `target/`. Where one of them is missing the check is skipped, and says so.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;
use clap::Args;

use crate::{program, shell};

/// Names under which Chromium is installed.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// What drives the browser and what judges the page, at the versions that were tried.
const PACKAGES: [&str; 2] = ["playwright-core@1", "axe-core@4"];

/// What to walk through.
#[derive(Args)]
pub struct Options {
    /// Only these parts: layouts, mouse, touch, keyboard, tabs, viewer, frames, reports, viewers.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
}

/// Builds, installs and walks. True when every check passed, or there is no browser.
///
/// # Errors
/// The program cannot be built, or the folder cannot be written.
pub fn run(options: &Options) -> Result<bool> {
    let folder = shell::target_folder().join("panel-check");
    std::fs::create_dir_all(&folder)?;
    let browser = match prepared(&folder) {
        Ok(browser) => browser,
        Err(why) => {
            println!("panel-check: skipped: {why}");
            return Ok(true);
        }
    };
    let program = program::released("floorguard")?;
    let _ = std::fs::remove_file(folder.join("records.json"));
    let mut walk = Command::new("node");
    walk.arg(shell::root().join("tests/panel/check.mjs"));
    walk.arg(program).arg(browser).arg(&folder);
    walk.env("PANEL_CHECK", options.only.join(","));
    shell::succeeds(&mut walk)
}

/// The browser's place, with everything else installed.
fn prepared(folder: &Path) -> Result<PathBuf, String> {
    let browser = BROWSERS.iter().find(|name| shell::is_installed(name)).ok_or("no Chromium is installed")?;
    if !(shell::is_installed("node") && shell::is_installed("npm")) {
        return Err("node and npm are not installed".to_owned());
    }
    let place = shell::output(Command::new("sh").args(["-c", "command -v \"$0\"", browser]));
    let place = place.ok_or("the browser has no path")?;
    if PACKAGES.iter().all(|name| {
        let name = name.split('@').next().unwrap_or(name);
        folder.join("node_modules").join(name).is_dir()
    }) {
        return Ok(PathBuf::from(place.trim()));
    }
    std::fs::write(folder.join("package.json"), "{\"private\":true}\n").map_err(|error| error.to_string())?;
    let mut npm = Command::new("npm");
    npm.args(["install", "--silent", "--no-audit", "--no-fund", "--prefix"]).arg(folder).args(PACKAGES);
    shell::output(&mut npm).ok_or("npm cannot install playwright-core and axe-core here (no registry?)")?;
    Ok(PathBuf::from(place.trim()))
}
