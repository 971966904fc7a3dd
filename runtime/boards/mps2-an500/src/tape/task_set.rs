//! A handful of futures, polled in a fixed order when they are ready: the same rule as the hosted task set, so that
//! the same events give the same order of polls.

use core::pin::Pin;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::{Context, RawWaker, RawWakerVTable, Waker};

/// One bit per task.
static READY: AtomicU32 = AtomicU32::new(0);

const VTABLE: RawWakerVTable = RawWakerVTable::new(|index| RawWaker::new(index, &VTABLE), wake, wake, |_| {});

fn wake(index: *const ()) {
    READY.fetch_or(1 << (index.addr() & 31), Ordering::AcqRel);
}

fn waker(index: usize) -> Waker {
    // SAFETY: the data of this waker is a number, not a pointer; its functions only read the number.
    unsafe { Waker::from_raw(RawWaker::new(core::ptr::without_provenance(index), &VTABLE)) }
}

/// Tasks in the order of their numbers.
pub struct TaskSet<'a, const N: usize> {
    tasks: [Pin<&'a mut dyn Future<Output = ()>>; N],
}

impl<'a, const N: usize> TaskSet<'a, N> {
    /// All are ready at first. Tasks run for ever.
    pub fn new(tasks: [Pin<&'a mut dyn Future<Output = ()>>; N]) -> Self {
        READY.store((1 << N) - 1, Ordering::Release);
        Self { tasks }
    }

    /// Polls ready tasks, lowest number first, round after round, until none is ready.
    pub fn poll_until_quiet(&mut self) {
        loop {
            let ready = READY.swap(0, Ordering::AcqRel);
            if ready == 0 {
                return;
            }
            for (index, task) in
                self.tasks.iter_mut().enumerate().filter(|(index, _)| ready & (1 << index) != 0)
            {
                let waker = waker(index);
                assert!(
                    task.as_mut().poll(&mut Context::from_waker(&waker)).is_pending(),
                    "task {index} ended"
                );
            }
        }
    }
}
