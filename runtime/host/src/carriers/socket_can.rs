//! SocketCAN: the kernel's CAN interfaces.
//!
//! An interface that goes down or is unplugged gives an error once; the next use opens it again, so that a cable that
//! comes back is found without a restart. What the guard makes of the error is its business.

use std::io;
use std::time::{Duration, Instant};

use embedded_can::Frame as _;
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::io::CanBus;
use socketcan::{CanErrorFrame, CanFrame as KernelFrame, CanSocket, Socket, SocketOptions};

use crate::executor::Source;

/// Pause between two attempts to open.
const RETRY: Duration = Duration::from_millis(250);

/// A CAN interface of the kernel. Use it on the thread that made it.
pub struct SocketCanBus {
    interface: String,
    socket: Option<Source<CanSocket>>,
    tried: Option<Instant>,
    losses: u32,
    error_frames: u32,
}

impl SocketCanBus {
    /// A bus that is opened with the first use.
    #[must_use]
    pub const fn new(interface: String) -> Self {
        Self { interface, socket: None, tried: None, losses: 0, error_frames: 0 }
    }

    /// Opens it now, to learn whether it is there.
    ///
    /// # Errors
    /// No interface of that name, or it is down.
    pub fn open(&mut self) -> io::Result<()> {
        if self.socket.is_some() {
            return Ok(());
        }
        if self.tried.is_some_and(|tried| tried.elapsed() < RETRY) {
            return Err(io::Error::from(io::ErrorKind::NotConnected));
        }
        self.tried = Some(Instant::now());
        let socket = CanSocket::open(&self.interface)
            .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", self.interface)))?;
        socket.set_nonblocking(true)?;
        socket.set_error_filter_accept_all()?;
        self.socket = Some(Source::new(socket)?);
        Ok(())
    }

    /// Times that the interface was lost.
    #[must_use]
    pub const fn losses(&self) -> u32 {
        self.losses
    }

    /// Error frames that the controller reported.
    #[must_use]
    pub const fn error_frames(&self) -> u32 {
        self.error_frames
    }

    fn lose(&mut self, error: io::Error) -> io::Error {
        self.socket = None;
        self.losses = self.losses.saturating_add(1);
        error
    }

    async fn next_frame(&mut self) -> io::Result<KernelFrame> {
        self.open()?;
        let Some(socket) = &self.socket else { return Err(io::Error::from(io::ErrorKind::NotConnected)) };
        match socket.read_ready(CanSocket::read_frame).await {
            Ok(frame) => Ok(frame),
            Err(error) => Err(self.lose(error)),
        }
    }
}

impl CanBus for SocketCanBus {
    type Error = io::Error;

    async fn receive(&mut self) -> io::Result<CanFrame> {
        loop {
            let frame = self.next_frame().await?;
            if let KernelFrame::Error(error) = &frame {
                self.error_frames = self.error_frames.saturating_add(1);
                if is_bus_off(*error) {
                    return Err(io::Error::other("the controller is bus-off"));
                }
            } else if let Some(frame) = from_kernel(&frame) {
                return Ok(frame);
            }
        }
    }

    async fn send(&mut self, frame: &CanFrame) -> io::Result<()> {
        self.open()?;
        let Some(kernel) = to_kernel(frame) else { return Err(io::Error::from(io::ErrorKind::InvalidInput)) };
        let Some(socket) = &self.socket else { return Err(io::Error::from(io::ErrorKind::NotConnected)) };
        match socket.write_ready(|socket| socket.write_frame(&kernel)).await {
            Ok(()) => Ok(()),
            // The transmit queue of the interface is full: the frame is lost, the interface is not.
            Err(error) if error.raw_os_error() == Some(rustix::io::Errno::NOBUFS.raw_os_error()) => {
                Err(error)
            }
            Err(error) => Err(self.lose(error)),
        }
    }
}

fn is_bus_off(frame: CanErrorFrame) -> bool {
    frame.into_error().is_bus_off()
}

fn from_kernel(frame: &KernelFrame) -> Option<CanFrame> {
    if frame.is_remote_frame() {
        return CanFrame::new_remote(frame.id(), frame.dlc());
    }
    CanFrame::new(frame.id(), frame.data())
}

fn to_kernel(frame: &CanFrame) -> Option<KernelFrame> {
    if frame.is_remote_frame() {
        return KernelFrame::new_remote(frame.id(), frame.dlc());
    }
    KernelFrame::new(frame.id(), frame.payload())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_survive_the_kernel_round_trip() {
        let remote = CanFrame::new_remote(embedded_can::StandardId::new(0x701).unwrap(), 1).unwrap();
        let extended = CanFrame::extended(0x01AB_CDEF, &[1, 2, 3]).unwrap();
        for frame in [
            CanFrame::standard(0x181, &[1, 2, 3, 4, 5, 6, 7, 8]),
            CanFrame::standard(0x80, &[]),
            remote,
            extended,
        ] {
            assert_eq!(from_kernel(&to_kernel(&frame).unwrap()), Some(frame));
        }
    }

    #[test]
    fn missing_interface_is_named_and_not_retried() {
        let mut bus = SocketCanBus::new("fgnone0".to_owned());
        let error = bus.open().unwrap_err();
        // A kernel without CAN refuses the socket itself.
        assert!(error.to_string().starts_with("fgnone0: "), "{error}");
        assert_eq!(bus.open().unwrap_err().kind(), io::ErrorKind::NotConnected);
    }
}
