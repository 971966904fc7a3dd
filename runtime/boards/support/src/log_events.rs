//! What happens, in words, on the board's log: every stop with its cause, every change of the guard's state.

use embassy_time::{Duration, Ticker};

use crate::RobotShared;

/// How often the guard is examined: text is rare, and what matters is in the black box.
const POLL_PERIOD: Duration = Duration::from_millis(100);

/// Runs for ever, on the ring of perception: words never delay a decision.
pub async fn log_decisions(shared: &RobotShared) {
    let mut ticker = Ticker::every(POLL_PERIOD);
    let (mut state, mut lost) = (None, 0);
    loop {
        ticker.next().await;
        while let Some(stop) = shared.stops.try_pop() {
            let at_ms = stop.stamp.as_micros() / 1_000;
            defmt::warn!("stop at {} ms: {}, {} m/s", at_ms, stop.cause.cause, stop.speed_mps);
        }
        let now = shared.decision.get().map(|decision| decision.state);
        if state != now {
            state = now;
            defmt::info!("guard: {}", now);
        }
        if shared.packets.lost() != lost {
            lost = shared.packets.lost();
            defmt::warn!("perception was late for {} lidar packets so far", lost);
        }
    }
}
