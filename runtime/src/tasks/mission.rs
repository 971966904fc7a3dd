//! Runs what plans the robot's motion on a hosted robot, a cleaning mission or a drive to a goal: collects its inputs and
//! publishes its requested velocity.
//!
//! A mission is a value behind a trait, as the verdict on what moves is: the hosted robot has memory for a belief of
//! 500 particles and for maps, another board may have less. The guard permits or refuses each request.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker};
use floorguard_guard::{Decision, FloorSight};
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::{DirtReading, Scan};
use floorguard_types::time::Stamp;

use crate::clock;
use crate::shared::{PeopleReport, Shared, StampedPose};

/// How often the requested velocity is renewed: the guard takes one of 200 ms for stale.
const PERIOD_MS: u64 = 50;

/// What a mission learns at a moment.
#[derive(Clone, Copy, Debug)]
pub struct MissionMoment<'a> {
    /// Now.
    pub now: Stamp,
    /// Where the robot is, in the odometry frame.
    pub pose: StampedPose,
    /// The newest scan, if it is one that the mission has not seen.
    pub scan: Option<&'a Scan>,
    /// The newest message of the dirt sensor, seen or not.
    pub dirt: Option<DirtReading>,
    /// What the guard permits now.
    pub decision: Option<Decision>,
    /// The newest list of people, seen or not: its stamp says how old it is.
    pub people: Option<&'a PeopleReport>,
    /// What the floor camera sees, if it is a picture that the mission has not seen.
    pub floor: Option<&'a FloorSight>,
    /// The operator has paused the mission.
    pub is_paused: bool,
}

/// Drives a robot.
pub trait Mission {
    /// Takes in a moment and gives the requested velocity.
    fn step(&mut self, moment: &MissionMoment<'_>) -> Twist2;
}

/// Perception ring. Runs for ever; requests to stand when nothing is left to be done or the operator pauses.
pub async fn drive_mission<M: RawMutex>(shared: &Shared<M>, mission: &mut (impl Mission + ?Sized)) {
    let mut ticker = Ticker::every(Duration::from_millis(PERIOD_MS));
    let mut seen_scan = 0;
    let (mut seen_people, mut people) = (0, None);
    let mut seen_floor = 0;
    loop {
        ticker.next().await;
        let Some(pose) = shared.pose.get() else { continue };
        let scan = shared.scan.unseen(&mut seen_scan);
        people = shared.people.unseen(&mut seen_people).or(people);
        let floor = shared.floor.unseen(&mut seen_floor);
        let moment = MissionMoment {
            now: clock::now(),
            pose,
            scan: scan.as_ref(),
            dirt: shared.dirt.get(),
            decision: shared.decision.get(),
            people: people.as_ref(),
            floor: floor.as_ref(),
            is_paused: shared.is_paused(),
        };
        let requested = mission.step(&moment);
        let wanted = if moment.is_paused { Twist2::ZERO } else { requested };
        shared.wanted.publish((clock::now(), wanted));
    }
}
