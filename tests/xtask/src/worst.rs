//! The inputs that cost the firmware the most: searched by `cargo xtask campaign worst`, measured by `cargo xtask firmware`.

use std::path::Path;

use anyhow::Result;

use crate::{firmware, program, shell};

/// The kept inputs with their counts.
pub const GOLDEN: &str = "tests/goldens/worst-inputs.json";
/// Scenes for each stage, by default.
const TRIALS: u64 = 200;

/// Searches on from what is kept.
pub fn search(trials: Option<u64>, seed: u64) -> Result<bool> {
    let image = firmware::tape_image()?;
    let trials = trials.unwrap_or(TRIALS).to_string();
    run(&image, &["--search", &trials, "--seed", &seed.to_string()])
}

/// Measures what is kept again. False if a count has left its gate.
pub fn check(image: &Path, update: bool) -> Result<bool> {
    if !shell::root().join(GOLDEN).exists() {
        return Ok(true);
    }
    let good = run(image, if update { &["--update"] } else { &[] })?;
    if !good {
        eprintln!("firmware: if that is meant, run: cargo xtask firmware --update");
    }
    Ok(good)
}

fn run(image: &Path, arguments: &[&str]) -> Result<bool> {
    let mut worst = program::command("floorguard-worst")?;
    worst.arg("--image").arg(image).arg("--golden").arg(shell::root().join(GOLDEN)).args(arguments);
    shell::succeeds(&mut worst)
}
