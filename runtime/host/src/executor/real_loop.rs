//! A ring's thread in the real world: poll what is ready, sleep in epoll until an event, a timer or the bell.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use embassy_time_driver::now;
use rustix::event::{EventfdFlags, eventfd};

use super::clock::{next_timer_us, use_real_clock, wake_due_timers};
use super::lateness::Lateness;
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
/// belong to the thread that made them. Each task that is ready is polled once a round, and a read gives way before it takes
/// anything ([`Source::read_ready`]): a device that never pauses takes turns with all other tasks, with the timers and with
/// what the kernel has to tell.
///
/// # Errors
/// The carriers could not be opened, or epoll failed.
pub fn run_until<'a>(
    flag: &StopFlag,
    spawn: impl FnOnce(&mut TaskSet<'a>) -> io::Result<()>,
) -> io::Result<()> {
    run_until_observed(flag, |tasks| spawn(tasks).map(|()| RingObserver::default()))
}

/// Gets the index of a task and the time of its poll, microseconds, after each poll.
pub type PollObserver<'a> = Box<dyn FnMut(usize, u64) + 'a>;

/// What is written down of a ring while it runs.
#[derive(Default)]
pub struct RingObserver<'a> {
    /// Each poll. Then the clock of this thread stands still during each poll.
    pub polls: Option<PollObserver<'a>>,
    /// How late its timers are answered.
    pub lateness: Option<Lateness>,
}

/// As [`run_until`]; `spawn` gives who observes the ring.
///
/// # Errors
/// As [`run_until`].
pub fn run_until_observed<'a, 'o>(
    flag: &StopFlag,
    spawn: impl FnOnce(&mut TaskSet<'a>) -> io::Result<RingObserver<'o>>,
) -> io::Result<()> {
    use_real_clock();
    let bell = eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?;
    let heard = Source::new(bell.try_clone()?)?;
    let mut tasks = TaskSet::with_bell(Some(bell));
    let RingObserver { mut polls, lateness } = spawn(&mut tasks)?;
    while !flag.is_stopped() {
        let due_us = wake_due_timers();
        match &mut polls {
            Some(observe) => tasks.poll_round_observed(observe),
            None => tasks.poll_round(),
        }
        if let (Some(due_us), Some(lateness)) = (due_us, &lateness) {
            lateness.note(now().saturating_sub(due_us));
        }
        // Empty the bell before looking at the ready bits once more: a ring after this look ends the sleep.
        let _ = rustix::io::read(&heard.file, &mut [0u8; 8]);
        let until_timer = next_timer_us().map(|at| Duration::from_micros(at.saturating_sub(now())));
        let sleep = if tasks.is_ready() { Duration::ZERO } else { until_timer.unwrap_or(SLEEP_MAX) };
        wait(sleep.min(SLEEP_MAX))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_futures::yield_now;
    use embassy_time::Timer;

    /// Ticks and bytes of a line for so many turns.
    fn run_turns(turns: usize) {
        let flag = StopFlag::default();
        let (here, there) = std::os::unix::net::UnixStream::pair().unwrap();
        here.set_nonblocking(true).unwrap();
        let ended = run_until_observed(&flag, |tasks| {
            let line = Source::new(here)?;
            tasks.spawn(async {
                for _ in 0..turns {
                    Timer::after_millis(1).await;
                    io::Write::write_all(&mut &there, b"!").unwrap();
                }
            });
            tasks.spawn(async {
                let line = line;
                for _ in 0..turns {
                    line.read_ready(|mut line| io::Read::read(&mut line, &mut [0; 1])).await.unwrap();
                }
                flag.stop();
            });
            Ok(RingObserver { polls: Some(Box::new(|_, _| {})), lateness: None })
        });
        assert!(ended.is_ok(), "{ended:?}");
    }

    /// What a ring needs it has from its start on: twenty times as many turns allocate as much as two.
    #[test]
    fn running_ring_allocates_nothing() {
        // The list of the thread's descriptors has grown before.
        (0..5).for_each(|_| run_turns(2));
        let used = |turns| allocation_counter::measure(|| run_turns(turns)).count_total;
        assert_eq!(used(2), used(40));
    }

    /// A device that never pauses keeps neither the tick of the guard nor the drives waiting.
    #[test]
    fn always_ready_task_takes_turns_with_timers() {
        let flag = StopFlag::default();
        let (here, there) = std::os::unix::net::UnixStream::pair().unwrap();
        here.set_nonblocking(true).unwrap();
        let ended = run_until(&flag, |tasks| {
            let line = Source::new(here)?;
            tasks.spawn(async {
                loop {
                    yield_now().await;
                }
            });
            tasks.spawn(async {
                for _ in 0..5 {
                    Timer::after_millis(10).await;
                }
                io::Write::write_all(&mut &there, b"!").unwrap();
            });
            tasks.spawn(async {
                let line = line;
                line.read_ready(|mut line| io::Read::read(&mut line, &mut [0; 1])).await.unwrap();
                flag.stop();
            });
            Ok(())
        });
        assert!(ended.is_ok(), "{ended:?}");
    }
}
