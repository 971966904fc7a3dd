//! Lines in memory: the player fills them, the tasks read them.

use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use core::future::poll_fn;
use core::task::{Poll, Waker};

use embedded_io_async::{ErrorType, Read, Write};
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::io::{CanBus, DatagramReceiver, Received};
use floorguard_types::time::Stamp;
use heapless::Deque;

/// A queue with one waiting reader. Everything is read before more arrives: an overflow is a mistake in the player.
struct Line<T, const N: usize> {
    queue: RefCell<Deque<T, N>>,
    reader: Cell<Option<Waker>>,
}

impl<T, const N: usize> Line<T, N> {
    const fn new() -> Self {
        Self { queue: RefCell::new(Deque::new()), reader: Cell::new(None) }
    }

    fn push(&self, element: T) {
        assert!(self.queue.borrow_mut().push_back(element).is_ok(), "a line holds at most {N} elements");
    }

    fn wake(&self) {
        if let Some(reader) = self.reader.take() {
            reader.wake();
        }
    }

    async fn next(&self) -> T {
        poll_fn(|context| match self.queue.borrow_mut().pop_front() {
            Some(element) => Poll::Ready(element),
            None => {
                self.reader.set(Some(context.waker().clone()));
                Poll::Pending
            }
        })
        .await
    }
}

/// Lidar datagrams, which stay on the tape.
pub struct LidarLine(Line<(Stamp, &'static [u8]), 32>);

impl LidarLine {
    /// Nothing there.
    pub const fn new() -> Self {
        Self(Line::new())
    }

    /// A datagram arrives.
    pub fn push(&self, arrival: Stamp, datagram: &'static [u8]) {
        self.0.push((arrival, datagram));
        self.0.wake();
    }
}

impl DatagramReceiver for &LidarLine {
    type Error = Infallible;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, Infallible> {
        let (arrival, datagram) = self.0.next().await;
        let length = datagram.len().min(buffer.len());
        buffer[..length].copy_from_slice(&datagram[..length]);
        Ok(Received { length, arrival })
    }
}

/// Bytes of a serial line; what is written to it is dropped, because the tape knows the answers.
pub struct SerialLine(Line<u8, 4_096>);

impl SerialLine {
    /// Nothing there.
    pub const fn new() -> Self {
        Self(Line::new())
    }

    /// Bytes arrive.
    pub fn push(&self, bytes: &[u8]) {
        for byte in bytes {
            self.0.push(*byte);
        }
        self.0.wake();
    }
}

impl ErrorType for &SerialLine {
    type Error = Infallible;
}

impl Read for &SerialLine {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let Some((first, rest)) = buffer.split_first_mut() else { return Ok(0) };
        *first = self.0.next().await;
        let mut count = 1;
        for slot in rest {
            let Some(byte) = self.0.queue.borrow_mut().pop_front() else { break };
            *slot = byte;
            count += 1;
        }
        Ok(count)
    }
}

impl Write for &SerialLine {
    async fn write(&mut self, buffer: &[u8]) -> Result<usize, Infallible> {
        Ok(buffer.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// The CAN bus: what the robot sends is kept until the player has looked at it.
pub struct CanLine {
    received: Line<CanFrame, 256>,
    sent: RefCell<Deque<CanFrame, 64>>,
}

impl CanLine {
    /// Nothing there.
    pub const fn new() -> Self {
        Self { received: Line::new(), sent: RefCell::new(Deque::new()) }
    }

    /// A frame arrives.
    pub fn push(&self, frame: CanFrame) {
        self.received.push(frame);
        self.received.wake();
    }

    /// The next frame that the robot has sent.
    pub fn sent(&self) -> Option<CanFrame> {
        self.sent.borrow_mut().pop_front()
    }
}

impl CanBus for &CanLine {
    type Error = Infallible;

    async fn receive(&mut self) -> Result<CanFrame, Infallible> {
        Ok(self.received.next().await)
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), Infallible> {
        assert!(self.sent.borrow_mut().push_back(*frame).is_ok(), "more frames than a bus can carry");
        Ok(())
    }
}
