//! A handful of futures, polled in a fixed order when they are ready.
//!
//! Ready tasks are polled lowest index first, round after round, until none is ready: the same events give the same
//! order of polls on every run and every machine. Wakers may be used from any thread; a task set with a bell rings it
//! so that its sleeping thread notices.

use std::os::fd::OwnedFd;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::{Context, Wake, Waker};

use super::clock::{hold_real_clock, release_real_clock};

/// Tasks of a set; one bit each in the ready word.
const TASKS_MAX: usize = 64;
/// Polls without the clock moving after which something spins instead of waiting.
const POLLS_WITHOUT_PROGRESS_MAX: usize = 1_000_000;

/// A task keeps waking itself without waiting for anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("task {task} keeps waking itself: {POLLS_WITHOUT_PROGRESS_MAX} polls without the clock moving")]
pub struct SpinningTask {
    /// Index of the task, in the order of spawning.
    pub task: usize,
}

struct Readiness {
    bits: AtomicU64,
    bell: Option<OwnedFd>,
}

struct TaskWaker {
    bit: u64,
    readiness: Arc<Readiness>,
}

impl Wake for TaskWaker {
    fn wake(self: Arc<Self>) {
        self.wake_by_ref();
    }

    fn wake_by_ref(self: &Arc<Self>) {
        let before = self.readiness.bits.fetch_or(self.bit, Ordering::AcqRel);
        if before == 0
            && let Some(bell) = &self.readiness.bell
        {
            // A full eventfd counter has been rung already.
            let _ = rustix::io::write(bell, &1u64.to_ne_bytes());
        }
    }
}

struct Task<'a> {
    future: Option<Pin<Box<dyn Future<Output = ()> + 'a>>>,
    waker: Waker,
}

/// Futures of one thread.
pub struct TaskSet<'a> {
    tasks: Vec<Task<'a>>,
    readiness: Arc<Readiness>,
}

impl<'a> TaskSet<'a> {
    /// An empty set whose thread never sleeps while it may be woken (virtual time).
    #[must_use]
    pub fn new() -> Self {
        Self::with_bell(None)
    }

    /// An empty set that writes to an eventfd when a task becomes ready.
    #[must_use]
    pub fn with_bell(bell: Option<OwnedFd>) -> Self {
        Self { tasks: Vec::new(), readiness: Arc::new(Readiness { bits: AtomicU64::new(0), bell }) }
    }

    /// Adds a task; it is polled for the first time by the next [`Self::poll_until_quiet`].
    ///
    /// # Panics
    /// With more than 64 tasks, which is a mistake in the program.
    pub fn spawn(&mut self, future: impl Future<Output = ()> + 'a) {
        let index = self.tasks.len();
        assert!(index < TASKS_MAX, "a task set holds at most {TASKS_MAX} tasks");
        let task_waker = TaskWaker { bit: 1 << index, readiness: Arc::clone(&self.readiness) };
        let waker = Waker::from(Arc::new(task_waker));
        waker.wake_by_ref();
        self.tasks.push(Task { future: Some(Box::pin(future)), waker });
    }

    /// Polls ready tasks until none is ready. Gives the number of polls.
    ///
    /// # Errors
    /// [`SpinningTask`] when a task spins.
    pub fn poll_until_quiet(&mut self) -> Result<usize, SpinningTask> {
        self.poll_until_quiet_if(|_| true)
    }

    /// As [`Self::poll_until_quiet`], but only the tasks that run now; the others stay ready.
    ///
    /// # Errors
    /// [`SpinningTask`] when a task spins.
    pub fn poll_until_quiet_if(&mut self, runs: impl Fn(usize) -> bool) -> Result<usize, SpinningTask> {
        let running = (0..self.tasks.len()).filter(|task| runs(*task)).fold(0, |bits, task| bits | 1 << task);
        let mut polls = 0;
        loop {
            let before = polls;
            for index in self.poll_ready(running) {
                polls += 1;
                if polls > POLLS_WITHOUT_PROGRESS_MAX {
                    return Err(SpinningTask { task: index });
                }
            }
            if polls == before {
                return Ok(polls);
            }
        }
    }

    /// Polls each task that is ready now once: one that wakes itself again has to wait for the next round.
    pub fn poll_round(&mut self) {
        self.poll_ready(u64::MAX).for_each(drop);
    }

    /// As [`Self::poll_round`] in real time, with the clock held during each poll; `observe` gets the task and the time of
    /// each poll after it.
    pub fn poll_round_observed(&mut self, observe: &mut dyn FnMut(usize, u64)) {
        let ready = self.readiness.bits.swap(0, Ordering::AcqRel);
        for (index, task) in self.tasks.iter_mut().enumerate() {
            if ready & (1 << index) == 0 {
                continue;
            }
            let now_us = hold_real_clock();
            task.poll();
            observe(index, now_us);
            release_real_clock();
        }
    }

    /// Polls one task, whether it is ready or not: a recorded order of polls is repeated so. A task that does not exist, or
    /// has ended, is left out.
    pub fn poll_one(&mut self, index: usize) {
        if let Some(task) = self.tasks.get_mut(index) {
            task.poll();
        }
    }

    /// Polls, one by one, those of some tasks that are ready now, and says which.
    fn poll_ready(&mut self, some: u64) -> impl Iterator<Item = usize> {
        let ready = self.readiness.bits.fetch_and(!some, Ordering::AcqRel) & some;
        let tasks = self.tasks.iter_mut().enumerate().filter(move |(index, _)| ready & (1 << index) != 0);
        tasks.map(|(index, task)| {
            task.poll();
            index
        })
    }

    /// Tasks spawned so far.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tasks.len()
    }

    /// No task was spawned.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tasks.is_empty()
    }

    /// Something is ready to be polled.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.readiness.bits.load(Ordering::Acquire) != 0
    }
}

impl Default for TaskSet<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl Task<'_> {
    fn poll(&mut self) {
        if let Some(future) = &mut self.future
            && future.as_mut().poll(&mut Context::from_waker(&self.waker)).is_ready()
        {
            self.future = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_futures::yield_now;
    use std::cell::RefCell;

    #[test]
    fn tasks_take_turns_in_the_order_of_spawning() {
        let log = RefCell::new(Vec::new());
        let log = &log;
        let mut tasks = TaskSet::new();
        for name in ["guard", "perception"] {
            tasks.spawn(async move {
                for step in 0..2 {
                    log.borrow_mut().push((name, step));
                    yield_now().await;
                }
            });
        }
        tasks.poll_until_quiet().unwrap();
        assert_eq!(*log.borrow(), [("guard", 0), ("perception", 0), ("guard", 1), ("perception", 1)]);
    }

    #[test]
    fn spinning_task_is_an_error() {
        let mut tasks = TaskSet::new();
        tasks.spawn(async {
            loop {
                yield_now().await;
            }
        });
        assert_eq!(tasks.poll_until_quiet(), Err(SpinningTask { task: 0 }));
    }
}
