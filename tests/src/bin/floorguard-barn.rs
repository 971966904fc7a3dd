//! Drives the static worlds of the BARN benchmark: `floorguard-barn [ours|dwa] [EVERY]`.

use std::process::ExitCode;

use floorguard_tests::barn::{Score, Which, drive, load, summarise};
use floorguard_tests::data::recording;
use rayon::prelude::*;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let which = match arguments.first().map(String::as_str) {
        None | Some("ours") => Which::Mppi,
        Some("dwa") => Which::Dwa,
        Some(_) => {
            eprintln!("usage: floorguard-barn [ours|dwa] [EVERY]");
            return ExitCode::from(2);
        }
    };
    let every: usize = arguments.get(1).and_then(|every| every.parse().ok()).unwrap_or(1).max(1);
    let Some(path) = recording("barn/barn_even.npz") else { return ExitCode::from(3) };
    let worlds = match load(&path) {
        Ok(worlds) => worlds,
        Err(error) => {
            eprintln!("error: {error:#}");
            return ExitCode::from(3);
        }
    };
    let some: Vec<_> = worlds.into_iter().step_by(every).collect();
    let runs: Vec<_> = some
        .into_par_iter()
        .map(|world| {
            let outcome = drive(&world, which, 1);
            println!("world {:3}: {outcome:?}, {:?}", world.number, Score::of(&world, &outcome));
            (world, outcome)
        })
        .collect();
    println!("{which:?}: {:?}", summarise(&runs));
    println!(
        "rule: success × optimal time / time, clipped to 4 and 8 optimal times (score.clipped) or to 1 and 8 (score.open)"
    );
    ExitCode::SUCCESS
}
