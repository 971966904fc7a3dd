//! A line that gives to its task what the recording says that the task got, in the same portions, and fails where it failed.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::io;
use std::rc::Rc;
use std::task::Poll;

use embedded_io_async::{ErrorType, Read, Write};
use floorguard_drivers::can::CanFrame;
use floorguard_robot::assembly::Direction;
use floorguard_runtime::io::{CanBus, DatagramReceiver, Received};
use floorguard_runtime::tape::frame_of;
use floorguard_types::time::Stamp;

#[derive(Default)]
struct Script {
    /// Arrival and bytes, or a failure.
    to_robot: VecDeque<Option<(Stamp, Vec<u8>)>>,
    failing_writes: usize,
    from_robot: Vec<CanFrame>,
}

/// Both ends. Clones share it. Nothing wakes its reader: the recorded order says when the task is polled.
#[derive(Clone, Default)]
pub(super) struct ScriptedLine(Rc<RefCell<Script>>);

impl ScriptedLine {
    /// The task gets these bytes with its next read.
    pub fn deliver(&self, arrival: Stamp, bytes: Vec<u8>) {
        self.0.borrow_mut().to_robot.push_back(Some((arrival, bytes)));
    }

    /// The next read, or the next write, fails.
    pub fn fail(&self, direction: Direction) {
        let script = &mut *self.0.borrow_mut();
        match direction {
            Direction::Read => script.to_robot.push_back(None),
            Direction::Write => script.failing_writes += 1,
        }
    }

    /// Frames that the robot's computer has sent since the last call.
    pub fn drain(&self) -> Vec<CanFrame> {
        std::mem::take(&mut self.0.borrow_mut().from_robot)
    }

    async fn next(&self) -> io::Result<(Stamp, Vec<u8>)> {
        std::future::poll_fn(|_| match self.0.borrow_mut().to_robot.pop_front() {
            Some(Some(delivery)) => Poll::Ready(Ok(delivery)),
            Some(None) => Poll::Ready(Err(io::Error::other("as recorded"))),
            None => Poll::Pending,
        })
        .await
    }

    fn written(&self) -> io::Result<()> {
        let script = &mut *self.0.borrow_mut();
        if script.failing_writes == 0 {
            return Ok(());
        }
        script.failing_writes -= 1;
        Err(io::Error::other("as recorded"))
    }
}

impl DatagramReceiver for ScriptedLine {
    type Error = io::Error;

    async fn receive(&mut self, buffer: &mut [u8]) -> io::Result<Received> {
        let (arrival, bytes) = self.next().await?;
        Ok(Received { length: copy(&bytes, buffer), arrival })
    }
}

impl ErrorType for ScriptedLine {
    type Error = io::Error;
}

impl Read for ScriptedLine {
    async fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let (arrival, bytes) = self.next().await?;
        let length = copy(&bytes, buffer);
        // A task of this version may read in shorter portions.
        if let Some(rest) = bytes.get(length..).filter(|rest| !rest.is_empty()) {
            self.0.borrow_mut().to_robot.push_front(Some((arrival, rest.to_vec())));
        }
        Ok(length)
    }
}

impl Write for ScriptedLine {
    async fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.written().map(|()| buffer.len())
    }

    async fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl CanBus for ScriptedLine {
    type Error = io::Error;

    async fn receive(&mut self) -> io::Result<CanFrame> {
        let (_, bytes) = self.next().await?;
        let (id, payload) = bytes.split_first_chunk::<2>().ok_or(io::ErrorKind::InvalidData)?;
        Ok(frame_of(u16::from_le_bytes(*id), payload))
    }

    async fn send(&mut self, frame: &CanFrame) -> io::Result<()> {
        // A frame that was refused was recorded as sent, too.
        self.0.borrow_mut().from_robot.push(*frame);
        self.written()
    }
}

/// As much as fits.
fn copy(bytes: &[u8], buffer: &mut [u8]) -> usize {
    let length = bytes.len().min(buffer.len());
    for (slot, byte) in buffer.iter_mut().zip(bytes) {
        *slot = *byte;
    }
    length
}
