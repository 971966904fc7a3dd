//! `cargo xtask reproduce`: published experiments, repeated, beside the published figures.

use anyhow::Result;
use clap::{Args, ValueEnum};

use crate::shell;

/// What to repeat, and how often.
#[derive(Args)]
pub struct Options {
    /// The publication.
    experiment: Experiment,
    /// Runs for each combination: 5 (the published number of missions is 100, which takes hours for Figure 5), with
    /// moving objects 20.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    trials: Option<u64>,
    /// Another seed than the fresh one, for candidates, dirt and environment.
    #[arg(long)]
    seed: Option<u64>,
}

/// The publications that can be repeated.
#[derive(Clone, Copy, ValueEnum)]
enum Experiment {
    /// Guaranteed cleaning: Table I, Figures 5 and 6.
    Cleaning,
    /// Tours beside LKH's and OR-Tools', re-planning, and what a step of the belief costs.
    Tours,
    /// Moving objects in a corridor: Figures 6 to 8.
    Motion,
    /// People followed in crowds, nearest neighbours against joint probabilities.
    Crowds,
    /// People among objects as a lidar sees them: our candidates against the published ones; a trial is a
    /// place.
    Candidates,
    /// Weekly patterns found again, predictions against a plain histogram, real tracks as heat maps.
    Environment,
    /// Buildings explored from an empty map: our view points beside the published rules, and the best tour in hindsight.
    Exploration,
    /// Dirt on six floors, published detector against ours; spills found by the map.
    Dirt,
    /// People in depth pictures of simulated rooms, both profiles.
    RgbdPeople,
    /// Surfaces around the robot from a lidar on its side that a motor turns: Tables 1 and 2, four experiments, drift.
    SlidingWindow,
    /// Five published laser logs mapped: relation errors beside those of other programs.
    Slam,
    /// Drives of the simulated robot among people, mapped, beside their true poses.
    SlamTruth,
    /// Drives through recorded pedestrians: ours beside the dynamic window and beside standing until the path is free; a trial is a start.
    Pedestrians,
    /// People out of three-dimensional maps: our remover beside others; a trial is a random building.
    PeopleRemoval,
    /// Tours back to where people stood, driven until what they hid has been seen; a trial is a random building.
    Revisits,
    /// Simulated drives of a spinning lidar through two real floor plans: absolute errors beside those of other programs.
    #[value(name = "slam3d")]
    SlamInSpace,
    /// People looked for in sixteen rings of large lidars, and in sixteen more; a trial is a hall.
    SecondLook,
    /// What a robot learns about people in new places, precision and recall over time; a trial is a minute.
    OnlineLearning,
}

/// Builds and runs the experiments. True if everything that must show did.
pub fn run(options: &Options) -> Result<bool> {
    let (name, trials) = match options.experiment {
        Experiment::Cleaning => ("cleaning", 5),
        Experiment::Tours => ("tours", 1),
        Experiment::Motion => ("motion", 20),
        Experiment::Crowds => ("crowds", 5),
        Experiment::Candidates => ("candidates", 30),
        Experiment::Environment => ("environment", 20),
        Experiment::Exploration => ("exploration", 1),
        Experiment::Dirt => ("dirt", 4),
        Experiment::SlidingWindow => ("sliding-window", 20),
        Experiment::Slam => ("slam", 1),
        Experiment::SlamTruth => ("slam-truth", 1),
        Experiment::Pedestrians => ("pedestrians", 20),
        Experiment::PeopleRemoval => ("people-removal", 10),
        Experiment::Revisits => ("revisits", 10),
        Experiment::SlamInSpace => ("slam3d", 1),
        Experiment::SecondLook => ("second-look", 40),
        Experiment::OnlineLearning => ("online-learning", 3),
        // Of fewer rooms the share of legs alone that are right is left to chance: 12 of 17 with 60.
        Experiment::RgbdPeople => ("rgbd-people", 400),
    };
    let trials = options.trials.unwrap_or(trials);
    let folder = shell::root().join("target/reproduce").join(name);
    let mut command = shell::cargo();
    command.args(["run", "--quiet", "--release", "--package", "floorguard-tests"]);
    command.args(["--bin", "floorguard-reproduce", "--", name]).arg(trials.to_string()).arg(&folder);
    command.args(options.seed.map(|seed| seed.to_string()));
    let holds = shell::succeeds(&mut command)?;
    println!("tables and pictures in {}", folder.display());
    Ok(holds)
}
