//! UDP sockets of Linux for the epoll loop.

use std::io;
use std::net::{SocketAddr, UdpSocket};

use floorguard_runtime::clock;
use floorguard_runtime::io::{DatagramReceiver, Received};

use crate::executor::Source;

/// A bound UDP port. Use it on the thread that made it.
pub struct UdpReceiver(Source<UdpSocket>);

impl UdpReceiver {
    /// Binds a port.
    ///
    /// # Errors
    /// The address is in use or not ours.
    pub fn bind(address: SocketAddr) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        Self::from_socket(socket)
    }

    /// Takes over a bound socket.
    ///
    /// # Errors
    /// The socket cannot be watched.
    pub fn from_socket(socket: UdpSocket) -> io::Result<Self> {
        socket.set_nonblocking(true)?;
        Source::new(socket).map(Self)
    }

    /// The address it is bound to.
    ///
    /// # Errors
    /// The kernel does not say.
    pub fn local_address(&self) -> io::Result<SocketAddr> {
        self.0.file.local_addr()
    }
}

impl DatagramReceiver for UdpReceiver {
    type Error = io::Error;

    async fn receive(&mut self, buffer: &mut [u8]) -> io::Result<Received> {
        let length = self.0.read_ready(|socket| socket.recv(buffer)).await?;
        Ok(Received { length, arrival: clock::now() })
    }
}
