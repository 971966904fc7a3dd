//! A bounded queue whose losses are counted.
//!
//! The sender never waits: the guard ring must not depend on how fast perception reads. When the queue is full the
//! *new* element is dropped, so that what the reader has is a gapless past with a counted hole at its end.

use core::cell::Cell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::channel::Channel;

/// A queue of at most `N` elements.
pub struct Queue<M: RawMutex, T, const N: usize> {
    channel: Channel<M, T, N>,
    lost: Mutex<M, Cell<u32>>,
}

impl<M: RawMutex, T, const N: usize> Queue<M, T, N> {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { channel: Channel::new(), lost: Mutex::new(Cell::new(0)) }
    }

    /// Appends an element, or drops and counts it when the queue is full. True if it was kept.
    pub fn push(&self, element: T) -> bool {
        let kept = self.channel.try_send(element).is_ok();
        if !kept {
            self.lost.lock(|lost| lost.set(lost.get().saturating_add(1)));
        }
        kept
    }

    /// Waits for the oldest element.
    pub async fn pop(&self) -> T {
        self.channel.receive().await
    }

    /// The oldest element, if there is one.
    pub fn try_pop(&self) -> Option<T> {
        self.channel.try_receive().ok()
    }

    /// Elements that found the queue full.
    pub fn lost(&self) -> u32 {
        self.lost.lock(Cell::get)
    }
}

impl<M: RawMutex, T, const N: usize> Default for Queue<M, T, N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;

    #[test]
    fn a_full_queue_keeps_the_oldest_and_counts() {
        let queue = Queue::<NoopRawMutex, u8, 2>::new();
        assert!(queue.push(1) && queue.push(2));
        assert!(!queue.push(3));
        assert_eq!(queue.lost(), 1);
        assert_eq!((queue.try_pop(), queue.try_pop(), queue.try_pop()), (Some(1), Some(2), None));
    }
}
