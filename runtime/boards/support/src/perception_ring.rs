//! Everything that sees and plans, on the thread executor.

use core::mem::MaybeUninit;

use embassy_executor::Spawner;
use floorguard_localisation::odometry::PoseHistory;
use floorguard_perception::legs::PeopleByLegs;
use floorguard_perception::people::{PeoplePipeline, RingAngles};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::mission::RouteFollower;
use floorguard_runtime::tasks::{NoMotion, PerceptionState, drive_route, perceive};
use floorguard_types::geometry::Transform3;
use floorguard_types::sensing::{Scan, Sweep};
use static_cell::StaticCell;

use crate::RobotShared;

/// Starts the ring. Call once.
pub fn start_perception_ring(
    spawner: Spawner,
    shared: &'static RobotShared,
    robot: &'static RobotConfiguration,
) {
    static STATE: StaticCell<PerceptionState> = StaticCell::new();
    let mountings = [robot.lidar.mounting.transform(), robot.scanner.mounting.transform()];
    let state = fresh_perception(STATE.uninit(), mountings);
    spawner.spawn(perception(shared, state).unwrap());
    spawner.spawn(mission(shared, RouteFollower::new(robot.route.clone(), robot.route_limits)).unwrap());
}

/// Builds the state where it stays, with the mountings of lidar and safety scanner, field by field: as a whole it would pass over the stack.
pub fn fresh_perception(
    slot: &'static mut MaybeUninit<PerceptionState>,
    [sensor_in_base, scanner_in_base]: [Transform3; 2],
) -> &'static mut PerceptionState {
    const PEOPLE: PeoplePipeline = PeoplePipeline::new(RingAngles::NONE);
    // Nothing but zeros, which take no space in the program; the first packet brings the unit.
    const BUILDING: Sweep = Sweep { range_unit_mm: 0, ..Sweep::EMPTY };
    const LEGS: PeopleByLegs = PeopleByLegs::new();
    const SCAN: Scan = Scan::EMPTY;
    const HISTORY: PoseHistory = PoseHistory::new();
    let state = slot.as_mut_ptr();
    // SAFETY: the pointer is that of the slot; each field is written once, and then all are.
    let state = unsafe {
        (&raw mut (*state).building).write(BUILDING);
        (&raw mut (*state).people).write(PEOPLE);
        (&raw mut (*state).motion).write(NoMotion);
        (&raw mut (*state).legs).write(LEGS);
        (&raw mut (*state).scan).write(SCAN);
        (&raw mut (*state).history).write(HISTORY);
        (&raw mut (*state).sensor_in_base).write(sensor_in_base);
        (&raw mut (*state).scanner_in_base).write(scanner_in_base.on_floor());
        &mut *state
    };
    state.people.angles = RingAngles::vlp16();
    state
}

/// A field that is new, and that [`fresh_perception`] would leave unwritten, does not compile here.
fn _all_fields_are_written(state: &PerceptionState) {
    let PerceptionState {
        building: _,
        people: _,
        motion: NoMotion,
        legs: _,
        scan: _,
        history: _,
        sensor_in_base: _,
        scanner_in_base: _,
    } = state;
}

#[embassy_executor::task]
async fn perception(shared: &'static RobotShared, state: &'static mut PerceptionState) {
    perceive(shared, state).await;
}

#[embassy_executor::task]
async fn mission(shared: &'static RobotShared, follower: RouteFollower) {
    drive_route(shared, follower).await;
}
