//! What a thread of its own saw of people, on its way to the perception ring.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use floorguard_perception::people::PeopleView;

/// Views that wait for the next sweep: a camera at 60 Hz sends six.
const WAITING_MAX: usize = 8;

/// A few views; the writer never waits for the reader.
#[derive(Clone, Debug, Default)]
pub struct PeopleInbox(Arc<Mutex<VecDeque<PeopleView>>>);

impl PeopleInbox {
    /// Adds a view; the oldest one gives way.
    pub fn put(&self, view: PeopleView) {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.len() >= WAITING_MAX {
            waiting.pop_front();
        }
        waiting.push_back(view);
    }

    /// Everything that waits, oldest first.
    #[must_use]
    pub fn take_all(&self) -> VecDeque<PeopleView> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
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
