//! Back to where the robot was switched on: to a place before it by the map, then onto it by what the scanner saw there.

use floorguard_navigation::docking::{DockApproach, DockStep, DockingConfig};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::sensing::Scan;

use super::dock_sight::DockSight;
use super::drive::Navigator;
use super::progress::NavigationPhase;

/// The approach begins this far before the dock, metres.
const BEFORE_M: f32 = 1.0;
/// The robot has left its dock when it is farther away than this, metres.
const LEFT_M: f32 = 0.05;

/// Commands without a scan that shows the dock, ten a second: after so many the robot stands, …
const UNSEEN_STAND: u32 = 3;
/// … and after so many it gives up.
const UNSEEN_MAX: u32 = 100;

/// How far it is.
#[derive(Clone, Debug)]
enum Stage {
    /// On its way to the goal; the dock comes after that.
    Away,
    /// On its way to the place before the dock.
    Returning,
    /// On the last metre.
    Approaching(DockApproach),
    /// There.
    Docked,
    /// It cannot be met.
    Failed,
}

/// A drive that ends where it began.
pub(super) struct Docking {
    sight: DockSight,
    stage: Stage,
    config: DockingConfig,
}

impl Docking {
    pub(super) fn new(robot: &RobotConfiguration, scanner_in_base: Pose2) -> Self {
        let config = DockingConfig {
            reverse_mps: DockingConfig::DEFAULT.reverse_mps.min(robot.limits.reverse_mps),
            ..DockingConfig::DEFAULT
        };
        Self { sight: DockSight::new(scanner_in_base), stage: Stage::Away, config }
    }

    /// The robot stands to see its dock: at the beginning, and where something hides it at the end.
    pub(super) const fn is_looking(&self) -> bool {
        match self.stage {
            Stage::Away => !self.sight.is_known(),
            Stage::Approaching(_) => self.sight.unseen() > UNSEEN_STAND,
            _ => false,
        }
    }

    /// The dock was not met.
    pub(super) const fn has_failed(&self) -> bool {
        matches!(self.stage, Stage::Failed)
    }

    /// In one sentence, where there is one to say.
    pub(super) fn words(&self, odometry: Pose2) -> Option<String> {
        match &self.stage {
            Stage::Away => None,
            Stage::Returning => Some("drives back to where it began".to_owned()),
            Stage::Approaching(approach) => {
                let left_m = self.sight.robot_in_dock(odometry).map_or(0.0, |robot| -robot.x_m);
                let tries = approach.tries() + 1;
                Some(format!("docks where it began, try {tries}: {left_m:.2} m left"))
            }
            Stage::Docked => Some("docked where it began".to_owned()),
            Stage::Failed => {
                Some("cannot dock where it began: what its scanner sees there has changed".to_owned())
            }
        }
    }
}

impl Navigator {
    /// A scan: at the beginning it shows the dock, at the end the way to it.
    pub(super) fn see_dock(&mut self, scan: &Scan) {
        let odometry = self.senses.odometry_at(scan.stamp);
        let has_left = self.senses.distance_m > LEFT_M;
        let Some(docking) = &mut self.docking else { return };
        match docking.stage {
            Stage::Away if !has_left => docking.sight.learn(scan),
            Stage::Approaching(_) => docking.sight.see(scan, odometry),
            _ => {}
        }
    }

    /// The robot has still to look at its dock before it leaves it.
    pub(super) fn learns_dock(&self) -> bool {
        let learns = |docking: &Docking| matches!(docking.stage, Stage::Away) && !docking.sight.is_known();
        self.docking.as_ref().is_some_and(learns)
    }

    /// The robot stands at its goal, or before its dock: what comes next. False: the drive ends here.
    pub(super) fn goes_on_to_dock(&mut self, pose: Pose2) -> bool {
        let dock_in_map = self.plan.start_pose();
        let odometry = self.senses.motion().pose_in_odometry;
        let Some(docking) = &mut self.docking else { return false };
        match docking.stage {
            Stage::Away => {
                docking.stage = Stage::Returning;
                let before = dock_in_map.compose(Pose2::new(-BEFORE_M, 0.0, 0.0));
                self.plan.goal = [before.x_m, before.y_m, before.heading_rad];
                self.begin_anew(NavigationPhase::Starting);
                true
            }
            Stage::Returning => {
                let robot_in_dock = dock_in_map.inverse().compose(pose);
                let is_seen = docking.sight.begin(robot_in_dock, odometry);
                let approach = DockApproach::new(docking.config);
                docking.stage = if is_seen { Stage::Approaching(approach) } else { Stage::Failed };
                true
            }
            Stage::Approaching(_) | Stage::Docked | Stage::Failed => false,
        }
    }

    /// The command of the last metre; `None`: the robot is not on it.
    pub(super) fn dock(&mut self) -> Option<Twist2> {
        let odometry = self.senses.motion().pose_in_odometry;
        let docking = self.docking.as_mut()?;
        match &mut docking.stage {
            Stage::Approaching(approach) => {
                let robot_in_dock = docking.sight.robot_in_dock(odometry)?;
                let step = match docking.sight.pass_command() {
                    0..=UNSEEN_STAND => approach.step(robot_in_dock),
                    UNSEEN_MAX.. => DockStep::Failed,
                    // By the wheels alone nothing is met exactly.
                    _ => DockStep::Drive(Twist2::ZERO),
                };
                match step {
                    DockStep::Drive(twist) => return Some(twist),
                    DockStep::Docked => {
                        docking.stage = Stage::Docked;
                        self.phase = NavigationPhase::Reached;
                    }
                    DockStep::Failed => {
                        docking.stage = Stage::Failed;
                        self.phase = NavigationPhase::NeedsHelp;
                    }
                }
            }
            Stage::Docked => self.phase = NavigationPhase::Reached,
            Stage::Failed => self.phase = NavigationPhase::NeedsHelp,
            Stage::Away | Stage::Returning => return None,
        }
        Some(Twist2::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::super::parked_tests::navigator;
    use super::*;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_types::sensing::BeamReturn;

    /// A scan from the middle of a room of 4 by 3 m, so many times larger.
    fn room(scale: f32) -> Scan {
        let mut scan = Scan { first_angle_rad: -2.356, step_rad: 0.008_727, ..Scan::EMPTY };
        for beam in 0..541_u16 {
            let (sin, cos) = libm::sincosf(scan.first_angle_rad + f32::from(beam) * scan.step_rad);
            let range_m = scale * (2.0 / cos.abs().max(1.0e-6)).min(1.5 / sin.abs().max(1.0e-6));
            scan.beams.push(BeamReturn::Hit((range_m * 1_000.0) as u16)).expect("541 beams");
        }
        scan
    }

    /// On the last metre, and exactly at its dock as far as its wheels say.
    fn approaching(scale: f32) -> Navigator {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let dock = Pose2::new(4.0, 3.0, 0.0);
        let mut navigator = navigator(dock, Pose2::new(6.0, 3.0, 0.0));
        let mut docking = Docking::new(&robot, navigator.senses.scanner_in_base());
        (0..20).for_each(|_| docking.sight.learn(&room(1.0)));
        docking.stage = Stage::Returning;
        navigator.docking = Some(docking);
        assert!(navigator.goes_on_to_dock(dock));
        (0..10).for_each(|_| navigator.see_dock(&room(scale)));
        navigator
    }

    #[test]
    fn robot_at_its_dock_says_so() {
        let mut navigator = approaching(1.0);
        for _ in 0..100 {
            assert_eq!(navigator.dock(), Some(Twist2::ZERO));
            navigator.see_dock(&room(1.0));
        }
        assert_eq!(navigator.phase, NavigationPhase::Reached);
    }

    /// By its wheels alone it never says that it is there: it stands, and calls for help. Scans of another place are no better than none.
    #[test]
    fn dock_out_of_sight_is_never_claimed() {
        for scan in [None, Some(room(2.5))] {
            let mut navigator = approaching(1.0);
            for _ in 0..120 {
                assert_eq!(navigator.dock(), Some(Twist2::ZERO));
                assert_ne!(navigator.phase, NavigationPhase::Reached);
                scan.iter().for_each(|scan| navigator.see_dock(scan));
            }
            assert_eq!(navigator.phase, NavigationPhase::NeedsHelp);
            let docking = navigator.docking.expect("it docks");
            let words = docking.words(Pose2::default()).unwrap_or_default();
            assert!(docking.has_failed() && words.contains("cannot dock"), "{words}");
        }
    }
}
