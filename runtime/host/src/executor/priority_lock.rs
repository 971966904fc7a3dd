//! Locks of the slots and queues between the rings: one for each, and a thread that waits lends its priority to the one that
//! holds it (`futex(2)` of the Linux manual pages, FUTEX_LOCK_PI).
//!
//! Without a second thread at the same slot a lock is one exchange of a word, and the kernel is not asked.

use core::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

use embassy_sync::blocking_mutex::raw::RawMutex;
use rustix::io::Errno;
use rustix::thread::{futex, gettid};

/// Belongs to no thread.
const FREE: u32 = 0;
/// Between two tries where the kernel has no such locks.
const RETRY: Duration = Duration::from_micros(50);

thread_local! {
    /// The kernel's number of this thread.
    static THREAD: u32 = gettid().as_raw_nonzero().get().cast_unsigned();
}

/// A lock with priority inheritance, for embassy's mutexes and signals. Not reentrant: a thread that takes one twice panics.
#[derive(Debug)]
pub struct PriorityLock {
    /// [`FREE`], or the number of the thread that holds it, with the kernel's mark of threads that wait.
    holder: AtomicU32,
}

// SAFETY: `holder` becomes this thread's number by an exchange with `FREE`, or by the kernel's FUTEX_LOCK_PI, which gives it to
// one thread at a time; it stays until `Held` is dropped.
unsafe impl RawMutex for PriorityLock {
    const INIT: Self = Self { holder: AtomicU32::new(FREE) };

    fn lock<R>(&self, with: impl FnOnce() -> R) -> R {
        let _held = self.hold();
        with()
    }
}

impl PriorityLock {
    fn hold(&self) -> Held<'_> {
        let thread = THREAD.with(|thread| *thread);
        if self.holder.compare_exchange(FREE, thread, Ordering::Acquire, Ordering::Relaxed).is_err() {
            self.wait(thread);
        }
        Held { lock: self, thread }
    }

    #[cold]
    fn wait(&self, thread: u32) {
        loop {
            match futex::lock_pi(&self.holder, futex::Flags::PRIVATE, None) {
                Ok(()) => return,
                Err(Errno::DEADLK) => panic!("a thread takes a lock that it holds"),
                Err(Errno::INTR | Errno::AGAIN) => {}
                // A kernel without such locks.
                Err(_) => {
                    let taken =
                        self.holder.compare_exchange(FREE, thread, Ordering::Acquire, Ordering::Relaxed);
                    if taken.is_ok() {
                        return;
                    }
                    thread::sleep(RETRY);
                }
            }
        }
    }
}

/// Gives the lock back, in a panic too.
struct Held<'a> {
    lock: &'a PriorityLock,
    thread: u32,
}

impl Drop for Held<'_> {
    fn drop(&mut self) {
        let holder = &self.lock.holder;
        if holder.compare_exchange(self.thread, FREE, Ordering::Release, Ordering::Relaxed).is_err() {
            // Threads wait: the kernel gives it to the most urgent one. It cannot refuse the holder.
            let _ = futex::unlock_pi(holder, futex::Flags::PRIVATE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::{Ring, take_priority};
    use embassy_sync::blocking_mutex::Mutex;
    use std::cell::Cell;
    use std::sync::mpsc::channel;

    #[test]
    fn threads_exclude_each_other() {
        let counter = Mutex::<PriorityLock, Cell<u64>>::new(Cell::new(0));
        thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for turn in 0..20_000_u64 {
                        counter.lock(|count| {
                            let before = count.get();
                            if turn % 64 == 0 {
                                thread::yield_now();
                            }
                            count.set(before + 1);
                        });
                    }
                });
            }
        });
        assert_eq!(counter.lock(Cell::get), 80_000);
    }

    #[test]
    fn panic_under_the_lock_gives_it_back() {
        let counter = Mutex::<PriorityLock, Cell<u64>>::new(Cell::new(0));
        let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            counter.lock(|count| {
                count.set(1);
                panic!("under the lock");
            })
        }));
        assert!(panicked.is_err());
        assert_eq!(thread::scope(|scope| scope.spawn(|| counter.lock(Cell::get)).join().unwrap()), 1);
    }

    /// Priority that the kernel works with, from the statistics of a thread of this process: below 0 is real time.
    fn priority_of(thread: u32) -> i64 {
        let text = std::fs::read_to_string(format!("/proc/self/task/{thread}/stat")).unwrap();
        let behind_the_name = text.rsplit_once(')').unwrap().1;
        behind_the_name.split_whitespace().nth(15).unwrap().parse().unwrap()
    }

    /// A thread of ordinary priority that holds a lock runs with the priority of the guard ring while that one waits.
    #[test]
    fn holder_inherits_the_priority_of_who_waits() {
        let lock = Mutex::<PriorityLock, ()>::new(());
        let (granted, outcome) = channel();
        let holder = THREAD.with(|thread| *thread);
        thread::scope(|scope| {
            lock.lock(|()| {
                let before = priority_of(holder);
                scope.spawn(|| {
                    let line = take_priority(Ring::Guard);
                    granted.send(line.contains("real-time")).unwrap();
                    lock.lock(|()| ());
                });
                if !outcome.recv().unwrap() {
                    println!("skipped: the system grants no real-time priority");
                    return;
                }
                // The other thread is about to wait: at most some milliseconds, ten seconds on a machine that does nothing else.
                let inherited = (0..10_000).any(|_| {
                    thread::sleep(Duration::from_millis(1));
                    priority_of(holder) < 0
                });
                assert!(before >= 0 && inherited, "{before}");
            });
        });
    }
}
