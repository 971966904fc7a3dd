//! What can be chosen for a simulated robot.

use clap::ValueEnum;
use floorguard_configuration::{BRIDGED_EXAMPLE, bridged_keys, livox_keys, ouster_example, ouster_keys};
use floorguard_runtime::configuration::{ImuModel, RangingModel, ScannerModel};
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
    /// SICK TiM5xx: 811 beams, fifteen scans a second, no safety device, at most 0.3 m/s.
    SickTim5xx,
    /// SICK LMS1xx: 541 beams, no safety device, at most 0.3 m/s.
    SickLms1xx,
    /// RPLidar A1 to A3: 300 beams, ten scans a second, no safety device, at most 0.3 m/s.
    RplidarA,
    /// RPLidar S1 to S3: 720 beams, ten scans a second, no safety device, at most 0.3 m/s.
    RplidarS,
    /// Any scanner behind a bridge: 1,440 beams, ten scans a second, no safety device, at most 0.3 m/s.
    Bridged,
}

impl FittedScanner {
    /// The model.
    #[must_use]
    pub const fn model(self) -> ScannerModel {
        let model = match self {
            Self::S300 => return ScannerModel::S300,
            Self::Microscan3 => return ScannerModel::MicroScan3 { beams: SCAN_BEAMS_MAX as u16 },
            Self::HokuyoUst => RangingModel::HokuyoUst,
            Self::HokuyoUrg04lx => RangingModel::HokuyoUrg04lx,
            Self::SickTim5xx => RangingModel::SickTim5xx,
            Self::SickLms1xx => RangingModel::SickLms1xx,
            Self::RplidarA => RangingModel::RplidarA,
            Self::RplidarS => RangingModel::RplidarS,
            Self::Bridged => RangingModel::Bridged(BRIDGED_EXAMPLE),
        };
        ScannerModel::Ranging(model)
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
    /// Any lidar of 16 rings behind a bridge.
    Columns,
    /// Livox Mid-360, on its head.
    LivoxMid360,
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
            Self::Columns => Some(bridged_keys()),
            Self::LivoxMid360 => Some(livox_keys()),
        }
    }
}

/// Which inertial sensor the simulated robot carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FittedImu {
    /// Xsens MTi.
    #[default]
    XsensMti,
    /// VectorNav VN-100.
    #[value(name = "vectornav")]
    VectorNav,
    /// Any sensor behind a bridge, on a line.
    Bridged,
}

impl FittedImu {
    /// The sensor in the robot's file.
    #[must_use]
    pub const fn model(self) -> ImuModel {
        match self {
            Self::XsensMti => ImuModel::XsensMti,
            Self::VectorNav => ImuModel::VectorNav,
            Self::Bridged => ImuModel::Bridged,
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
