//! A ring's thread in the real world: poll what is ready, sleep in epoll until an event, a timer or the bell.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use embassy_time_driver::now;
use rustix::event::{EventfdFlags, eventfd};

use super::clock::{next_timer_us, use_real_clock, wake_due_timers};
use super::reactor::{Source, wait};
use super::task_set::TaskSet;

/// The longest sleep: how late a stop request is noticed when nothing else happens.
const SLEEP_MAX: Duration = Duration::from_millis(100);

/// Asks loops on any thread to end.
#[derive(Clone, Debug, Default)]
pub struct StopFlag(Arc<AtomicBool>);

impl StopFlag {
    /// Ends all loops that hold a clone.
    pub fn stop(&self) {
        self.0.store(true, Ordering::Release);
    }

    /// Somebody asked to end.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}

/// Runs tasks on this thread in real time until the flag is set. `spawn` builds the tasks here, because sources
/// belong to the thread that made them.
///
/// # Errors
/// The carriers could not be opened, a task spins, or epoll failed.
pub fn run_until<'a>(
    flag: &StopFlag,
    spawn: impl FnOnce(&mut TaskSet<'a>) -> io::Result<()>,
) -> io::Result<()> {
    use_real_clock();
    let bell = eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?;
    let heard = Source::new(bell.try_clone()?)?;
    let mut tasks = TaskSet::with_bell(Some(bell));
    spawn(&mut tasks)?;
    while !flag.is_stopped() {
        wake_due_timers();
        tasks.poll_until_quiet().map_err(io::Error::other)?;
        // Empty the bell before looking at the ready bits once more: a ring after this look ends the sleep.
        let _ = rustix::io::read(&heard.file, &mut [0u8; 8]);
        if tasks.is_ready() {
            continue;
        }
        let until_timer = next_timer_us().map(|at| Duration::from_micros(at.saturating_sub(now())));
        wait(Some(until_timer.unwrap_or(SLEEP_MAX).min(SLEEP_MAX)))?;
    }
    Ok(())
}
