//! Serial lines, and pseudo-terminals that look like them, for the epoll loop.
//!
//! `serialport` knows how to set speed and framing on Linux; its reads block, so the descriptor is taken out of it
//! and used without blocking.

use std::io;
use std::os::fd::{AsFd, FromRawFd, IntoRawFd, OwnedFd};
use std::path::{Path, PathBuf};

use embedded_io_async::{ErrorType, Read, Write};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use crate::executor::Source;

/// A serial line without blocking. Use it on the thread that made it.
pub struct SerialLine(Source<OwnedFd>);

impl SerialLine {
    /// Opens a device with eight data bits, no parity, one stop bit and no flow control.
    ///
    /// # Errors
    /// The device is absent, in use, or cannot do the speed.
    pub fn open(device: &Path, baud: u32) -> io::Result<Self> {
        let port = serialport::new(device.to_string_lossy(), baud).open_native().map_err(|error| {
            io::Error::new(io::ErrorKind::NotFound, format!("{}: {error}", device.display()))
        })?;
        let raw = port.into_raw_fd();
        // SAFETY: `into_raw_fd` hands over the only owner of an open descriptor.
        let descriptor = unsafe { OwnedFd::from_raw_fd(raw) };
        Self::from_descriptor(descriptor)
    }

    /// Takes over an open descriptor, for example the far end of a pseudo-terminal.
    ///
    /// # Errors
    /// The descriptor cannot be made non-blocking or watched.
    pub fn from_descriptor(descriptor: OwnedFd) -> io::Result<Self> {
        set_nonblocking(&descriptor)?;
        Source::new(descriptor).map(Self)
    }
}

impl ErrorType for SerialLine {
    type Error = io::Error;
}

impl Read for SerialLine {
    async fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read_ready(|line| Ok(rustix::io::read(line, &mut *buffer)?)).await
    }
}

impl Write for SerialLine {
    async fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0.write_ready(|line| Ok(rustix::io::write(line, buffer)?)).await
    }

    async fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The simulator's end of a pseudo-terminal and the device file for the other end.
pub struct PseudoTerminal {
    /// The simulator's end, non-blocking.
    pub near: OwnedFd,
    /// What to put after `serial:` or `slcan:`.
    pub device: PathBuf,
}

impl PseudoTerminal {
    /// A new pseudo-terminal in raw mode.
    ///
    /// # Errors
    /// The system has none left.
    pub fn open() -> io::Result<Self> {
        let near = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&near)?;
        unlockpt(&near)?;
        let mut settings = tcgetattr(&near)?;
        settings.make_raw();
        tcsetattr(&near, OptionalActions::Now, &settings)?;
        let name = ptsname(&near, Vec::new())?;
        set_nonblocking(&near)?;
        Ok(Self { near, device: PathBuf::from(name.to_string_lossy().into_owned()) })
    }
}

fn set_nonblocking(descriptor: impl AsFd) -> io::Result<()> {
    let flags = rustix::fs::fcntl_getfl(&descriptor)?;
    rustix::fs::fcntl_setfl(&descriptor, flags | rustix::fs::OFlags::NONBLOCK)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::carriers::UdpReceiver;
    use crate::executor::{StopFlag, run_until};
    use floorguard_runtime::io::DatagramReceiver;
    use std::cell::RefCell;
    use std::net::UdpSocket;

    /// Bytes cross a pseudo-terminal at the scanner's speed and a datagram crosses the loopback, both through epoll.
    #[test]
    fn bytes_arrive_through_the_epoll_loop() {
        let terminal = PseudoTerminal::open().unwrap();
        let all_bytes: Vec<u8> = (0..=255).collect();
        let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        let flag = StopFlag::default();
        let seen = RefCell::new((Vec::new(), 0));
        run_until(&flag, |tasks| {
            let mut line = SerialLine::open(&terminal.device, 500_000)?;
            let mut receiver = UdpReceiver::bind("127.0.0.1:0".parse().unwrap())?;
            let port = receiver.local_address()?;
            let (seen, flag) = (&seen, &flag);
            tasks.spawn(async move {
                let mut buffer = [0; 64];
                while seen.borrow().0.len() < 256 {
                    let count = line.read(&mut buffer).await.unwrap();
                    seen.borrow_mut().0.extend_from_slice(&buffer[..count]);
                }
                let received = receiver.receive(&mut [0; 1_300]).await.unwrap();
                seen.borrow_mut().1 = received.length;
                flag.stop();
            });
            let (near, all_bytes) = (&terminal.near, &all_bytes);
            let sender = &sender;
            tasks.spawn(async move {
                embassy_time::Timer::after_millis(5).await;
                rustix::io::write(near, all_bytes).unwrap();
                sender.send_to(&[7; 1_206], port).unwrap();
            });
            Ok(())
        })
        .unwrap();
        assert_eq!(*seen.borrow(), (all_bytes.clone(), 1_206));
    }
}
