//! Repeats published experiments: `cargo xtask reproduce cleaning`.

use std::path::Path;
use std::process::ExitCode;

/// Arguments: the number of missions for each combination, and the folder for tables and pictures.
fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [trials, folder] = arguments.as_slice() else {
        eprintln!("usage: floorguard-reproduce TRIALS FOLDER");
        return ExitCode::from(2);
    };
    let Some(trials) = trials.parse().ok().filter(|&trials: &u64| trials > 0) else {
        eprintln!("'{trials}' is not a number of missions");
        return ExitCode::from(2);
    };
    match floorguard_tests::reproduce::cleaning(trials, Path::new(folder)) {
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
