//! Everything that sees and plans, on the thread executor.

use embassy_executor::Spawner;
use floorguard_core::odometry::PoseHistory;
use floorguard_core::people::{PeoplePipeline, RingAngles};
use floorguard_core::sensing::Sweep;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::mission::RouteFollower;
use floorguard_runtime::tasks::{NoMotion, PerceptionState, drive_route, perceive};
use static_cell::StaticCell;

use super::RobotShared;
use super::options::Options;
use crate::faults::break_perception;

/// Starts the ring. Call once.
pub fn start_perception_ring(
    spawner: Spawner,
    shared: &'static RobotShared,
    (robot, options): (&'static RobotConfiguration, Options),
) {
    static STATE: StaticCell<PerceptionState> = StaticCell::new();
    let state = STATE.init_with(|| PerceptionState {
        building: Sweep::EMPTY,
        people: PeoplePipeline::new(RingAngles::vlp16()),
        motion: NoMotion,
        history: PoseHistory::new(),
        sensor_in_base: robot.lidar.mounting.transform(),
    });
    spawner.spawn(perception(shared, state).unwrap());
    spawner.spawn(mission(shared, RouteFollower::new(robot.route.clone(), robot.route_limits)).unwrap());
    if let Some(fault) = options.fault {
        spawner.spawn(break_perception(fault).unwrap());
    }
}

#[embassy_executor::task]
async fn perception(shared: &'static RobotShared, state: &'static mut PerceptionState) {
    perceive(shared, state).await;
}

#[embassy_executor::task]
async fn mission(shared: &'static RobotShared, follower: RouteFollower) {
    drive_route(shared, follower).await;
}
