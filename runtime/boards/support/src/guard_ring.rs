//! The tasks of the guard ring that need no device. One thin wrapper per task.

use embassy_executor::Spawner;
use embassy_time::{Duration, Ticker};
use floorguard_runtime::clock;
use floorguard_runtime::kept_latches::KeptLatches;
use floorguard_runtime::tasks::{advice_input, command_input, operator_input, supervise};

use crate::RobotShared;

/// How often the watchdog is fed: several times within its patience of 100 ms.
pub const FEED_EVERY: Duration = Duration::from_millis(20);

/// How often what is latched is copied into kept memory: what is younger dies with the machine.
const KEEP_EVERY: Duration = Duration::from_millis(5);

/// Starts the tasks that decide, on the executor of the guard; what was latched before the reset is latched again.
pub fn spawn_deciders(spawner: Spawner, shared: &'static RobotShared, kept: &'static KeptLatches) {
    shared.restore_latches(kept.begin(), clock::now());
    // Each has a place for one, and this is called once.
    spawner.spawn(supervisor(shared).unwrap());
    spawner.spawn(command(shared).unwrap());
    spawner.spawn(advice(shared).unwrap());
    spawner.spawn(operator(shared).unwrap());
    spawner.spawn(keep_latches(shared, kept).unwrap());
}

/// Calls `feed` for as long as the guard decides. Runs for ever.
pub async fn feed_while_deciding(shared: &RobotShared, mut feed: impl FnMut()) {
    let mut ticker = Ticker::every(FEED_EVERY);
    let mut seen = shared.decision.published();
    loop {
        ticker.next().await;
        let decided = shared.decision.published();
        if decided != seen {
            feed();
        }
        seen = decided;
    }
}

#[embassy_executor::task]
async fn keep_latches(shared: &'static RobotShared, kept: &'static KeptLatches) {
    let mut ticker = Ticker::every(KEEP_EVERY);
    loop {
        ticker.next().await;
        if let Some(latches) = shared.latches.get() {
            kept.keep(latches);
        }
    }
}

#[embassy_executor::task]
async fn supervisor(shared: &'static RobotShared) {
    supervise(shared).await;
}

#[embassy_executor::task]
async fn command(shared: &'static RobotShared) {
    command_input(shared).await;
}

#[embassy_executor::task]
async fn advice(shared: &'static RobotShared) {
    advice_input(shared).await;
}

#[embassy_executor::task]
async fn operator(shared: &'static RobotShared) {
    operator_input(shared).await;
}
