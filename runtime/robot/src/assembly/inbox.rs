//! What a thread of its own saw of people, on its way to the perception ring.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;

use embassy_sync::blocking_mutex::Mutex;
use floorguard_host::executor::PriorityLock;
use floorguard_perception::people::PeopleView;

/// Views that wait for the next sweep: a camera at 60 Hz sends six.
const WAITING_MAX: usize = 8;

/// A few views; the writer never waits for the reader.
#[derive(Clone)]
pub struct PeopleInbox(Arc<Mutex<PriorityLock, RefCell<VecDeque<PeopleView>>>>);

impl Default for PeopleInbox {
    fn default() -> Self {
        Self(Arc::new(Mutex::new(RefCell::default())))
    }
}

impl fmt::Debug for PeopleInbox {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let waiting = self.0.lock(|waiting| waiting.borrow().len());
        write!(out, "PeopleInbox with {waiting} views")
    }
}

impl PeopleInbox {
    /// Adds a view; the oldest one gives way.
    pub fn put(&self, view: PeopleView) {
        self.0.lock(|waiting| {
            let waiting = &mut *waiting.borrow_mut();
            if waiting.len() >= WAITING_MAX {
                waiting.pop_front();
            }
            waiting.push_back(view);
        });
    }

    /// Everything that waits, oldest first.
    #[must_use]
    pub fn take_all(&self) -> VecDeque<PeopleView> {
        self.0.lock(|waiting| std::mem::take(&mut *waiting.borrow_mut()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_perception::people::PeopleSensor;
    use floorguard_types::time::Stamp;

    #[test]
    fn oldest_is_dropped_nothing_delivered_twice() {
        let inbox = PeopleInbox::default();
        for at_us in 0..10 {
            let mut view = PeopleView::new(PeopleSensor::DepthCamera);
            view.stamp = Stamp::from_micros(at_us);
            inbox.put(view);
        }
        let stamps: Vec<u64> = inbox.take_all().iter().map(|view| view.stamp.as_micros()).collect();
        assert_eq!(stamps, (2..10).collect::<Vec<_>>());
        assert!(inbox.take_all().is_empty());
    }
}
