//! Drives a route: what a mission is at its simplest.

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker};
use floorguard_types::geometry::Twist2;

use crate::clock;
use crate::mission::RouteFollower;
use crate::shared::Shared;

/// How often the requested velocity is renewed: the guard takes one of 200 ms for stale.
const PERIOD_MS: u64 = 50;

/// Perception ring. Runs for ever; requests to stand when the route has ended or the operator pauses.
pub async fn drive_route<M: RawMutex>(shared: &Shared<M>, mut follower: RouteFollower) {
    let mut ticker = Ticker::every(Duration::from_millis(PERIOD_MS));
    loop {
        ticker.next().await;
        if let Some(pose) = shared.pose.get() {
            let wanted =
                if shared.is_paused() { Twist2::ZERO } else { follower.wanted(pose.pose_in_odometry) };
            shared.wanted.publish((clock::now(), wanted));
        }
    }
}
