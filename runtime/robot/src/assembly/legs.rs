//! Who finds people by legs in the scans of the robot's scanner.

use floorguard_perception::any_scanner::{PeopleByAnyScanner, ScannerPose};
use floorguard_perception::legs::{Leg, PeopleByLegs};
use floorguard_perception::people::PeopleView;
use floorguard_runtime::configuration::{RobotConfiguration, ScannerModel};
use floorguard_runtime::tasks::FindPeopleByLegs;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::Scan;

use super::spawn::Stages;

/// The legs of one scanner, on a computer.
pub enum HostedLegs {
    /// Of an S300 near the floor, which the committee of the board was trained for.
    Trained(Box<PeopleByLegs>),
    /// Of any other scanner: the places around it are learned as it goes.
    Any(Box<PeopleByAnyScanner>),
}

impl HostedLegs {
    /// For an S300.
    #[must_use]
    pub fn trained() -> Self {
        Self::Trained(Box::default())
    }

    /// For any other scanner.
    #[must_use]
    pub fn any() -> Self {
        Self::Any(Box::default())
    }

    /// For the scanner of a robot; what runs on the board, too, runs as it does there.
    #[must_use]
    pub fn of_robot(robot: &RobotConfiguration, stages: Stages) -> Self {
        match (robot.scanner.model, stages) {
            (ScannerModel::S300, _) | (_, Stages::AsOnBoard) => Self::trained(),
            (ScannerModel::MicroScan3 { .. } | ScannerModel::Ranging(_), Stages::All) => Self::any(),
        }
    }

    /// Takes in a scan; positions come out in the frame of the scanner's pose.
    pub fn process(&mut self, scan: &Scan, pose: ScannerPose) -> &PeopleView {
        match (self, pose) {
            (
                Self::Trained(legs),
                ScannerPose::InFixedFrame(scanner) | ScannerPose::OnMovingRobot(scanner),
            ) => legs.process(scan, scanner, None::<fn(Point2) -> bool>),
            (Self::Any(legs), pose) => legs.process(scan, pose),
        }
    }

    /// The legs of the newest scan, in the frame of the people.
    #[must_use]
    pub fn legs(&self) -> &[Leg] {
        match self {
            Self::Trained(legs) => legs.legs(),
            Self::Any(legs) => legs.legs(),
        }
    }

    /// Segments of the newest scan that were examined.
    #[must_use]
    pub fn segments(&self) -> u32 {
        match self {
            Self::Trained(legs) => legs.segments,
            Self::Any(legs) => legs.segments,
        }
    }

    /// Legs left out because the list was full, since the start.
    #[must_use]
    pub fn dropped_legs(&self) -> u32 {
        match self {
            Self::Trained(legs) => legs.dropped_legs,
            Self::Any(legs) => legs.dropped_legs,
        }
    }
}

impl FindPeopleByLegs for HostedLegs {
    fn people(&mut self, scan: &Scan, sensor_in_odom: Pose2) -> &PeopleView {
        self.process(scan, ScannerPose::InFixedFrame(sensor_in_odom))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example robot has an S300; with a microScan3 it learns the places, except where it answers as the board does.
    #[test]
    fn scanner_decides_who_finds_legs() {
        let parsed = floorguard_configuration::parse("robot.toml", floorguard_configuration::EXAMPLE);
        let mut robot = parsed.expect("the example").robot;
        let is_any = |robot: &RobotConfiguration, stages| {
            matches!(HostedLegs::of_robot(robot, stages), HostedLegs::Any(_))
        };
        assert!(!is_any(&robot, Stages::All));
        robot.scanner.model = ScannerModel::MicroScan3 { beams: 2_751 };
        assert!(is_any(&robot, Stages::All) && !is_any(&robot, Stages::AsOnBoard));
    }
}
