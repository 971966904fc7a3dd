//! The 10 ms tick: time itself is evidence (FG-REQ-007).

use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker};

use crate::clock;
use crate::shared::{RobotStatus, Shared};

/// The guard's tick.
pub const TICK_MS: u64 = 10;
/// A status every tenth tick.
const TICKS_PER_STATUS: u32 = 10;

/// Guard ring. Runs for ever.
pub async fn supervise<M: RawMutex>(shared: &Shared<M>) {
    let mut ticker = Ticker::every(Duration::from_millis(TICK_MS));
    let mut ticks = 0_u32;
    loop {
        ticker.next().await;
        let decision = shared.decide(|guard| guard.tick(clock::now()));
        ticks = ticks.wrapping_add(1);
        if ticks.is_multiple_of(TICKS_PER_STATUS) {
            let (sources, resets) = shared.inspect(|guard| (guard.health(), guard.resets()));
            let pose = shared.pose.get().unwrap_or_default();
            shared.status.publish(RobotStatus { decision, sources, pose, resets });
        }
    }
}
