//! The kept inputs with their counts, as a golden file.

use std::path::Path;

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::emulator::Emulator;
use super::scene::Scene;
use super::tape::tape_of;

/// Counts may differ from the golden file by this share.
const GATE: f64 = 0.005;

/// The worst input that was found for a stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// Stage, as the firmware names it.
    pub stage: String,
    /// Seed of the search.
    pub seed: u64,
    /// Scenes that were tried.
    pub trials: u64,
    /// Instructions at most.
    pub instructions: u64,
    /// Its appearance.
    pub scene: Scene,
}

/// Reads the golden file; none where there is none.
///
/// # Errors
/// It is broken.
pub fn load(path: &Path) -> Result<Vec<Kept>> {
    let Ok(text) = std::fs::read_to_string(path) else { return Ok(vec![]) };
    let value: Value = serde_json::from_str(&text)?;
    let list = value.as_array().context("the golden file is no list")?;
    let kept = |one: &Value| {
        let number = |name: &str| one[name].as_u64();
        let text = |name: &str| one[name].as_str();
        Some(Kept {
            stage: text("stage")?.to_owned(),
            seed: number("seed")?,
            trials: number("trials")?,
            instructions: number("instructions")?,
            scene: Scene::from_text(text("lidar")?, text("scanner")?)?,
        })
    };
    list.iter().map(|one| kept(one).context("an input of the golden file is broken")).collect()
}

/// Writes the golden file.
///
/// # Errors
/// It cannot be written.
pub fn store(path: &Path, all: &[Kept]) -> Result<()> {
    let list: Vec<Value> = all
        .iter()
        .map(|one| {
            let [lidar, scanner] = one.scene.to_text();
            json!({"stage": one.stage, "seed": one.seed, "trials": one.trials, "instructions": one.instructions,
                "lidar": lidar, "scanner": scanner})
        })
        .collect();
    std::fs::write(path, serde_json::to_string_pretty(&list)? + "\n").context("cannot write the golden file")
}

/// Measures the kept inputs again. False if a count has left its gate; with `update` the counts are replaced.
///
/// # Errors
/// The emulator is missing, the firmware fails, or the golden file is broken.
pub fn compare(path: &Path, emulator: &Emulator, update: bool) -> Result<bool> {
    let mut all = load(path)?;
    let mut good = true;
    for one in &mut all {
        let counts = emulator.largest(&tape_of(&one.scene)?)?;
        let seen = counts.get(&one.stage).copied().unwrap_or(0);
        let change = seen as f64 / one.instructions.max(1) as f64 - 1.0;
        println!("  worst input of {:22} {seen:>12} instructions ({:+.2} %)", one.stage, change * 100.0);
        if change.abs() > GATE && !update {
            good = false;
            eprintln!("worst input of {}: {seen} instructions, golden {}", one.stage, one.instructions);
        }
        one.instructions = seen;
    }
    if update {
        store(path, &all)?;
    }
    Ok(good)
}
