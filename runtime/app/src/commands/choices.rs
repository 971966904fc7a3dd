//! What can be chosen for a simulated robot.

use clap::ValueEnum;
use floorguard_configuration::{ouster_example, ouster_keys};

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
    /// Hesai PandarXT-32.
    PandarXt32,
    /// Ouster, like an OS1 with 32 beams.
    Ouster,
}

impl FittedLidar {
    /// The keys of `[lidar]` that say so, where it is not the example's.
    #[must_use]
    pub fn keys(self) -> Option<String> {
        match self {
            Self::Vlp16 => None,
            Self::PandarXt16 => Some("model = \"pandar-xt16\"".to_owned()),
            Self::PandarXt32 => Some("model = \"pandar-xt32\"".to_owned()),
            Self::Ouster => Some(ouster_keys(&ouster_example())),
        }
    }
}

/// Which local planner drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrivingPlanner {
    /// Sampling-based predictive control: expects people.
    Ours,
    /// The dynamic window as published.
    Dwa,
}
