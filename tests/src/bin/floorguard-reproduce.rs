//! Repeats published experiments and our own: `cargo xtask reproduce`.

use std::path::Path;
use std::process::ExitCode;

/// Arguments: the experiment, the number of runs for each combination, and the folder for tables and pictures.
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [experiment, trials, folder] = arguments.as_slice() else {
        eprintln!("usage: floorguard-reproduce EXPERIMENT TRIALS FOLDER");
        return ExitCode::from(2);
    };
    let Some(trials) = trials.parse().ok().filter(|&trials: &u64| trials > 0) else {
        eprintln!("'{trials}' is not a number of runs");
        return ExitCode::from(2);
    };
    let folder = Path::new(folder);
    let outcome = match experiment.as_str() {
        "cleaning" => floorguard_tests::reproduce::cleaning(trials, folder),
        "motion" => floorguard_tests::reproduce::motion(trials, folder),
        "candidates" => floorguard_tests::candidates::candidates(trials, folder),
        "crowds" => floorguard_tests::crowds::crowds(trials, folder),
        "environment" => floorguard_tests::environment::environment(trials, folder),
        "dirt" => floorguard_tests::dirt::dirt(trials, folder),
        "rgbd-people" => floorguard_tests::rgbd::rgbd_people(trials, folder),
        "online-learning" => floorguard_tests::online::online_learning(trials, folder),
        other => {
            eprintln!("no experiment is called '{other}'");
            return ExitCode::from(2);
        }
    };
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
