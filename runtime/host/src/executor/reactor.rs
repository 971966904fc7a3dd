//! Tells tasks when a file descriptor may have something for them.
//!
//! Edge-triggered epoll, one instance per thread. A carrier tries its system call first; when that would block it
//! leaves its waker here and sleeps. Everything happens on one thread, so no edge can fall between the two steps.

use std::cell::RefCell;
use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use embassy_futures::yield_now;
use rustix::event::{Timespec, epoll};
use rustix::time::{
    Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, timerfd_create, timerfd_settime,
};

/// Events taken from the kernel per call; more wait for the next call.
const EVENTS_PER_WAIT: usize = 32;
/// What the kernel gives back for the timer, which no task waits for.
const TIMER: u64 = u64::MAX;

/// What the kernel tells about: the descriptors, and the end of a sleep.
///
/// A sleep ends by a timer descriptor. The time limit of `epoll_pwait` is in whole milliseconds and rounded up, and the one in
/// nanoseconds needs Linux 5.11.
struct Kernel {
    epoll: OwnedFd,
    timer: OwnedFd,
}

impl Kernel {
    fn new() -> io::Result<Self> {
        let epoll = epoll::create(epoll::CreateFlags::CLOEXEC)?;
        let flags = TimerfdFlags::CLOEXEC | TimerfdFlags::NONBLOCK;
        let timer = timerfd_create(TimerfdClockId::Monotonic, flags)?;
        let edge = epoll::EventFlags::IN | epoll::EventFlags::ET;
        epoll::add(&epoll, &timer, epoll::EventData::new_u64(TIMER), edge)?;
        Ok(Self { epoll, timer })
    }

    /// The sleep ends in so long, which is not zero.
    fn end_sleep_in(&self, duration: Duration) -> io::Result<()> {
        let zero = Timespec { tv_sec: 0, tv_nsec: 0 };
        let it_value = Timespec {
            tv_sec: duration.as_secs().try_into().unwrap_or(i64::MAX),
            tv_nsec: duration.subsec_nanos().into(),
        };
        let once = Itimerspec { it_interval: zero, it_value };
        timerfd_settime(&self.timer, TimerfdTimerFlags::empty(), &once)?;
        Ok(())
    }
}

#[derive(Default)]
struct Waiting {
    reader: Option<Waker>,
    writer: Option<Waker>,
}

#[derive(Default)]
struct Reactor {
    kernel: Option<Kernel>,
    waiting: Vec<Waiting>,
    /// Filled by the kernel; kept for its memory, as the next one.
    events: Vec<epoll::Event>,
    /// Tasks that the events concern.
    wakers: Vec<Waker>,
}

thread_local! {
    static REACTOR: RefCell<Reactor> = RefCell::new(Reactor::default());
}

impl Reactor {
    fn kernel(&mut self) -> io::Result<&Kernel> {
        if self.kernel.is_none() {
            self.kernel = Some(Kernel::new()?);
        }
        self.kernel.as_ref().ok_or_else(|| io::Error::other("no epoll instance"))
    }
}

/// A non-blocking file descriptor that this thread's reactor watches.
pub struct Source<F: AsFd> {
    /// The descriptor.
    pub file: F,
    index: usize,
}

impl<F: AsFd> Source<F> {
    /// Watches a descriptor, which must be non-blocking. Must be used on the thread that made it.
    ///
    /// # Errors
    /// The kernel refused the registration.
    pub fn new(file: F) -> io::Result<Self> {
        REACTOR.with_borrow_mut(|reactor| {
            let index = reactor.waiting.len();
            let flags = epoll::EventFlags::IN | epoll::EventFlags::OUT | epoll::EventFlags::ET;
            epoll::add(&reactor.kernel()?.epoll, &file, epoll::EventData::new_u64(index as u64), flags)?;
            reactor.waiting.push(Waiting::default());
            Ok(Self { file, index })
        })
    }

    /// Repeats a reading call until it does not block any more. The others have their turn first: a device that never pauses
    /// must not keep the guard's tick and the drives waiting.
    ///
    /// # Errors
    /// What the call gives, other than "would block" and "interrupted".
    pub async fn read_ready<T>(&self, mut call: impl FnMut(&F) -> io::Result<T>) -> io::Result<T> {
        yield_now().await;
        core::future::poll_fn(|context| self.attempt(context, &mut call, |waiting| &mut waiting.reader)).await
    }

    /// Repeats a writing call until it does not block any more.
    ///
    /// # Errors
    /// What the call gives, other than "would block" and "interrupted".
    pub async fn write_ready<T>(&self, mut call: impl FnMut(&F) -> io::Result<T>) -> io::Result<T> {
        core::future::poll_fn(|context| self.attempt(context, &mut call, |waiting| &mut waiting.writer)).await
    }

    fn attempt<T>(
        &self,
        context: &mut Context<'_>,
        call: &mut impl FnMut(&F) -> io::Result<T>,
        side: fn(&mut Waiting) -> &mut Option<Waker>,
    ) -> Poll<io::Result<T>> {
        loop {
            match call(&self.file) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    REACTOR.with_borrow_mut(|reactor| {
                        if let Some(waiting) = reactor.waiting.get_mut(self.index) {
                            *side(waiting) = Some(context.waker().clone());
                        }
                    });
                    return Poll::Pending;
                }
                result => return Poll::Ready(result),
            }
        }
    }
}

impl<F: AsFd> Drop for Source<F> {
    fn drop(&mut self) {
        REACTOR.with_borrow_mut(|reactor| {
            if let Some(kernel) = &reactor.kernel {
                // A descriptor that the kernel has dropped already needs no removal.
                let _ = epoll::delete(&kernel.epoll, &self.file);
            }
        });
    }
}

/// Sleeps until a watched descriptor is ready or the time is over, to some microseconds, then wakes the tasks concerned. From
/// the second call on nothing is allocated.
pub(super) fn wait(at_most: Duration) -> io::Result<()> {
    let mut wakers = REACTOR.with_borrow_mut(|reactor| reactor.take_ready(at_most))?;
    wakers.drain(..).for_each(Waker::wake);
    REACTOR.with_borrow_mut(|reactor| reactor.wakers = wakers);
    Ok(())
}

impl Reactor {
    fn take_ready(&mut self, at_most: Duration) -> io::Result<Vec<Waker>> {
        self.kernel()?;
        let Self { kernel, waiting, events, wakers } = self;
        events.clear();
        events.reserve(EVENTS_PER_WAIT);
        if let Some(kernel) = kernel {
            let look = Timespec { tv_sec: 0, tv_nsec: 0 };
            let at_most = if at_most.is_zero() {
                Some(&look)
            } else {
                kernel.end_sleep_in(at_most)?;
                None
            };
            match epoll::wait(&kernel.epoll, rustix::buffer::spare_capacity(events), at_most) {
                Ok(_) | Err(rustix::io::Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
        for event in &*events {
            if let Some(waiting) = usize::try_from(event.data.u64()).ok().and_then(|at| waiting.get_mut(at)) {
                wakers.extend(waiting.reader.take());
                wakers.extend(waiting.writer.take());
            }
        }
        Ok(std::mem::take(wakers))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    /// A time limit of whole milliseconds would end each of these a millisecond after its begin or not at all.
    #[test]
    fn sleeps_are_as_short_as_asked_for() {
        let mut shortest = Duration::MAX;
        for _ in 0..200 {
            let before = Instant::now();
            wait(Duration::from_micros(200)).unwrap();
            let slept = before.elapsed();
            assert!(slept >= Duration::from_micros(200), "{slept:?}");
            shortest = shortest.min(slept);
        }
        assert!(shortest < Duration::from_micros(900), "{shortest:?}");
    }

    /// A timer descriptor that is set to zero never fires: this would sleep for ever.
    #[test]
    fn zero_time_does_not_sleep() {
        wait(Duration::from_micros(1)).unwrap();
        wait(Duration::ZERO).unwrap();
    }
}
