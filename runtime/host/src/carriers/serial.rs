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

use serialport::{SerialPort, TTYPort};

use crate::executor::Source;

/// A serial line without blocking. Use it on the thread that made it.
pub struct SerialLine(Source<OwnedFd>);

impl SerialLine {
    /// Opens a device with eight data bits, no parity, one stop bit and no flow control.
    ///
    /// # Errors
    /// The device is absent, in use, or cannot do the speed.
    pub fn open(device: &Path, baud: u32) -> io::Result<Self> {
        Self::taken_over(opened(device, baud)?)
    }

    /// The same with the line "data terminal ready" low, by which an RPLidar's adapter sets its motor going: systems raise it when they
    /// open a device. An adapter without that line is taken as it is.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_with_motor(device: &Path, baud: u32) -> io::Result<Self> {
        let mut port = opened(device, baud)?;
        let _has_no_such_line = port.write_data_terminal_ready(false);
        Self::taken_over(port)
    }

    fn taken_over(port: TTYPort) -> io::Result<Self> {
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

fn opened(device: &Path, baud: u32) -> io::Result<TTYPort> {
    let port = serialport::new(device.to_string_lossy(), baud).open_native();
    port.map_err(|error| io::Error::new(io::ErrorKind::NotFound, format!("{}: {error}", device.display())))
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
    use crate::executor::{StopFlag, TaskSet, run_until};
    use embassy_futures::yield_now;
    use floorguard_runtime::io::{CanBus, DatagramReceiver, SlcanBus};
    use std::cell::{Cell, RefCell};
    use std::net::UdpSocket;
    use std::os::unix::net::UnixStream;

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

    /// How many pieces a reader takes of what waits on its line, and the most that it takes before another task has its turn.
    fn turns<'a>(waiting: &[u8], reader: impl AsyncFnOnce(SerialLine, &Cell<u32>) + 'a) -> (u32, u32) {
        let (here, mut there) = UnixStream::pair().unwrap();
        io::Write::write_all(&mut there, waiting).unwrap();
        let line = SerialLine::from_descriptor(here.into()).unwrap();
        let (taken, most_at_once) = (Cell::new(0), Cell::new(0));
        let mut tasks = TaskSet::new();
        tasks.spawn(reader(line, &taken));
        tasks.spawn(async {
            let mut before = 0;
            // As many turns as there are bytes are enough for both.
            for _ in waiting {
                yield_now().await;
                most_at_once.set(most_at_once.get().max(taken.get() - before));
                before = taken.get();
            }
        });
        tasks.poll_until_quiet().unwrap();
        drop(tasks);
        (taken.get(), most_at_once.get())
    }

    /// A device that never pauses is read piece by piece, and every other task has its turn in between.
    #[test]
    fn flooded_line_takes_turns_with_other_tasks() {
        let read = turns(&[0; 50], async |mut line, taken| {
            while line.read(&mut [0]).await.is_ok() {
                taken.set(taken.get() + 1);
            }
        });
        assert_eq!(read, (50, 1));
    }

    /// An adapter hands on at most what one read of its line has brought: 128 bytes, here six frames and a part.
    #[test]
    fn busy_adapter_takes_turns_with_other_tasks() {
        let (taken, most_at_once) = turns(&b"t18180102030405060708\r".repeat(60), async |line, taken| {
            let mut bus = SlcanBus::new(line);
            while bus.receive().await.is_ok() {
                taken.set(taken.get() + 1);
            }
        });
        assert_eq!(taken, 60);
        assert!((5..=6).contains(&most_at_once), "{most_at_once} frames at once");
    }
}
