//! What systemd hears of a run: that it is ready, that its guard decides, that it ends. Without systemd nothing is sent.

use std::time::{Duration, Instant};

use floorguard_types::time::Stamp;
use sd_notify::{NotifyState, notify};

/// Between two heartbeats. The unit file gives the guard two seconds.
const HEARTBEAT_PERIOD: Duration = Duration::from_millis(500);

/// The run as a service. A heartbeat goes out only after a new decision of the guard: where the guard ring hangs, systemd ends the
/// program, and the drives have stopped by their own supervision of it long before.
pub(super) struct Service {
    decided_at: Option<Stamp>,
    beaten_at: Option<Instant>,
}

impl Service {
    /// The devices' lines are open and the rings begin.
    pub(super) fn ready() -> Self {
        send(&[NotifyState::Ready, NotifyState::Status("sensors, guard and drives are watched")]);
        Self { decided_at: None, beaten_at: None }
    }

    /// The guard's newest decision, each time that it was looked at.
    pub(super) fn decided(&mut self, stamp: Stamp, now: Instant) {
        if self.is_due(stamp, now) {
            send(&[NotifyState::Watchdog]);
        }
    }

    /// Whether a decision is new and the last heartbeat old enough.
    fn is_due(&mut self, stamp: Stamp, now: Instant) -> bool {
        let is_new = self.decided_at.is_none_or(|before| stamp > before);
        let is_time = self.beaten_at.is_none_or(|before| now.duration_since(before) >= HEARTBEAT_PERIOD);
        if is_new && is_time {
            (self.decided_at, self.beaten_at) = (Some(stamp), Some(now));
        }
        is_new && is_time
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        send(&[NotifyState::Stopping]);
    }
}

/// A service manager that does not listen is no reason to end: it will end the robot itself if it misses a heartbeat.
fn send(states: &[NotifyState<'_>]) {
    let _ = notify(states);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_heartbeat_without_a_new_decision() {
        let mut service = Service { decided_at: None, beaten_at: None };
        let began = Instant::now();
        let after = |ms| began + Duration::from_millis(ms);
        assert!(service.is_due(Stamp::from_micros(10), after(0)));
        assert!(!service.is_due(Stamp::from_micros(20), after(100)), "too early");
        assert!(service.is_due(Stamp::from_micros(30), after(500)));
        for ms in [1_000, 2_000, 60_000] {
            assert!(!service.is_due(Stamp::from_micros(30), after(ms)), "the guard hangs");
        }
    }
}
