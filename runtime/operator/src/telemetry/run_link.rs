//! Programs outside that are shown how the robot is, and give orders: a fleet's master.

use std::sync::Arc;

use floorguard_robot::navigator::NavigationProgress;
use floorguard_runtime::shared::RobotStatus;
use floorguard_types::time::Stamp;

use crate::panel::Order;

/// The robot at a moment.
#[derive(Clone, Copy, Debug)]
pub struct LinkMoment<'a> {
    /// On the robot's clock.
    pub now: Stamp,
    /// Guard, sources and pose; none before the first decision.
    pub status: Option<&'a RobotStatus>,
    /// The drive, if there is one.
    pub drive: Option<&'a Arc<NavigationProgress>>,
}

/// A program outside. It is attended to on the telemetry thread, up to 200 times a second, and must not wait.
pub trait RunLink: Send {
    /// Shows the robot; gives the buttons that it presses.
    fn attend(&mut self, moment: &LinkMoment<'_>) -> Vec<Order>;

    /// It lives by the clock on the wall: a run in virtual time then goes no faster.
    fn keeps_wall_time(&self) -> bool {
        true
    }
}
