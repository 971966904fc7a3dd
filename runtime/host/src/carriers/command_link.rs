//! The link to the program that drives the robot from outside: a UDP port or a serial line, by the same frames.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::mpsc::Sender;

use floorguard_configuration::{CommandAddress, CommandConfiguration};
use floorguard_runtime::clock;
use floorguard_runtime::io::{FramePort, LinePort, LinePortError, PortFrame};

use super::reconnect::ReconnectingLine;
use super::socket::Listening;
use crate::executor::{Source, StopFlag};

/// A bound UDP port that answers whoever holds the robot, and tells others who only listen.
pub struct UdpFramePort {
    socket: Source<UdpSocket>,
    listening: Listening,
    subscribers: Vec<SocketAddr>,
    newest: Option<SocketAddr>,
    followed: Option<SocketAddr>,
}

impl UdpFramePort {
    /// Takes over a bound socket. Use it on the thread that made it.
    ///
    /// # Errors
    /// The socket cannot be watched.
    pub fn from_socket(
        socket: UdpSocket,
        listening: Listening,
        subscribers: Vec<SocketAddr>,
    ) -> io::Result<Self> {
        socket.set_nonblocking(true)?;
        Ok(Self { socket: Source::new(socket)?, listening, subscribers, newest: None, followed: None })
    }
}

/// The same number for the same address within a run.
fn number_of(address: SocketAddr) -> u64 {
    let mut hasher = DefaultHasher::new();
    address.hash(&mut hasher);
    hasher.finish()
}

impl FramePort for UdpFramePort {
    type Error = io::Error;

    async fn receive(&mut self, buffer: &mut [u8]) -> io::Result<PortFrame> {
        loop {
            let (length, from) = self.socket.read_ready(|socket| socket.recv_from(buffer)).await?;
            let arrival = clock::now();
            if self.listening.hears(from) {
                self.newest = Some(from);
                return Ok(PortFrame { length, arrival, peer: number_of(from) });
            }
        }
    }

    fn follow(&mut self) {
        self.followed = self.newest;
    }

    async fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        let mut failed = None;
        for to in self.followed.iter().chain(&self.subscribers) {
            // A listener that is not there is its own loss: the others still get theirs.
            failed = self.socket.file.send_to(frame, to).err().or(failed);
        }
        failed.map_or(Ok(()), Err)
    }
}

/// What `[command]` names, and the end of its say: from `closed` on nothing that comes is heard.
pub struct CommandLink {
    carrier: Carrier,
    closed: StopFlag,
}

enum Carrier {
    Port(UdpFramePort),
    Line(LinePort<ReconnectingLine>),
}

/// What `[command]` names, before the guard's thread opens it.
#[derive(Debug)]
pub struct BoundCommand {
    /// A port that is bound already, and its accepted sender.
    port: Option<(UdpSocket, Listening)>,
    configuration: CommandConfiguration,
}

impl BoundCommand {
    /// Binds the port, if it is one.
    ///
    /// # Errors
    /// The port is taken or not ours.
    pub fn bind(configuration: &CommandConfiguration) -> io::Result<Self> {
        let port = match &configuration.address {
            CommandAddress::Datagrams(address) => {
                let listening =
                    Listening { section: "command", only: address.sender, ..Listening::default() };
                Some((UdpSocket::bind(address.local)?, listening))
            }
            CommandAddress::Serial(_) => None,
        };
        Ok(Self { port, configuration: configuration.clone() })
    }

    /// The port that is bound, if it is one.
    #[must_use]
    pub fn local_address(&self) -> Option<SocketAddr> {
        self.port.as_ref().and_then(|(socket, _)| socket.local_addr().ok())
    }

    /// Who hears of senders that should not be there.
    pub fn notify(&mut self, notices: Sender<String>) {
        if let Some((_, listening)) = &mut self.port {
            listening.notices = Some(notices);
        }
    }

    /// What the robot's file says.
    #[must_use]
    pub const fn configuration(&self) -> &CommandConfiguration {
        &self.configuration
    }

    /// Opens it on the calling thread, and says why it cannot be used yet, if so. Nothing is heard once `closed` is stopped.
    ///
    /// # Errors
    /// The socket cannot be watched.
    pub fn open(self, closed: StopFlag) -> io::Result<(CommandLink, Option<io::Error>)> {
        let (carrier, problem) = match (self.port, self.configuration.address) {
            (Some((socket, listening)), _) => {
                let port = UdpFramePort::from_socket(socket, listening, self.configuration.subscribers)?;
                (Carrier::Port(port), None)
            }
            (None, CommandAddress::Serial(line)) => {
                let (line, problem) = ReconnectingLine::new(line.device, line.baud);
                (Carrier::Line(LinePort::new(line)), problem)
            }
            (None, CommandAddress::Datagrams(_)) => return Err(io::ErrorKind::NotConnected.into()),
        };
        Ok((CommandLink { carrier, closed }, problem))
    }
}

impl FramePort for CommandLink {
    type Error = io::Error;

    async fn receive(&mut self, buffer: &mut [u8]) -> io::Result<PortFrame> {
        loop {
            let frame = match &mut self.carrier {
                Carrier::Port(port) => port.receive(buffer).await?,
                Carrier::Line(line) => line.receive(buffer).await.map_err(plain)?,
            };
            if !self.closed.is_stopped() {
                return Ok(frame);
            }
        }
    }

    fn follow(&mut self) {
        match &mut self.carrier {
            Carrier::Port(port) => port.follow(),
            Carrier::Line(line) => line.follow(),
        }
    }

    async fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        match &mut self.carrier {
            Carrier::Port(port) => port.send(frame).await,
            Carrier::Line(line) => line.send(frame).await.map_err(plain),
        }
    }
}

fn plain(error: LinePortError<io::Error>) -> io::Error {
    match error {
        LinePortError::Line(error) => error,
        LinePortError::Ended => io::Error::from(io::ErrorKind::UnexpectedEof),
    }
}
