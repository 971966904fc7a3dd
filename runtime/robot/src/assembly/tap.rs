//! A listener on the robot's lines: every byte that reaches the guard ring also goes into a bounded queue, for the
//! recording and the panel.
//!
//! The guard ring never waits for who listens: what does not fit into the queue is dropped and counted.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use embedded_io_async::{ErrorType, Read, Write};
use floorguard_drivers::can::CanFrame;
use floorguard_guard::{Advice, Decision};
use floorguard_runtime::clock;
use floorguard_runtime::io::{CanBus, DatagramReceiver, Received};
use floorguard_runtime::tape::TapeLine;
use floorguard_runtime::tasks::GuardInput;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use super::guard_task::GuardTask;

/// Rows that may wait: some three seconds of all sensors and polls together.
const ROWS_MAX: usize = 32_768;

/// Something that crossed a line.
#[derive(Clone, Debug, PartialEq)]
pub enum TapRow {
    /// Bytes that the tasks get.
    Delivered {
        /// When the tasks got them.
        at: Stamp,
        /// When they arrived.
        arrival: Stamp,
        /// Over which line.
        line: TapeLine,
        /// The bytes, in the form of the tape.
        bytes: Vec<u8>,
    },
    /// A frame that the robot sends on the bus.
    Sent(Stamp, CanFrame),
    /// The guard began at this time.
    Began(Stamp),
    /// At this time the guard got the causes that were latched when the computer last ran.
    Latches(Stamp, u64),
    /// Reading from a line, or writing to it, failed.
    Failed(TapeLine, Direction),
    /// The guard took what the mission would like.
    Command(Stamp, Twist2),
    /// The guard took an advice of perception.
    Advice(Box<Advice>),
    /// The guard took the button for reset or start.
    Operator(TapeLine),
    /// A task of the guard ring was polled; everything since the poll before belongs to it.
    Polled(Poll),
}

/// Whether bytes come or go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the robot's computer.
    Read,
    /// From it.
    Write,
}

/// One poll of a task of the guard ring, and what was decided in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Poll {
    /// The task.
    pub task: GuardTask,
    /// Its time, which stands still during the poll.
    pub at: Stamp,
    /// Decisions that the guard took.
    pub decisions: u32,
    /// The last of them.
    pub decision: Option<Box<Decision>>,
}

/// The robot's end of the queue.
#[derive(Clone, Debug)]
pub struct Tap {
    rows: SyncSender<TapRow>,
    lost: Arc<AtomicU64>,
}

/// The listener's end.
#[derive(Debug)]
pub struct TapRows {
    rows: Receiver<TapRow>,
    lost: Arc<AtomicU64>,
}

/// A new queue.
#[must_use]
pub fn tap() -> (Tap, TapRows) {
    let (sender, rows) = sync_channel(ROWS_MAX);
    let lost = Arc::new(AtomicU64::new(0));
    (Tap { rows: sender, lost: Arc::clone(&lost) }, TapRows { rows, lost })
}

impl Tap {
    fn push(&self, row: TapRow) {
        if self.rows.try_send(row).is_err() {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The guard began at this time.
    pub fn began(&self, at: Stamp) {
        self.push(TapRow::Began(at));
    }

    /// What was latched when the computer last ran, and when the guard gets it.
    pub fn latched(&self, at: Stamp, latches: u64) {
        self.push(TapRow::Latches(at, latches));
    }

    /// What the guard takes from other rings and from people.
    pub fn input(&self, input: GuardInput<'_>) {
        self.push(match input {
            GuardInput::Command(stamp, wanted) => TapRow::Command(stamp, wanted),
            GuardInput::Advice(advice) => TapRow::Advice(Box::new(advice.clone())),
            GuardInput::Reset => TapRow::Operator(TapeLine::Reset),
            GuardInput::Start => TapRow::Operator(TapeLine::Start),
        });
    }

    /// A poll of the guard ring.
    pub fn polled(&self, poll: Poll) {
        self.push(TapRow::Polled(poll));
    }

    fn delivered(&self, arrival: Option<Stamp>, line: TapeLine, bytes: Vec<u8>) {
        let at = clock::now();
        self.push(TapRow::Delivered { at, arrival: arrival.unwrap_or(at), line, bytes });
    }
}

impl TapRows {
    /// The next row that waits.
    #[must_use]
    pub fn next(&self) -> Option<TapRow> {
        self.rows.try_recv().ok()
    }

    /// Rows that did not fit so far.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }
}

/// A carrier with a listener, or without one.
pub struct Tapped<T> {
    carrier: T,
    line: TapeLine,
    tap: Option<Tap>,
}

impl<T> Tapped<T> {
    /// Listens to a carrier.
    pub const fn new(carrier: T, line: TapeLine, tap: Option<Tap>) -> Self {
        Self { carrier, line, tap }
    }

    fn failed(&self, direction: Direction) {
        if let Some(tap) = &self.tap {
            tap.push(TapRow::Failed(self.line, direction));
        }
    }
}

impl<T: DatagramReceiver> DatagramReceiver for Tapped<T> {
    type Error = T::Error;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, T::Error> {
        let received = self.carrier.receive(buffer).await.inspect_err(|_| self.failed(Direction::Read))?;
        if let (Some(tap), Some(bytes)) = (&self.tap, buffer.get(..received.length)) {
            tap.delivered(Some(received.arrival), self.line, bytes.to_vec());
        }
        Ok(received)
    }

    fn keep_sender(&mut self) {
        self.carrier.keep_sender();
    }
}

impl<T: ErrorType> ErrorType for Tapped<T> {
    type Error = T::Error;
}

impl<T: Read> Read for Tapped<T> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, T::Error> {
        let count = self.carrier.read(buffer).await.inspect_err(|_| self.failed(Direction::Read))?;
        if let (Some(tap), Some(bytes)) = (&self.tap, buffer.get(..count)) {
            tap.delivered(None, self.line, bytes.to_vec());
        }
        Ok(count)
    }
}

impl<T: Write> Write for Tapped<T> {
    async fn write(&mut self, buffer: &[u8]) -> Result<usize, T::Error> {
        self.carrier.write(buffer).await.inspect_err(|_| self.failed(Direction::Write))
    }

    async fn flush(&mut self) -> Result<(), T::Error> {
        self.carrier.flush().await
    }
}

impl<T: CanBus> CanBus for Tapped<T> {
    type Error = T::Error;

    async fn receive(&mut self) -> Result<CanFrame, T::Error> {
        let frame = self.carrier.receive().await.inspect_err(|_| self.failed(Direction::Read))?;
        // No device of the robot uses other identifiers, and the tape cannot hold them.
        if let (Some(tap), Some(id)) = (&self.tap, frame.standard_id()) {
            let bytes = id.to_le_bytes().iter().chain(frame.payload()).copied().collect();
            tap.delivered(None, self.line, bytes);
        }
        Ok(frame)
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), T::Error> {
        if let Some(tap) = &self.tap {
            tap.push(TapRow::Sent(clock::now(), *frame));
        }
        self.carrier.send(frame).await.inspect_err(|_| self.failed(Direction::Write))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unread_queue_counts_lost_rows() {
        let (tap, rows) = tap();
        for index in 0..ROWS_MAX + 5 {
            tap.delivered(None, TapeLine::Scanner, index.to_le_bytes().to_vec());
        }
        assert_eq!(rows.lost(), 5);
        assert_eq!(std::iter::from_fn(|| rows.next()).count(), ROWS_MAX);
    }

    #[test]
    fn a_can_frame_passes_and_is_heard() {
        let pipe = floorguard_host::carriers::CanPipe::default();
        let (tap, rows) = tap();
        let mut bus = Tapped::new(pipe.clone(), TapeLine::Can, Some(tap));
        pipe.push(CanFrame::standard(0x181, &[1, 2, 3]));
        let received = embassy_futures::block_on(bus.receive()).unwrap();
        embassy_futures::block_on(bus.send(&CanFrame::standard(0x201, &[9]))).unwrap();
        assert_eq!(received.payload(), [1, 2, 3]);
        let heard: Vec<TapRow> = std::iter::from_fn(|| rows.next()).collect();
        let [TapRow::Delivered { line: TapeLine::Can, bytes, .. }, TapRow::Sent(_, sent)] = heard.as_slice()
        else {
            panic!("{heard:?}");
        };
        assert_eq!((bytes.as_slice(), sent.standard_id()), ([0x81, 0x01, 1, 2, 3].as_slice(), Some(0x201)));
    }
}
