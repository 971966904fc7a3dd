//! `floorguard train detector`: a small network on rendered pictures, written as an ONNX file.

use std::path::PathBuf;

use clap::Args;
use floorguard_laboratory::train::detector::{
    DetectorTraining, judge_detector, onnx_file, rendered_pictures, train_detector,
};

use floorguard_host::outcome::BadInput;

/// How to train.
#[derive(Clone, Debug, Args)]
pub struct TrainDetectorArguments {
    /// Where the model goes (.onnx).
    #[arg(long)]
    pub out: PathBuf,
    /// Rendered pictures to learn from; a quarter as many of other rooms are held out for the figures.
    #[arg(long, default_value_t = 2_400, value_parser = clap::value_parser!(u64).range(8..=100_000))]
    pub pictures: u64,
    /// Times that every picture is shown.
    #[arg(long, default_value_t = 12)]
    pub rounds: usize,
    /// Seed of rooms, weights and order.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Runs the command.
///
/// # Errors
/// The file cannot be written.
pub fn run(arguments: &TrainDetectorArguments) -> anyhow::Result<()> {
    let TrainDetectorArguments { out, pictures, rounds, seed } = arguments;
    // Written once before hours are spent on what it cannot take.
    let unwritable = |error| BadInput(format!("{}: cannot be written ({error})", out.display()));
    std::fs::write(out, []).map_err(unwritable)?;
    let first_room = seed * 1_000_000;
    let learnt = rendered_pictures(first_room, *pictures);
    let held_out = rendered_pictures(first_room + 500_000, (pictures / 4).max(1));
    let training = DetectorTraining { rounds: *rounds, seed: *seed };
    let network = train_detector(&learnt, training, |round, cost| {
        say!("  round {} of {rounds}: loss {cost:.3} a picture", round + 1);
    });
    std::fs::write(out, onnx_file(&network)).map_err(unwritable)?;
    say!("rendered rooms it learnt from: {}", judge_detector(&network, &learnt).words());
    say!("rendered rooms held out:       {}", judge_detector(&network, &held_out).words());
    say!(
        "{}: for the chain from pictures to maps; real people look otherwise, bring a detector for them",
        out.display()
    );
    Ok(())
}
