//! Repeats published experiments and our own: `cargo xtask reproduce`.

use std::path::Path;
use std::process::ExitCode;

/// Seed of the experiments that take one: a day on which nothing was tuned.
const SEED: u64 = 20_261_121;

/// Arguments: the experiment, the number of runs for each combination, the folder for tables and pictures, and the seed of
/// the experiments that take one.
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (experiment, trials, folder, seed) = match arguments.as_slice() {
        [experiment, trials, folder] => (experiment, trials, folder, None),
        [experiment, trials, folder, seed] => (experiment, trials, folder, Some(seed)),
        _ => {
            eprintln!("usage: floorguard-reproduce EXPERIMENT TRIALS FOLDER [SEED]");
            return ExitCode::from(2);
        }
    };
    let Ok(seed) = seed.map(|seed| seed.parse()).transpose() else {
        eprintln!("a seed is a whole number");
        return ExitCode::from(2);
    };
    let is_seeded = matches!(experiment.as_str(), "environment" | "dirt" | "candidates");
    if seed.is_some() && !is_seeded {
        eprintln!("'{experiment}' has its own seeds");
        return ExitCode::from(2);
    }
    let Some(trials) = trials.parse().ok().filter(|&trials: &u64| trials > 0) else {
        eprintln!("'{trials}' is not a number of runs");
        return ExitCode::from(2);
    };
    match reproduced(experiment, trials, Path::new(folder), seed) {
        Some(outcome) => exit_code(outcome),
        None => {
            eprintln!("no experiment is called '{experiment}'");
            ExitCode::from(2)
        }
    }
}

/// What an experiment printed, and whether everything that must show did; `None` without an experiment of this name.
fn reproduced(
    experiment: &str,
    trials: u64,
    folder: &Path,
    seed: Option<u64>,
) -> Option<anyhow::Result<(String, bool)>> {
    let outcome = match experiment {
        "cleaning" => floorguard_tests::reproduce::cleaning(trials, folder),
        "tours" => floorguard_tests::reproduce::tours(folder),
        "motion" => floorguard_tests::reproduce::motion(trials, folder),
        "candidates" => {
            let seed = seed.unwrap_or(floorguard_tests::candidates::SEED);
            floorguard_tests::candidates::candidates(trials, seed, folder)
        }
        "crowds" => floorguard_tests::crowds::crowds(trials, folder),
        "environment" => floorguard_tests::environment::environment(trials, seed.unwrap_or(SEED), folder),
        "exploration" => floorguard_tests::exploration::exploration(folder),
        "dirt" => floorguard_tests::dirt::dirt(trials, seed.unwrap_or(SEED), folder),
        "sliding-window" => floorguard_tests::reproduce::sliding_window::sliding_window(trials, folder),
        "slam" => floorguard_tests::slam::slam(folder),
        "slam-truth" => floorguard_tests::slam::slam_beside_truth(folder),
        "pedestrians" => floorguard_tests::pedestrians::pedestrians(trials, folder),
        "people-removal" => floorguard_tests::removal::people_removal(trials, folder),
        "revisits" => floorguard_tests::removal::people_revisits(trials, folder),
        "slam3d" => floorguard_tests::slam::slam_in_space(folder),
        "rgbd-people" => floorguard_tests::rgbd::rgbd_people(trials, folder),
        "second-look" => floorguard_tests::second_look::second_look(trials, folder),
        "online-learning" => floorguard_tests::online::online_learning(trials, folder),
        _ => return None,
    };
    Some(outcome)
}

fn exit_code(outcome: anyhow::Result<(String, bool)>) -> ExitCode {
    match outcome {
        Ok((_, true)) => ExitCode::SUCCESS,
        Ok((_, false)) => {
            eprintln!("not everything that must show did");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(3)
        }
    }
}
