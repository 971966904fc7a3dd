//! In-process carriers for the virtual world: one thread, no system calls, no loss of their own.
//!
//! Faults are the simulator's business; a pipe only refuses to grow without bound when nobody reads.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;
use std::task::{Poll, Waker};

use embedded_io_async::{ErrorType, Read, Write};
use floorguard_runtime::io::{DatagramReceiver, Received};
use floorguard_types::time::Stamp;

/// Bytes a pipe holds for a late reader: one second of a 500 kbaud line.
const PIPE_BYTES: usize = 50_000;
/// Datagrams held for a late reader: the kernel's usual socket buffer holds about as many.
const PIPE_DATAGRAMS: usize = 128;

#[derive(Default)]
struct Shared {
    bytes: VecDeque<u8>,
    reader: Option<Waker>,
    lost_bytes: u64,
}

/// The end that the task reads.
pub struct PipeReader(Rc<RefCell<Shared>>);

/// The end that the other side writes.
#[derive(Clone)]
pub struct PipeWriter(Rc<RefCell<Shared>>);

/// A byte stream in one direction.
#[must_use]
pub fn byte_pipe() -> (PipeWriter, PipeReader) {
    let shared = Rc::new(RefCell::new(Shared::default()));
    (PipeWriter(Rc::clone(&shared)), PipeReader(shared))
}

impl PipeWriter {
    /// Appends bytes and wakes the reader; bytes beyond the capacity are lost and counted, as on a UART.
    pub fn push(&self, bytes: &[u8]) {
        let shared = &mut *self.0.borrow_mut();
        let kept = bytes.len().min(PIPE_BYTES - shared.bytes.len());
        shared.bytes.extend(bytes.iter().take(kept));
        shared.lost_bytes += (bytes.len() - kept) as u64;
        if let Some(reader) = shared.reader.take() {
            reader.wake();
        }
    }

    /// Bytes that found the pipe full.
    #[must_use]
    pub fn lost_bytes(&self) -> u64 {
        self.0.borrow().lost_bytes
    }
}

impl PipeReader {
    /// Takes everything that is there.
    #[must_use]
    pub fn drain(&self) -> Vec<u8> {
        self.0.borrow_mut().bytes.drain(..).collect()
    }
}

impl ErrorType for PipeReader {
    type Error = Infallible;
}

impl Read for PipeReader {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        core::future::poll_fn(|context| {
            let shared = &mut *self.0.borrow_mut();
            if shared.bytes.is_empty() && !buffer.is_empty() {
                shared.reader = Some(context.waker().clone());
                return Poll::Pending;
            }
            let count = buffer.len().min(shared.bytes.len());
            for (slot, byte) in buffer.iter_mut().zip(shared.bytes.drain(..count)) {
                *slot = byte;
            }
            Poll::Ready(Ok(count))
        })
        .await
    }
}

impl ErrorType for PipeWriter {
    type Error = Infallible;
}

impl Write for PipeWriter {
    async fn write(&mut self, buffer: &[u8]) -> Result<usize, Infallible> {
        self.push(buffer);
        Ok(buffer.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A line in both directions.
pub struct DuplexPipe {
    /// What the other side writes.
    pub reader: PipeReader,
    /// What the other side reads.
    pub writer: PipeWriter,
}

impl ErrorType for DuplexPipe {
    type Error = Infallible;
}

impl Read for DuplexPipe {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        self.reader.read(buffer).await
    }
}

impl Write for DuplexPipe {
    async fn write(&mut self, buffer: &[u8]) -> Result<usize, Infallible> {
        self.writer.write(buffer).await
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

#[derive(Default)]
struct SharedDatagrams {
    datagrams: VecDeque<(Stamp, Vec<u8>)>,
    reader: Option<Waker>,
    lost: u64,
}

/// A UDP port in the same process. Clones share the port.
#[derive(Clone, Default)]
pub struct DatagramPipe(Rc<RefCell<SharedDatagrams>>);

impl DatagramPipe {
    /// Delivers a datagram.
    pub fn push(&self, arrival: Stamp, datagram: Vec<u8>) {
        let shared = &mut *self.0.borrow_mut();
        if shared.datagrams.len() >= PIPE_DATAGRAMS {
            shared.lost += 1;
        } else {
            shared.datagrams.push_back((arrival, datagram));
        }
        if let Some(reader) = shared.reader.take() {
            reader.wake();
        }
    }

    /// Datagrams that found the buffer full.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.0.borrow().lost
    }
}

impl DatagramReceiver for DatagramPipe {
    type Error = Infallible;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, Infallible> {
        core::future::poll_fn(|context| {
            let shared = &mut *self.0.borrow_mut();
            let Some((arrival, datagram)) = shared.datagrams.pop_front() else {
                shared.reader = Some(context.waker().clone());
                return Poll::Pending;
            };
            let length = datagram.len().min(buffer.len());
            buffer[..length].copy_from_slice(&datagram[..length]);
            Poll::Ready(Ok(Received { length, arrival }))
        })
        .await
    }
}
