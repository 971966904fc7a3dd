//! `floorguard eval`: a stage against a key.

use clap::{Args, Subcommand};

#[cfg(feature = "laboratory")]
use super::stages::{self, RecordedStage};
use crate::mapping_commands::{SlamArguments, eval_slam};
use crate::recordings::{GroundArguments, eval_ground};

/// What to evaluate.
#[derive(Clone, Debug, Args)]
pub struct EvalArguments {
    /// Which stage.
    #[command(subcommand)]
    pub stage: EvalStage,
    /// One JSON object on standard output instead of a table.
    #[arg(long, global = true)]
    pub json: bool,
}

/// A stage and its files.
#[derive(Clone, Debug, Subcommand)]
pub enum EvalStage {
    /// The floor in one turn of a lidar, out of a point cloud (PLY, PCD, KITTI).
    #[command(after_help = "Example:\n  floorguard eval ground sweep.ply --out floor.ply")]
    Ground(GroundArguments),
    /// A trajectory against reference relations or a true trajectory.
    Slam(SlamArguments),
    /// A stage of the robot.
    #[cfg(feature = "laboratory")]
    #[command(flatten)]
    Recorded(RecordedStage),
}

/// Runs the command.
///
/// # Errors
/// Bad input, or a verdict that is not good enough.
pub fn run(arguments: &EvalArguments) -> anyhow::Result<()> {
    match &arguments.stage {
        EvalStage::Ground(ground) => eval_ground(ground, arguments.json),
        EvalStage::Slam(slam) => eval_slam(slam, arguments.json),
        #[cfg(feature = "laboratory")]
        EvalStage::Recorded(stage) => stages::run(stage, arguments.json),
    }
}
