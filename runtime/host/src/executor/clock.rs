//! The hosted `embassy-time` driver: a clock per thread, real or virtual.
//!
//! `embassy-time` knows one driver per program, but a campaign runs many simulations at once, each with its own time.
//! So the driver looks at the calling thread: a real clock reads the computer's monotonic clock from one common
//! epoch, a virtual one shows what the simulation set. Timers wait in a queue of the thread that armed them.

use std::cell::{Cell, RefCell};
use std::sync::OnceLock;
use std::task::Waker;
use std::time::Instant;

use embassy_time_driver::Driver;

thread_local! {
    /// Microseconds of the virtual clock, or none for the real one.
    static VIRTUAL_NOW_US: Cell<Option<u64>> = const { Cell::new(None) };
    /// Armed timers of this thread.
    static TIMERS: RefCell<Vec<(u64, Waker)>> = const { RefCell::new(Vec::new()) };
    /// Those that are due, kept for its memory: a ring that runs allocates none.
    static DUE: Cell<Vec<(u64, Waker)>> = const { Cell::new(Vec::new()) };
}

static EPOCH: OnceLock<Instant> = OnceLock::new();

struct ThreadClock;

impl Driver for ThreadClock {
    fn now(&self) -> u64 {
        VIRTUAL_NOW_US.get().unwrap_or_else(|| {
            // 584,000 years fit: the cast cannot lose anything.
            EPOCH.get_or_init(Instant::now).elapsed().as_micros() as u64
        })
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        TIMERS.with_borrow_mut(|timers| {
            match timers.iter_mut().find(|(when, armed)| *when == at && armed.will_wake(waker)) {
                Some(_) => {}
                None => timers.push((at, waker.clone())),
            }
        });
    }
}

embassy_time_driver::time_driver_impl!(static CLOCK: ThreadClock = ThreadClock);

/// This thread lives on the computer's monotonic clock from now on.
pub fn use_real_clock() {
    TIMERS.with_borrow_mut(Vec::clear);
    VIRTUAL_NOW_US.set(None);
}

/// This thread lives on a virtual clock that shows `start_us` and moves by [`advance_virtual`] only.
pub fn use_virtual_clock(start_us: u64) {
    TIMERS.with_borrow_mut(Vec::clear);
    VIRTUAL_NOW_US.set(Some(start_us));
}

/// Moves this thread's virtual clock to `to_us` (never backwards) and wakes the timers that are due.
pub fn advance_virtual(to_us: u64) {
    VIRTUAL_NOW_US.set(VIRTUAL_NOW_US.get().map(|now_us| now_us.max(to_us)));
    let _ = wake_due_timers();
}

/// Stops this thread's real clock for one poll of a task and gives the time that it shows meanwhile, microseconds: a task
/// then reads one time however often it looks, and a recording needs to keep only that one.
pub(super) fn hold_real_clock() -> u64 {
    VIRTUAL_NOW_US.set(None);
    let now_us = CLOCK.now();
    VIRTUAL_NOW_US.set(Some(now_us));
    now_us
}

/// The clock of this thread goes on.
pub(super) fn release_real_clock() {
    VIRTUAL_NOW_US.set(None);
}

/// When the next timer of this thread is due, microseconds.
pub fn next_timer_us() -> Option<u64> {
    TIMERS.with_borrow(|timers| timers.iter().map(|(at, _)| *at).min())
}

/// Wakes every timer of this thread that is due, earliest first, so that runs repeat exactly. Gives when the earliest one was
/// due, microseconds.
pub(super) fn wake_due_timers() -> Option<u64> {
    let now_us = CLOCK.now();
    let mut due = DUE.take();
    TIMERS.with_borrow_mut(|timers| due.extend(timers.extract_if(.., |(at, _)| *at <= now_us)));
    // Stable, and of so few without memory of its own.
    due.sort_by_key(|(at, _)| *at);
    let earliest_us = due.first().map(|(at, _)| *at);
    due.drain(..).for_each(|(_, waker)| waker.wake());
    DUE.set(due);
    earliest_us
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::TaskSet;
    use embassy_time::{Duration, Timer};

    #[test]
    fn timers_fire_only_when_virtual_clock_moves() {
        use_virtual_clock(1_000);
        let fired = Cell::new(0);
        let mut tasks = TaskSet::new();
        tasks.spawn(async {
            for _ in 0..3 {
                Timer::after(Duration::from_micros(500)).await;
                fired.set(fired.get() + 1);
            }
        });
        tasks.poll_until_quiet().unwrap();
        assert_eq!((fired.get(), next_timer_us()), (0, Some(1_500)));
        advance_virtual(1_499);
        tasks.poll_until_quiet().unwrap();
        assert_eq!(fired.get(), 0);
        advance_virtual(1_500);
        tasks.poll_until_quiet().unwrap();
        assert_eq!((fired.get(), next_timer_us()), (1, Some(2_000)));
        use_real_clock();
    }
}
