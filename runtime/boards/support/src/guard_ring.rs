//! The tasks of the guard ring that need no device. One thin wrapper per task.

use embassy_executor::Spawner;
use embassy_time::{Duration, Ticker};
use floorguard_runtime::tasks::{advice_input, command_input, operator_input, supervise};

use crate::RobotShared;

/// How often the watchdog is fed: several times within its patience of 100 ms.
pub const FEED_EVERY: Duration = Duration::from_millis(20);

/// Starts the tasks that decide, on the executor of the guard.
pub fn spawn_deciders(spawner: Spawner, shared: &'static RobotShared) {
    // Each has a place for one, and this is called once.
    spawner.spawn(supervisor(shared).unwrap());
    spawner.spawn(command(shared).unwrap());
    spawner.spawn(advice(shared).unwrap());
    spawner.spawn(operator(shared).unwrap());
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
