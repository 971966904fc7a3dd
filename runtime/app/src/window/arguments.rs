//! The command line.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use floorguard_mapping::sliding_window::{CellPolicy, LidarMount};
use floorguard_robot::actuated::WindowSetup;

/// What to see.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples: floorguard window --scenario office --out office\n          \
                  floorguard window tilt.scan.csv.gz --servo tilt.servo_deg.csv.gz --out tilt")]
pub struct WindowArguments {
    /// Scans of a lidar that a servo tilts about the axis across: rows of receive time in ns, stamp in s, first angle, last angle,
    /// step in radians, count, ranges in metres (.csv, packed or not).
    #[arg(required_unless_present = "scenario", conflicts_with = "scenario", requires = "servo")]
    pub scans: Option<PathBuf>,
    /// The servo's angles: rows of receive time in ns and degrees.
    #[arg(long, value_name = "FILE.csv", conflicts_with = "scenario")]
    pub servo: Option<PathBuf>,
    /// Height of the servo's axis above the floor, metres.
    #[arg(long, value_name = "M", default_value_t = 0.3)]
    pub height_m: f64,
    /// The servo's angle of a level scan, degrees.
    #[arg(long, value_name = "DEG", default_value_t = 90.0)]
    pub level_deg: f64,
    /// A simulated room instead, over the bytes of a Hokuyo lidar and a CiA 402 motor: box, office, person or drive.
    #[arg(long, value_name = "NAME")]
    pub scenario: Option<String>,
    /// The simulated lidar.
    #[arg(long, default_value = "urg")]
    pub lidar: LidarArgument,
    /// Simulated seconds.
    #[arg(long, value_name = "S", default_value_t = 30)]
    pub seconds: u64,
    /// Seed of the simulated noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// What goes wrong in the simulation.
    #[arg(long)]
    pub fault: Option<FaultArgument>,
    /// The folder of the map; a former map in it is replaced once the new one is whole.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Edge of a cell of the window, metres.
    #[arg(long, value_name = "M", default_value_t = 0.05)]
    pub cell_m: f32,
    /// What hangs higher is no obstacle, metres.
    #[arg(long, value_name = "M", default_value_t = 1.0)]
    pub threshold_m: f32,
    /// The published rule for cells, the last point, instead of the nearest one.
    #[arg(long)]
    pub last_point: bool,
    /// The summary as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

impl WindowArguments {
    /// The window of these arguments.
    pub(super) fn setup(&self, mount: LidarMount) -> WindowSetup {
        let policy = if self.last_point { CellPolicy::Compat } else { CellPolicy::Nearest };
        WindowSetup { cell_m: self.cell_m, policy, threshold_m: self.threshold_m, mount }
    }
}

/// A simulated lidar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LidarArgument {
    /// URG-04LX.
    Urg,
    /// UST-10LX.
    Ust,
}

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FaultArgument {
    /// The motor is held after ten seconds.
    MotorStalled,
    /// Of the motor's angles one in six arrives: they are 60 ms apart.
    AnglesLost,
    /// A character of every third scan is damaged.
    DamagedCheck,
}
