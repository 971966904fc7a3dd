//! What can be chosen for a simulated robot.

use clap::ValueEnum;
use floorguard_configuration::{ouster_example, ouster_keys};
use floorguard_runtime::configuration::{RangingModel, ScannerModel};
use floorguard_types::capacities::SCAN_BEAMS_MAX;

/// Which safety scanner the simulated robot carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FittedScanner {
    /// SICK S300: 541 beams, a serial line.
    #[default]
    S300,
    /// SICK microScan3: 2,751 beams, UDP.
    Microscan3,
    /// Hokuyo UST: 1,081 beams, no safety device, at most 0.3 m/s.
    HokuyoUst,
    /// Hokuyo URG-04LX: 682 beams, ten scans a second, no safety device, at most 0.3 m/s.
    HokuyoUrg04lx,
}

impl FittedScanner {
    /// The model.
    #[must_use]
    pub const fn model(self) -> ScannerModel {
        match self {
            Self::S300 => ScannerModel::S300,
            Self::Microscan3 => ScannerModel::MicroScan3 { beams: SCAN_BEAMS_MAX as u16 },
            Self::HokuyoUst => ScannerModel::Ranging(RangingModel::HokuyoUst),
            Self::HokuyoUrg04lx => ScannerModel::Ranging(RangingModel::HokuyoUrg04lx),
        }
    }
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
