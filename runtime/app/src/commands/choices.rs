//! What can be chosen for a simulated robot.

use clap::ValueEnum;

/// Which safety scanner the simulated robot carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FittedScanner {
    /// SICK S300: 541 beams, a serial line.
    #[default]
    S300,
    /// SICK microScan3: 2,751 beams, UDP.
    Microscan3,
}

/// Which lidar the simulated robot carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FittedLidar {
    /// Velodyne VLP-16.
    #[default]
    Vlp16,
    /// Hesai PandarXT-16.
    PandarXt16,
}

/// Which local planner drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrivingPlanner {
    /// Sampling-based predictive control: expects people.
    Ours,
    /// The dynamic window as published.
    Dwa,
}
