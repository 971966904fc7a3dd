//! Scanners that are no safety devices: what each model measures, and its driver.

use floorguard_drivers::ranging::{
    AnyRangingScanner, Bridged, Cola, Hokuyo, LMS1XX, RPLIDAR_A, RPLIDAR_S, Rplidar, TIM5XX, URG_04LX_FULL,
    UST_FULL,
};
use floorguard_drivers::scan_link::ScanShape;

/// The guard counts on so many scans until it stops: two that must agree, one that is not in step, one that may be lost.
const COUNTED_SCANS: f32 = 4.0;
/// Of those, so many pass before the newest scan is late: one that is not in step, and one that may be lost.
const LATE_SCANS: f32 = 2.0;
/// It counts on those of a safety scanner, seconds each.
const COUNTED_SCAN_S: f32 = 0.04;

/// Which scanner that is no safety device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangingModel {
    /// Hokuyo UST-10LX or UST-20LX, over TCP.
    HokuyoUst,
    /// Hokuyo URG-04LX, over USB or a serial line.
    HokuyoUrg04lx,
    /// SICK TiM551, TiM561 or TiM571, over TCP.
    SickTim5xx,
    /// SICK LMS100 or LMS111 at 0.5°, over TCP.
    SickLms1xx,
    /// Slamtec RPLidar A1, A2, A3 or C1, over USB or a serial line.
    RplidarA,
    /// Slamtec RPLidar S1, S2 or S3, over USB or a serial line.
    RplidarS,
    /// Any scanner behind a bridge: what its scans are, the robot's file says.
    Bridged(ScanShape),
}

/// What its scans are, as the robot asks for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangingGeometry {
    /// Beams of a scan.
    pub beams: u16,
    /// Angle of the first one, degrees, counter-clockwise from straight ahead.
    pub first_deg: f32,
    /// From beam to beam, degrees.
    pub step_deg: f32,
    /// From scan to scan, seconds.
    pub period_s: f32,
    /// What is nearer or farther is not measured, metres.
    pub range_m: [f32; 2],
}

impl RangingModel {
    /// Its driver.
    #[must_use]
    pub fn driver(self) -> AnyRangingScanner {
        match self {
            Self::HokuyoUst => AnyRangingScanner::Hokuyo(Hokuyo::new(UST_FULL)),
            Self::HokuyoUrg04lx => AnyRangingScanner::Hokuyo(Hokuyo::new(URG_04LX_FULL)),
            Self::SickTim5xx => AnyRangingScanner::Cola(Cola::new(TIM5XX)),
            Self::SickLms1xx => AnyRangingScanner::Cola(Cola::new(LMS1XX)),
            Self::RplidarA => AnyRangingScanner::Rplidar(Rplidar::new(RPLIDAR_A)),
            Self::RplidarS => AnyRangingScanner::Rplidar(Rplidar::new(RPLIDAR_S)),
            Self::Bridged(shape) => AnyRangingScanner::Bridged(Bridged::new(shape)),
        }
    }

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::HokuyoUst => "Hokuyo UST",
            Self::HokuyoUrg04lx => "Hokuyo URG-04LX",
            Self::SickTim5xx => "SICK TiM5xx",
            Self::SickLms1xx => "SICK LMS1xx",
            Self::RplidarA => "RPLidar A",
            Self::RplidarS => "RPLidar S",
            Self::Bridged(_) => "scanner behind a bridge",
        }
    }

    /// Its name in a robot's file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::HokuyoUst => "hokuyo-ust",
            Self::HokuyoUrg04lx => "hokuyo-urg-04lx",
            Self::SickTim5xx => "sick-tim5xx",
            Self::SickLms1xx => "sick-lms1xx",
            Self::RplidarA => "rplidar-a",
            Self::RplidarS => "rplidar-s",
            Self::Bridged(_) => "bridged",
        }
    }

    /// What its scans are (book, Ranging scanners).
    #[must_use]
    pub fn geometry(self) -> RangingGeometry {
        match self {
            Self::HokuyoUst => RangingGeometry {
                beams: 1_081,
                first_deg: -135.0,
                step_deg: 0.25,
                period_s: 0.025,
                range_m: [0.06, 30.0],
            },
            // Steps 44 to 725 of 1,024, of which 384 looks to the front.
            Self::HokuyoUrg04lx => RangingGeometry {
                beams: 682,
                first_deg: -340.0 * 360.0 / 1_024.0,
                step_deg: 360.0 / 1_024.0,
                period_s: 0.1,
                range_m: [0.06, 4.0],
            },
            Self::SickTim5xx => RangingGeometry {
                beams: 811,
                first_deg: -135.0,
                step_deg: 0.333_3,
                period_s: 1.0 / 15.0,
                range_m: [0.05, 25.0],
            },
            Self::SickLms1xx => RangingGeometry {
                beams: 541,
                first_deg: -135.0,
                step_deg: 0.5,
                period_s: 0.02,
                range_m: [0.5, 20.0],
            },
            // The slowest motor with which scans come in time; even beams of our own.
            Self::RplidarA => RangingGeometry {
                beams: 300,
                first_deg: -180.0,
                step_deg: 1.2,
                period_s: 0.14,
                range_m: [0.15, 12.0],
            },
            Self::RplidarS => RangingGeometry {
                beams: 720,
                first_deg: -180.0,
                step_deg: 0.5,
                period_s: 0.125,
                range_m: [0.05, 30.0],
            },
            Self::Bridged(shape) => RangingGeometry {
                beams: shape.beams,
                first_deg: (f64::from(shape.first_udeg) * 1.0e-6) as f32,
                step_deg: (f64::from(shape.step_udeg) * 1.0e-6) as f32,
                period_s: shape.period_us as f32 * 1.0e-6,
                range_m: shape.range_mm.map(|range_mm| f32::from(range_mm) * 1.0e-3),
            },
        }
    }

    /// It sends datagrams by itself, and is not asked.
    #[must_use]
    pub const fn sends_datagrams(self) -> bool {
        matches!(self, Self::Bridged(_))
    }

    /// The robot stands so much later than behind a safety scanner, because its scans come more slowly, seconds.
    #[must_use]
    pub fn later_s(self) -> f32 {
        COUNTED_SCANS * (self.geometry().period_s - COUNTED_SCAN_S).max(0.0)
    }
    /// The newest scan may be so much older than that of a safety scanner before it is late, and before the robot stops, microseconds:
    /// less than the fields allow for.
    #[must_use]
    pub fn older_us(self) -> u64 {
        (LATE_SCANS * (self.geometry().period_s - COUNTED_SCAN_S).max(0.0) * 1.0e6) as u64
    }
}
