//! A TCP connection to a device that may be absent at the start, be unplugged, and come back.
//!
//! A connection takes seconds where nobody answers: a thread of its own tries, so that the other tasks go on meanwhile.

use std::io;
use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use std::time::Duration;

use embassy_time::Timer;
use embedded_io_async::{ErrorType, Read, Write};

use crate::executor::Source;

/// Pause between two attempts to connect, and between two looks whether one has succeeded.
const RETRY: Duration = Duration::from_millis(250);
/// A device on a robot answers at once or not at all.
const CONNECT: Duration = Duration::from_secs(1);

/// A connection that is made again whenever it fails. Use it on the thread that made it.
pub struct ReconnectingStream {
    address: SocketAddr,
    stream: Option<Source<TcpStream>>,
    attempt: Option<Receiver<TcpStream>>,
    losses: u32,
}

impl ReconnectingStream {
    /// Not connected yet: reading connects.
    #[must_use]
    pub const fn new(address: SocketAddr) -> Self {
        Self { address, stream: None, attempt: None, losses: 0 }
    }

    /// Times that the connection was lost.
    #[must_use]
    pub const fn losses(&self) -> u32 {
        self.losses
    }

    fn lose(&mut self, error: io::Error) -> io::Error {
        self.stream = None;
        self.losses = self.losses.saturating_add(1);
        error
    }

    /// Begins an attempt where there is none, and takes what it has made.
    fn connect(&mut self) {
        let address = self.address;
        let attempt = self.attempt.get_or_insert_with(|| {
            let (made, attempt) = channel();
            thread::spawn(move || {
                if let Ok(stream) = TcpStream::connect_timeout(&address, CONNECT) {
                    // Who wanted it may have ended meanwhile.
                    let _ = made.send(stream);
                } else {
                    thread::sleep(RETRY);
                }
            });
            attempt
        });
        match attempt.try_recv() {
            Ok(stream) => {
                self.attempt = None;
                let is_ready = stream.set_nonblocking(true).and_then(|()| stream.set_nodelay(true));
                self.stream = is_ready.and_then(|()| Source::new(stream)).ok();
            }
            Err(TryRecvError::Disconnected) => self.attempt = None,
            Err(TryRecvError::Empty) => {}
        }
    }
}

impl ErrorType for ReconnectingStream {
    type Error = io::Error;
}

impl Read for ReconnectingStream {
    async fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            if self.stream.is_none() {
                self.connect();
            }
            let Some(stream) = &mut self.stream else {
                Timer::after_millis(RETRY.as_millis() as u64).await;
                continue;
            };
            let read = stream.read_ready(|mut file| io::Read::read(&mut file, &mut *buffer)).await;
            return match read {
                Ok(0) => Err(self.lose(io::Error::from(io::ErrorKind::UnexpectedEof))),
                Ok(count) => Ok(count),
                Err(error) => Err(self.lose(error)),
            };
        }
    }
}

impl Write for ReconnectingStream {
    async fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let Some(stream) = &mut self.stream else { return Err(io::Error::from(io::ErrorKind::NotConnected)) };
        match stream.write_ready(|mut file| io::Write::write(&mut file, buffer)).await {
            Ok(count) => Ok(count),
            Err(error) => Err(self.lose(error)),
        }
    }

    async fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::{StopFlag, run_until};
    use std::io::Write as _;
    use std::net::TcpListener;

    /// The device ends the connection; its loss is reported once, and the next connection is read again.
    #[test]
    fn a_connection_that_comes_back_is_read_again() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let device = thread::spawn(move || {
            for _ in 0..2 {
                let (mut stream, _) = listener.accept().unwrap();
                stream.write_all(b"bytes").unwrap();
            }
        });
        let flag = StopFlag::default();
        let mut outcomes = Vec::new();
        run_until(&flag, |tasks| {
            let (flag, outcomes) = (&flag, &mut outcomes);
            tasks.spawn(async move {
                let mut stream = ReconnectingStream::new(address);
                let mut buffer = [0; 8];
                assert!(stream.write(b"x").await.is_err());
                while outcomes.iter().filter(|is_read| **is_read).count() < 2 {
                    outcomes
                        .push(stream.read(&mut buffer).await.is_ok_and(|count| &buffer[..count] == b"bytes"));
                }
                assert_eq!(stream.losses(), 1);
                flag.stop();
            });
            Ok(())
        })
        .unwrap();
        device.join().unwrap();
        assert_eq!(outcomes, [true, false, true]);
    }
}
