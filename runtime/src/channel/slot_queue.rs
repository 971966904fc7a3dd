//! A bounded queue for large elements, written and read in place: one copy in, one copy out.
//!
//! As in [`super::Queue`] the sender never waits, and what does not fit is counted.

use core::cell::RefCell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;

struct Slots<T, const N: usize> {
    slots: [T; N],
    first: usize,
    used: usize,
    lost: u32,
}

/// A queue of at most `N` elements, with one reader.
pub struct SlotQueue<M: RawMutex, T, const N: usize> {
    slots: Mutex<M, RefCell<Slots<T, N>>>,
    filled: Signal<M, ()>,
}

impl<M: RawMutex, T, const N: usize> SlotQueue<M, T, N> {
    /// An empty queue of slots like these.
    #[must_use]
    pub const fn new(slots: [T; N]) -> Self {
        Self {
            slots: Mutex::new(RefCell::new(Slots { slots, first: 0, used: 0, lost: 0 })),
            filled: Signal::new(),
        }
    }

    /// Lets `write` fill the next free slot, which holds something old. When there is none, that is counted and `write`
    /// is not called. True if it was.
    pub fn push(&self, write: impl FnOnce(&mut T)) -> bool {
        let kept = self.slots.lock(|slots| {
            let slots = &mut *slots.borrow_mut();
            let next = slots.first.saturating_add(slots.used).checked_rem(N).unwrap_or(0);
            match slots.slots.get_mut(next).filter(|_| slots.used < N) {
                Some(slot) => {
                    write(slot);
                    slots.used = slots.used.saturating_add(1);
                    true
                }
                None => {
                    slots.lost = slots.lost.saturating_add(1);
                    false
                }
            }
        });
        self.filled.signal(());
        kept
    }

    /// Waits for the oldest element, gives it to `read` and drops it. `read` runs under the lock: it copies, no more.
    pub async fn pop<R>(&self, mut read: impl FnMut(&T) -> R) -> R {
        loop {
            if let Some(answer) = self.try_pop(&mut read) {
                return answer;
            }
            self.filled.wait().await;
        }
    }

    fn try_pop<R>(&self, read: impl FnOnce(&T) -> R) -> Option<R> {
        self.slots.lock(|slots| {
            let slots = &mut *slots.borrow_mut();
            let answer = slots.slots.get(slots.first).filter(|_| slots.used > 0).map(read)?;
            slots.first = slots.first.saturating_add(1).checked_rem(N).unwrap_or(0);
            slots.used = slots.used.saturating_sub(1);
            Some(answer)
        })
    }

    /// Elements that did not fit.
    pub fn lost(&self) -> u32 {
        self.slots.lock(|slots| slots.borrow().lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_futures::block_on;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;

    #[test]
    fn full_slot_queue_keeps_oldest_and_counts() {
        let queue = SlotQueue::<NoopRawMutex, u8, 2>::new([0; 2]);
        for round in 0..3 {
            assert!(queue.push(|slot| *slot = 1) && queue.push(|slot| *slot = 2));
            assert!(!queue.push(|_| panic!("full")));
            assert_eq!((block_on(queue.pop(|slot| *slot)), block_on(queue.pop(|slot| *slot))), (1, 2));
            assert_eq!(queue.lost(), round + 1);
        }
    }
}
