//! A listener on the robot's lines: every byte that reaches the guard ring also goes into a bounded queue, for the
//! recording and the panel.
//!
//! The guard ring never waits for who listens: what does not fit into the queue is dropped and counted. It allocates nothing
//! either: rows and bytes go into rings that were made before it began.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use embassy_sync::blocking_mutex::Mutex;
use embedded_io_async::{ErrorType, Read, Write};
use floorguard_drivers::can::CanFrame;
use floorguard_guard::{Advice, Decision};
use floorguard_host::executor::PriorityLock;
use floorguard_runtime::clock;
use floorguard_runtime::io::{CanBus, DatagramReceiver, Received};
use floorguard_runtime::tape::{TapeLine, frame_identifier};
use floorguard_runtime::tasks::GuardInput;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;
use rtrb::{Consumer, Producer, RingBuffer};

use super::guard_task::GuardTask;

/// Rows that may wait: some three seconds of all sensors and polls together.
const ROWS_MAX: usize = 32_768;
/// Bytes of the lines that may wait: a lidar sends 0.9 MB a second, all others together less than 0.2 MB.
const BYTES_MAX: usize = 4 << 20;
/// Advices that may wait: perception gives ten a second.
const ADVICES_MAX: usize = 64;
/// An identifier and a frame of the bus, bytes.
const FRAME_BYTES: usize = 10;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Poll {
    /// The task.
    pub task: GuardTask,
    /// Its time, which stands still during the poll.
    pub at: Stamp,
    /// Decisions that the guard took.
    pub decisions: u32,
    /// The last of them.
    pub decision: Option<Decision>,
}

/// A row as it waits: what is long waits in rings of its own.
#[derive(Clone, Copy)]
enum WaitingRow {
    Delivered { at: Stamp, arrival: Stamp, line: TapeLine, length: usize },
    Sent(Stamp, CanFrame),
    Began(Stamp),
    Latches(Stamp, u64),
    Failed(TapeLine, Direction),
    Command(Stamp, Twist2),
    Advice,
    Operator(TapeLine),
    Polled(Poll),
}

/// One end each of the rings.
struct Rings<Rows, Bytes, Advices> {
    rows: Rows,
    bytes: Bytes,
    advices: Advices,
}

type Writer = Rings<Producer<WaitingRow>, Producer<u8>, Producer<Advice>>;
type Reader = Rings<Consumer<WaitingRow>, Consumer<u8>, Consumer<Advice>>;

/// The robot's end of the queue.
#[derive(Clone)]
pub struct Tap {
    /// The carriers of one thread share it: they never wait for each other.
    writer: Arc<Mutex<PriorityLock, RefCell<Writer>>>,
    lost: Arc<AtomicU64>,
}

/// The listener's end.
pub struct TapRows {
    reader: Reader,
    lost: Arc<AtomicU64>,
}

/// A new queue. All of its memory is written once, so that the system has given it before the robot moves.
#[must_use]
pub fn tap() -> (Tap, TapRows) {
    let (mut rows, mut waiting) = RingBuffer::new(ROWS_MAX);
    while rows.push(WaitingRow::Began(Stamp::ZERO)).is_ok() {}
    while waiting.pop().is_ok() {}
    let (mut bytes, mut waiting_bytes) = RingBuffer::new(BYTES_MAX);
    while bytes.push(0).is_ok() {}
    while waiting_bytes.pop().is_ok() {}
    let (advices, waiting_advices) = RingBuffer::new(ADVICES_MAX);
    let writer = Rings { rows, bytes, advices };
    let reader = Rings { rows: waiting, bytes: waiting_bytes, advices: waiting_advices };
    let lost = Arc::new(AtomicU64::new(0));
    let tap = Tap { writer: Arc::new(Mutex::new(RefCell::new(writer))), lost: Arc::clone(&lost) };
    (tap, TapRows { reader, lost })
}

impl fmt::Debug for Tap {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Tap that lost {} rows", self.lost.load(Ordering::Relaxed))
    }
}

impl Writer {
    /// False when it does not fit: then nothing of it is kept.
    fn push(&mut self, row: WaitingRow, bytes: &[u8]) -> bool {
        // What is long first: who reads a row finds it there.
        !self.rows.is_full() && self.bytes.push_entire_slice(bytes).is_ok() && self.rows.push(row).is_ok()
    }

    fn push_advice(&mut self, advice: &Advice) -> bool {
        !self.rows.is_full()
            && !self.advices.is_full()
            && self.advices.push(advice.clone()).is_ok()
            && self.rows.push(WaitingRow::Advice).is_ok()
    }
}

impl Tap {
    fn write(&self, write: impl FnOnce(&mut Writer) -> bool) {
        if !self.writer.lock(|writer| write(&mut writer.borrow_mut())) {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn push(&self, row: WaitingRow) {
        self.write(|writer| writer.push(row, &[]));
    }

    /// The guard began at this time.
    pub fn began(&self, at: Stamp) {
        self.push(WaitingRow::Began(at));
    }

    /// What was latched when the computer last ran, and when the guard gets it.
    pub fn latched(&self, at: Stamp, latches: u64) {
        self.push(WaitingRow::Latches(at, latches));
    }

    /// What the guard takes from other rings and from people.
    pub fn input(&self, input: GuardInput<'_>) {
        match input {
            GuardInput::Command(stamp, wanted) => self.push(WaitingRow::Command(stamp, wanted)),
            GuardInput::Advice(advice) => self.write(|writer| writer.push_advice(advice)),
            GuardInput::Reset => self.push(WaitingRow::Operator(TapeLine::Reset)),
            GuardInput::Start => self.push(WaitingRow::Operator(TapeLine::Start)),
        }
    }

    /// A poll of the guard ring.
    pub fn polled(&self, poll: Poll) {
        self.push(WaitingRow::Polled(poll));
    }

    fn delivered(&self, arrival: Option<Stamp>, line: TapeLine, bytes: &[u8]) {
        let at = clock::now();
        let (arrival, length) = (arrival.unwrap_or(at), bytes.len());
        self.write(|writer| writer.push(WaitingRow::Delivered { at, arrival, line, length }, bytes));
    }
}

impl Iterator for TapRows {
    type Item = TapRow;

    /// The next row that waits.
    fn next(&mut self) -> Option<TapRow> {
        Some(match self.reader.rows.pop().ok()? {
            WaitingRow::Delivered { at, arrival, line, length } => {
                let mut bytes = vec![0; length];
                // They were there before the row was.
                self.reader.bytes.pop_entire_slice(&mut bytes).ok()?;
                TapRow::Delivered { at, arrival, line, bytes }
            }
            WaitingRow::Sent(at, frame) => TapRow::Sent(at, frame),
            WaitingRow::Began(at) => TapRow::Began(at),
            WaitingRow::Latches(at, latches) => TapRow::Latches(at, latches),
            WaitingRow::Failed(line, direction) => TapRow::Failed(line, direction),
            WaitingRow::Command(stamp, wanted) => TapRow::Command(stamp, wanted),
            WaitingRow::Advice => TapRow::Advice(Box::new(self.reader.advices.pop().ok()?)),
            WaitingRow::Operator(button) => TapRow::Operator(button),
            WaitingRow::Polled(poll) => TapRow::Polled(poll),
        })
    }
}

impl TapRows {
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
            tap.push(WaitingRow::Failed(self.line, direction));
        }
    }
}

impl<T: DatagramReceiver> DatagramReceiver for Tapped<T> {
    type Error = T::Error;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, T::Error> {
        let received = self.carrier.receive(buffer).await.inspect_err(|_| self.failed(Direction::Read))?;
        if let (Some(tap), Some(bytes)) = (&self.tap, buffer.get(..received.length)) {
            tap.delivered(Some(received.arrival), self.line, bytes);
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
            tap.delivered(None, self.line, bytes);
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
        // No device of the robot uses identifiers that the tape cannot hold.
        if let (Some(tap), Some(id)) = (&self.tap, frame_identifier(&frame)) {
            let mut bytes = [0; FRAME_BYTES];
            let frame_bytes = id.to_le_bytes().into_iter().chain(frame.payload().iter().copied());
            let length = bytes.iter_mut().zip(frame_bytes).map(|(place, byte)| *place = byte).count();
            tap.delivered(None, self.line, bytes.get(..length).unwrap_or_default());
        }
        Ok(frame)
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), T::Error> {
        if let Some(tap) = &self.tap {
            tap.push(WaitingRow::Sent(clock::now(), *frame));
        }
        self.carrier.send(frame).await.inspect_err(|_| self.failed(Direction::Write))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unread_queue_counts_lost_rows() {
        let (tap, mut rows) = tap();
        for index in 0..ROWS_MAX + 5 {
            tap.delivered(None, TapeLine::Scanner, &index.to_le_bytes());
        }
        assert_eq!(rows.lost(), 5);
        assert_eq!(std::iter::from_fn(|| rows.next()).count(), ROWS_MAX);
    }

    #[test]
    fn bytes_beyond_the_capacity_are_counted() {
        let (tap, mut rows) = tap();
        let datagram = [7; 1_206];
        let fitting = BYTES_MAX / datagram.len();
        (0..fitting + 3).for_each(|_| tap.delivered(None, TapeLine::Lidar, &datagram));
        tap.began(Stamp::ZERO);
        assert_eq!(rows.lost(), 3);
        let kept = std::iter::from_fn(|| rows.next()).collect::<Vec<_>>();
        assert_eq!((kept.len(), kept.last()), (fitting + 1, Some(&TapRow::Began(Stamp::ZERO))));
    }

    /// The thread of the guard ring puts everything into the queue without asking the allocator for memory.
    #[test]
    fn listened_lines_allocate_nothing() {
        let pipe = floorguard_host::carriers::CanPipe::default();
        let (tap, mut rows) = tap();
        let mut bus = Tapped::new(pipe.clone(), TapeLine::Can, Some(tap.clone()));
        pipe.push(CanFrame::standard(0x181, &[1, 2, 3]));
        let advice = Advice { speed_limit_mps: Some(0.25), ..Advice::default() };
        let used = allocation_counter::measure(|| {
            tap.delivered(None, TapeLine::Lidar, &[1; 1_206]);
            tap.input(GuardInput::Advice(&advice));
            tap.polled(Poll { task: GuardTask::Lidar, at: Stamp::ZERO, decisions: 1, decision: None });
            assert!(embassy_futures::block_on(bus.receive()).is_ok());
        });
        assert_eq!(used.count_total, 0, "{used:?}");
        let TapRow::Delivered { bytes, .. } = rows.next().unwrap() else { panic!("bytes first") };
        assert_eq!(bytes, [1; 1_206]);
        assert_eq!(rows.next(), Some(TapRow::Advice(Box::new(advice))));
        assert_eq!(std::iter::from_fn(|| rows.next()).count(), 2);
    }

    #[test]
    fn a_can_frame_passes_and_is_heard() {
        let pipe = floorguard_host::carriers::CanPipe::default();
        let (tap, mut rows) = tap();
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
