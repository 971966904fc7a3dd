//! Following-error monitor: does the wheel slow down when commanded to? If not, the orders do not reach the drive,
//! however often they are sent.
//!
//! What is left then is the drive's own bus monitoring: commanded to leave operation, or without the master's
//! heartbeat, it stops by itself (CiA 402, object 6007h; FG-REQ-055).

use floorguard_types::time::{Age, Stamp};

/// A drive begins to follow an order within this time, microseconds.
const RESPONSE_US: u64 = 150_000;
/// Share of the configured ramp that a loaded drive reaches at least.
const RAMP_SHARE: f32 = 0.5;
/// Measuring noise and overshoot, m/s.
const MARGIN_MPS: f32 = 0.08;
/// Polls in a row that must show it.
const POLLS: u8 = 4;
/// Polls during which the bus stays without heartbeat: the drives' watch, the ramp from full speed, and some more.
const SILENT_POLLS: u16 = 200;
/// Seconds between two polls.
const POLL_S: f32 = 0.01;

/// Watches one drive.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FollowingErrorMonitor {
    /// What the wheel may still do, m/s.
    allowed_mps: f32,
    /// The order that was last tightened.
    tightened: Option<Stamp>,
    ordered_mps: f32,
    polls_in_error: u8,
    silent: u16,
    /// The wheel has reported: what it does from now on must follow the orders.
    heard: bool,
}

impl FollowingErrorMonitor {
    /// Every poll: what is ordered (0 for any stop), what the wheel reports if anything, and the configured ramp. True
    /// while the drive must be stopped by silence.
    pub fn watch(&mut self, ordered_mps: f32, reported_mps: Option<f32>, ramp_mps2: f32, now: Stamp) -> bool {
        self.silent = self.silent.saturating_sub(1);
        let Some(reported_mps) = reported_mps.map(libm::fabsf) else {
            *self = Self { silent: self.silent, ..Self::default() };
            return self.silent > 0;
        };
        if !self.heard {
            // A drive that turns when it is first heard was commanded by another master, and may take the ramp to
            // stop.
            *self = Self {
                heard: true,
                allowed_mps: reported_mps,
                tightened: Some(now),
                silent: self.silent,
                ..Self::default()
            };
        }
        let ordered_mps = libm::fabsf(ordered_mps);
        if ordered_mps < self.ordered_mps {
            self.tightened = Some(now);
        }
        self.ordered_mps = ordered_mps;
        let waits =
            self.tightened.is_some_and(|since| matches!(since.age(now), Age::Past(us) if us < RESPONSE_US));
        let slower_mps = if waits { 0.0 } else { ramp_mps2 * RAMP_SHARE * POLL_S };
        self.allowed_mps = ordered_mps.max(self.allowed_mps - slower_mps);
        let obeys = reported_mps <= self.allowed_mps + MARGIN_MPS;
        self.polls_in_error = if obeys { 0 } else { self.polls_in_error.saturating_add(1) };
        if self.polls_in_error >= POLLS {
            self.silent = SILENT_POLLS;
            self.polls_in_error = 0;
        }
        self.silent > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polls until silence, if any within two seconds, for a wheel that brakes with `brakes_mps2` from 0.8 m/s.
    fn silence_after(brakes_mps2: f32) -> Option<u64> {
        let mut watch = FollowingErrorMonitor::default();
        let mut now = Stamp::from_micros(1_000_000);
        for _ in 0..100 {
            assert!(!watch.watch(0.8, Some(0.8), 1.5, now));
            now = now.plus_micros(10_000);
        }
        let mut speed_mps = 0.8_f32;
        (0..200).find(|poll| {
            now = now.plus_micros(10_000);
            if *poll > 14 {
                speed_mps = (speed_mps - brakes_mps2 * 0.01).max(0.0);
            }
            watch.watch(0.0, Some(speed_mps), 1.5, now)
        })
    }

    #[test]
    fn unbraked_wheel_is_stopped_by_silence() {
        assert_eq!(silence_after(1.5), None);
        assert_eq!(silence_after(0.75), None);
        let polls = silence_after(0.0).expect("silence");
        assert!((20..35).contains(&polls), "{polls}");
    }

    #[test]
    fn unordered_start_is_stopped_and_silence_ends() {
        let mut watch = FollowingErrorMonitor::default();
        let now = Stamp::from_micros(1_000_000);
        assert!(!watch.watch(0.0, Some(0.0), 1.5, now));
        let silent = (0..10).filter(|_| watch.watch(0.0, Some(0.3), 1.5, now)).count();
        assert_eq!(silent, 7);
        // What says nothing any more cannot obey: the silence goes on for its time and no longer.
        assert_eq!((0..400).filter(|_| watch.watch(0.0, None, 1.5, now)).count(), 197);
    }

    #[test]
    fn initially_turning_drive_gets_half_the_ramp() {
        let mut watch = FollowingErrorMonitor::default();
        let mut speed_mps = 0.8_f32;
        let silent = (0..120_u64).any(|poll| {
            speed_mps = (speed_mps - if poll < 14 { 0.0 } else { 0.0075 }).max(0.0);
            watch.watch(0.0, Some(speed_mps), 1.5, Stamp::from_micros(1_000_000 + 10_000 * poll))
        });
        assert!(!silent);
    }

    #[test]
    fn missing_report_does_not_end_the_silence() {
        let mut watch = FollowingErrorMonitor::default();
        let now = Stamp::from_micros(1_000_000);
        let mut polls = 0;
        while !watch.watch(0.0, Some(if polls == 0 { 0.0 } else { 0.3 }), 1.5, now) {
            polls += 1;
            assert!(polls < 10, "never stopped");
        }
        assert!(watch.watch(0.0, None, 1.5, now));
        assert!(watch.watch(0.0, Some(0.0), 1.5, now));
    }

    #[test]
    fn initially_turning_drive_gets_the_ramp_time() {
        let mut watch = FollowingErrorMonitor::default();
        let mut now = Stamp::from_micros(1_000_000);
        let silent = |watch: &mut FollowingErrorMonitor, speed_mps: f32, now: &mut Stamp| {
            *now = now.plus_micros(10_000);
            watch.watch(0.0, Some(speed_mps), 1.5, *now)
        };
        assert!(!watch.watch(0.0, None, 1.5, now));
        assert!((0..80).all(|poll| !silent(&mut watch, 0.8 - 0.01 * poll as f32, &mut now)));
        let mut watch = FollowingErrorMonitor::default();
        assert!((0..60).any(|_| silent(&mut watch, 0.8, &mut now)));
    }
}
