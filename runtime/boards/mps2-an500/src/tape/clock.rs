//! The `embassy-time` driver of virtual time: it shows what the tape says.

use core::cell::RefCell;
use core::task::Waker;

use critical_section::Mutex;
use embassy_time_driver::Driver;
use heapless::Vec;

/// Timers armed at once: one per task that waits, and reserve.
const TIMERS_MAX: usize = 24;

struct State {
    now_us: u64,
    timers: Vec<(u64, Waker), TIMERS_MAX>,
}

struct VirtualClock(Mutex<RefCell<State>>);

embassy_time_driver::time_driver_impl!(
    static CLOCK: VirtualClock =
        VirtualClock(Mutex::new(RefCell::new(State { now_us: 0, timers: Vec::new() })))
);

impl Driver for VirtualClock {
    fn now(&self) -> u64 {
        critical_section::with(|token| self.0.borrow_ref(token).now_us)
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|token| {
            let timers = &mut self.0.borrow_ref_mut(token).timers;
            if !timers.iter().any(|(when, armed)| *when == at && armed.will_wake(waker)) {
                assert!(timers.push((at, waker.clone())).is_ok(), "more than {TIMERS_MAX} timers");
            }
        });
    }
}

/// Moves the clock and wakes what is due.
pub fn advance(to_us: u64) {
    critical_section::with(|token| {
        let state = &mut *CLOCK.0.borrow_ref_mut(token);
        state.now_us = state.now_us.max(to_us);
        let now_us = state.now_us;
        state.timers.retain(|(at, waker)| {
            let due = *at <= now_us;
            if due {
                waker.wake_by_ref();
            }
            !due
        });
    });
}

/// When the next timer is due.
pub fn next_timer_us() -> Option<u64> {
    critical_section::with(|token| CLOCK.0.borrow_ref(token).timers.iter().map(|(at, _)| *at).min())
}
