//! UDP sockets of Linux for the epoll loop.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::mpsc::Sender;

use floorguard_runtime::clock;
use floorguard_runtime::io::{DatagramReceiver, Received};

use crate::configuration::SenderAddress;
use crate::executor::Source;

/// So many senders are told apart; whoever comes later is left unnamed.
const SENDERS_MAX: usize = 8;

/// Who is listened to on a port, and who hears of others.
#[derive(Clone, Debug, Default)]
pub struct Listening {
    /// The section of `robot.toml` that names the device.
    pub section: &'static str,
    /// The only sender that is listened to.
    pub only: Option<SenderAddress>,
    /// Whoever tells people; it never holds up the one that receives.
    pub notices: Option<Sender<String>>,
}

/// A bound UDP port. Use it on the thread that made it.
pub struct UdpReceiver {
    socket: Source<UdpSocket>,
    listening: Listening,
    known: Vec<SocketAddr>,
}

impl UdpReceiver {
    /// Binds a port.
    ///
    /// # Errors
    /// The address is in use or not ours.
    pub fn bind(address: SocketAddr) -> io::Result<Self> {
        let socket = UdpSocket::bind(address)?;
        Self::from_socket(socket, Listening::default())
    }

    /// Takes over a bound socket.
    ///
    /// # Errors
    /// The socket cannot be watched.
    pub fn from_socket(socket: UdpSocket, listening: Listening) -> io::Result<Self> {
        socket.set_nonblocking(true)?;
        Ok(Self { socket: Source::new(socket)?, listening, known: Vec::with_capacity(SENDERS_MAX) })
    }

    /// Whether a sender is listened to. Once for each, people hear of one that should not be there.
    fn hears(&mut self, from: SocketAddr) -> bool {
        let Listening { section, only, notices } = &self.listening;
        let is_heard = only.is_none_or(|only| only.is(from));
        if self.known.contains(&from) || self.known.len() >= SENDERS_MAX {
            return is_heard;
        }
        self.known.push(from);
        let what = match (only, self.known.first()) {
            (Some(only), _) if !is_heard => Some(format!(
                "[{section}] datagrams of {from} are left out: only sender {only} is listened to"
            )),
            (None, Some(first)) if *first != from => Some(format!(
                "[{section}] datagrams come from {first} and from {from}, too; unplug what is not the robot's, or name the \
                 device: sender = \"{}\"",
                first.ip()
            )),
            _ => None,
        };
        if let (Some(what), Some(notices)) = (what, notices) {
            // Whoever listened has ended: so does the robot.
            let _ = notices.send(what);
        }
        is_heard
    }

    /// The address it is bound to.
    ///
    /// # Errors
    /// The kernel does not say.
    pub fn local_address(&self) -> io::Result<SocketAddr> {
        self.socket.file.local_addr()
    }
}

impl DatagramReceiver for UdpReceiver {
    type Error = io::Error;

    async fn receive(&mut self, buffer: &mut [u8]) -> io::Result<Received> {
        loop {
            let (length, from) = self.socket.read_ready(|socket| socket.recv_from(buffer)).await?;
            let arrival = clock::now();
            if self.hears(from) {
                return Ok(Received { length, arrival });
            }
        }
    }
}
