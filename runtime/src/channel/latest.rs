//! The latest value of something, with a wake-up for one waiting reader.
//!
//! Writers never wait. A value that was overwritten before anybody took it is counted in [`Latest::overwritten`]:
//! for a state (pose, decision) that is normal, for a measurement it tells that the reader is late.

use core::cell::RefCell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;

struct Slot<T> {
    value: Option<T>,
    unread: bool,
    overwritten: u32,
    published: u32,
}

/// A slot that holds the newest value only.
pub struct Latest<M: RawMutex, T> {
    slot: Mutex<M, RefCell<Slot<T>>>,
    changed: Signal<M, ()>,
}

impl<M: RawMutex, T: Clone> Latest<M, T> {
    /// An empty slot.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            slot: Mutex::new(RefCell::new(Slot { value: None, unread: false, overwritten: 0, published: 0 })),
            changed: Signal::new(),
        }
    }

    /// Replaces the value and wakes the waiting reader.
    pub fn publish(&self, value: T) {
        self.slot.lock(|slot| {
            let slot = &mut *slot.borrow_mut();
            if slot.unread {
                slot.overwritten = slot.overwritten.saturating_add(1);
            }
            slot.value = Some(value);
            slot.published = slot.published.wrapping_add(1);
            slot.unread = true;
        });
        self.changed.signal(());
    }

    /// The newest value, read or not. `None` until the first publication.
    pub fn get(&self) -> Option<T> {
        self.slot.lock(|slot| {
            let slot = &mut *slot.borrow_mut();
            slot.unread = false;
            slot.value.clone()
        })
    }

    /// The newest value, if it is another publication than `seen`, which then is that of this one. 0: none was seen.
    pub fn unseen(&self, seen: &mut u32) -> Option<T> {
        self.slot.lock(|slot| {
            let slot = &mut *slot.borrow_mut();
            if core::mem::replace(seen, slot.published) == slot.published {
                return None;
            }
            slot.unread = false;
            slot.value.clone()
        })
    }

    /// Waits for a publication that this reader has not seen, then gives the newest value. One reader at a time
    /// may wait.
    pub async fn next(&self) -> T {
        loop {
            self.changed.wait().await;
            if let Some(value) = self.get() {
                return value;
            }
        }
    }

    /// Publications so far: a cheap way to see whether there is a new one. Wraps.
    pub fn published(&self) -> u32 {
        self.slot.lock(|slot| slot.borrow().published)
    }

    /// Values replaced before they were read.
    pub fn overwritten(&self) -> u32 {
        self.slot.lock(|slot| slot.borrow().overwritten)
    }
}

impl<M: RawMutex, T: Clone> Default for Latest<M, T> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embassy_futures::block_on;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;

    #[test]
    fn reader_gets_newest_losses_are_counted() {
        let latest = Latest::<NoopRawMutex, u32>::new();
        assert_eq!(latest.get(), None);
        latest.publish(1);
        latest.publish(2);
        assert_eq!(block_on(latest.next()), 2);
        assert_eq!(latest.overwritten(), 1);
        latest.publish(3);
        assert_eq!(latest.get(), Some(3));
        assert_eq!(latest.overwritten(), 1);
        let mut seen = 0;
        assert_eq!([latest.unseen(&mut seen), latest.unseen(&mut seen)], [Some(3), None]);
        latest.publish(4);
        assert_eq!(latest.unseen(&mut seen), Some(4));
    }
}
