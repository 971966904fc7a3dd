//! The detector on a thread of its own: who brings pictures never waits.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use floorguard_mapping::people_removal::PersonBox;
use floorguard_types::time::Stamp;

use super::detector::Detector;
use super::picture::RgbPicture;

/// Answers that wait to be taken; further ones are left out and counted.
const ANSWERS: usize = 16;

/// People of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Time of the picture.
    pub stamp: Stamp,
    /// Its width and height, pixels.
    pub size: [u32; 2],
    /// The people, or why there is no answer.
    pub people: Result<Vec<PersonBox>, String>,
}

/// What became of pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkerCounts {
    /// Brought.
    pub offered: u64,
    /// Looked at.
    pub processed: u64,
    /// Replaced by a newer one before the model had time for it.
    pub late: u64,
    /// Answers that were not taken in time.
    pub not_taken: u64,
}

#[derive(Default)]
struct Slot {
    next: Option<(Stamp, RgbPicture)>,
    counts: WorkerCounts,
    is_ending: bool,
}

type Shared = Arc<(Mutex<Slot>, Condvar)>;

/// One picture is worked on and one waits; a newer one takes the place of the one that waits.
pub struct DetectorThread {
    shared: Shared,
    answers: Receiver<Found>,
    thread: Option<JoinHandle<()>>,
}

/// A thread that ended while it held the lock leaves whole values behind.
fn locked(slot: &Mutex<Slot>) -> MutexGuard<'_, Slot> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

impl DetectorThread {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system has no thread left.
    pub fn start(detector: Detector) -> std::io::Result<Self> {
        let shared: Shared = Arc::default();
        let (sender, answers) = sync_channel(ANSWERS);
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("detector".to_owned()).spawn(move || {
            work(&of_thread, &sender, detector);
        })?;
        Ok(Self { shared, answers, thread: Some(thread) })
    }

    /// Brings a picture; never waits for the model. False if a picture that still waited was dropped for it, and counted.
    pub fn offer(&self, stamp: Stamp, picture: RgbPicture) -> bool {
        let (slot, signal) = &*self.shared;
        let mut slot = locked(slot);
        slot.counts.offered += 1;
        let was_free = slot.next.replace((stamp, picture)).is_none();
        slot.counts.late += u64::from(!was_free);
        signal.notify_one();
        was_free
    }

    /// An answer, if there is one.
    pub fn take(&self) -> Option<Found> {
        self.answers.try_recv().ok()
    }

    /// What became of pictures so far.
    #[must_use]
    pub fn counts(&self) -> WorkerCounts {
        locked(&self.shared.0).counts
    }

    /// Waits for the picture in work and the one that waits, and hands over all answers.
    #[must_use]
    pub fn finish(mut self) -> (Vec<Found>, WorkerCounts) {
        self.end();
        let found = std::iter::from_fn(|| self.take()).collect();
        (found, self.counts())
    }

    fn end(&mut self) {
        let (slot, signal) = &*self.shared;
        locked(slot).is_ending = true;
        signal.notify_one();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing more to say.
            let _ = thread.join();
        }
    }
}

impl Drop for DetectorThread {
    fn drop(&mut self) {
        self.end();
    }
}

fn work(shared: &Shared, sender: &SyncSender<Found>, mut detector: Detector) {
    let (slot, signal) = &**shared;
    loop {
        let mut waiting = locked(slot);
        let (stamp, picture) = loop {
            if let Some(next) = waiting.next.take() {
                break next;
            }
            if waiting.is_ending {
                return;
            }
            waiting = signal.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        };
        drop(waiting);
        let people = detector.detect(&picture).map_err(|error| error.to_string());
        let is_taken = sender.try_send(Found { stamp, size: picture.size(), people }).is_ok();
        let mut slot = locked(slot);
        slot.counts.processed += 1;
        slot.counts.not_taken += u64::from(!is_taken);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;
    use crate::{DetectorConfig, Model, ModelError, ModelOutput};

    /// Waits at each picture until the test lets it go on.
    struct SlowModel {
        begun: Sender<()>,
        go: Receiver<()>,
    }

    impl Model for SlowModel {
        fn frame(&self) -> [u32; 2] {
            [32, 32]
        }

        fn run(&mut self, _: Vec<f32>) -> Result<ModelOutput, ModelError> {
            self.begun.send(()).map_err(|error| ModelError::Run(error.to_string()))?;
            self.go.recv().map_err(|error| ModelError::Run(error.to_string()))?;
            Ok(ModelOutput { shape: vec![1, 21, 6], values: vec![0.0; 21 * 6] })
        }
    }

    #[test]
    fn late_pictures_are_dropped_and_counted() {
        let ((begun, has_begun), (let_go, go)) = (channel(), channel());
        let_go.send(()).unwrap();
        let detector = Detector::new(Box::new(SlowModel { begun, go }), DetectorConfig::default()).unwrap();
        has_begun.recv().unwrap();
        let thread = DetectorThread::start(detector).unwrap();
        let picture = |value: u8| RgbPicture::new([2, 2], vec![value; 12]).unwrap();
        let at = Stamp::from_micros;
        assert!(thread.offer(at(1), picture(1)));
        has_begun.recv().unwrap();
        // The model is busy with the first: the second waits, the third takes its place.
        assert!(thread.offer(at(2), picture(2)));
        assert!(!thread.offer(at(3), picture(3)));
        let_go.send(()).unwrap();
        has_begun.recv().unwrap();
        let_go.send(()).unwrap();
        let (found, counts) = thread.finish();
        assert_eq!(found.iter().map(|each| each.stamp).collect::<Vec<_>>(), [at(1), at(3)]);
        assert_eq!(counts, WorkerCounts { offered: 3, processed: 2, late: 1, not_taken: 0 });
    }
}
