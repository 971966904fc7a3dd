//! Climbs from random scenes towards those that cost a stage the most.

use anyhow::Result;

use super::emulator::Emulator;
use super::record::Kept;
use super::scene::Scene;
use super::tape::tape_of;
use crate::campaign::Slice;

/// Stages whose cost depends on what is seen.
pub const STAGES: [&str; 6] = [
    "stage-guard-packet",
    "stage-guard-scan",
    "stage-floor",
    "stage-floor-clusters",
    "stage-features",
    "stage-track",
];
/// A third of the trials samples anywhere, the rest climbs.
const ANYWHERE: u64 = 3;
/// A little worse is taken now and then, or the climb ends on the first hill.
const DOWN_SHARE: f64 = 0.995;

/// The worst scene of a stage after `trials`; begins where `known` ended.
///
/// # Errors
/// The emulator is missing, or the firmware fails.
pub fn search(
    stage: &str,
    (seed, trials): (u64, u64),
    known: Option<&Kept>,
    emulator: &Emulator,
) -> Result<Kept> {
    let mut random = Slice { seed, trials: 0..1 }.random(stage.len() as u64);
    let cost = |scene: &Scene| -> Result<u64> {
        Ok(emulator.largest(&tape_of(scene)?)?.get(stage).copied().unwrap_or(0))
    };
    let start = known.map_or_else(|| Scene::random(&mut random), |known| known.scene.clone());
    let mut best = (cost(&start)?, start);
    let mut current = best.clone();
    for trial in 1..trials {
        let anywhere = known.is_none() && trial < trials / ANYWHERE;
        let scene = if anywhere { Scene::random(&mut random) } else { current.1.mutated(&mut random) };
        let new = (cost(&scene)?, scene);
        if new.0 > best.0 {
            println!("  {stage}: {} instructions after {trial} scenes", new.0);
            best = new.clone();
        }
        let down = random.seldom(8) && new.0 as f64 > current.0 as f64 * DOWN_SHARE;
        if new.0 >= current.0 || down {
            current = new;
        }
    }
    let before = known.map_or(0, |known| known.trials);
    Ok(Kept { stage: stage.to_owned(), seed, trials: before + trials, instructions: best.0, scene: best.1 })
}
