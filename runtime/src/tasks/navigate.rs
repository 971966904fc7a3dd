//! Runs navigation to a goal: collects its inputs and publishes its requested velocity.
//!
//! Navigation is a value behind a trait, as a cleaning mission is: the maps of a hosted robot are larger than those of a board.
//! The guard permits or refuses each request.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker};
use floorguard_guard::Decision;
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::Scan;
use floorguard_types::time::Stamp;

use crate::clock;
use crate::shared::{PeopleReport, Shared, StampedPose};

/// How often the requested velocity is renewed: the guard takes one of 200 ms for stale.
const PERIOD_MS: u64 = 50;

/// What navigation learns at a moment.
#[derive(Clone, Copy, Debug)]
pub struct NavigationMoment<'a> {
    /// Now.
    pub now: Stamp,
    /// Where the robot is, in the odometry frame.
    pub pose: StampedPose,
    /// The newest scan, if navigation has not seen it.
    pub scan: Option<&'a Scan>,
    /// What the guard permits now.
    pub decision: Option<Decision>,
    /// The newest list of people, if navigation has not seen it.
    pub people: Option<&'a PeopleReport>,
    /// The operator has paused the robot.
    pub is_paused: bool,
}

/// Drives a robot to a goal.
pub trait Navigation {
    /// Takes in a moment and gives the requested velocity.
    fn step(&mut self, moment: &NavigationMoment<'_>) -> Twist2;
}

/// Perception ring. Runs for ever; requests to stand when the goal is reached or the operator pauses.
pub async fn navigate<M: RawMutex>(shared: &Shared<M>, navigation: &mut impl Navigation) {
    let mut ticker = Ticker::every(Duration::from_millis(PERIOD_MS));
    let (mut seen_scan, mut seen_people) = (0, 0);
    loop {
        ticker.next().await;
        let Some(pose) = shared.pose.get() else { continue };
        let scan = shared.scan.unseen(&mut seen_scan);
        let people = shared.people.unseen(&mut seen_people);
        let moment = NavigationMoment {
            now: clock::now(),
            pose,
            scan: scan.as_ref(),
            decision: shared.decision.get(),
            people: people.as_ref(),
            is_paused: shared.is_paused(),
        };
        let requested = navigation.step(&moment);
        let wanted = if moment.is_paused { Twist2::ZERO } else { requested };
        shared.wanted.publish((clock::now(), wanted));
    }
}
