//! Links by frames: to the program that drives the robot from outside, and to a base that takes velocities. A UDP port or a serial
//! line, the same frames on both.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::mpsc::Sender;

use floorguard_configuration::{
    BaseAddress, CommandAddress, CommandConfiguration, DatagramAddress, SerialAddress,
};
use floorguard_runtime::clock;
use floorguard_runtime::io::{FramePort, LinePort, LinePortError, PortFrame};

use super::reconnect::ReconnectingLine;
use super::socket::Listening;
use crate::executor::{Source, StopFlag};

/// A bound UDP port that answers the sender that holds the robot, and sends the same to others who only listen.
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

/// A link that `robot.toml` names. Once `closed` is stopped nothing that comes is heard.
pub struct FrameLink {
    carrier: Carrier,
    closed: StopFlag,
}

enum Carrier {
    Port(UdpFramePort),
    Line(LinePort<ReconnectingLine>),
}

/// The same before its thread opens it.
#[derive(Debug)]
pub enum BoundFrames {
    /// A port that is bound already, its accepted sender, and who gets everything that is sent.
    Port(UdpSocket, Listening, Vec<SocketAddr>),
    /// A serial line.
    Line(SerialAddress),
}

impl BoundFrames {
    /// What `[command]` names.
    ///
    /// # Errors
    /// The port is taken or not ours.
    pub fn command(configuration: &CommandConfiguration) -> io::Result<Self> {
        match &configuration.address {
            CommandAddress::Datagrams(address) => {
                Self::bind("command", address, configuration.subscribers.clone())
            }
            CommandAddress::Serial(line) => Ok(Self::Line(line.clone())),
            CommandAddress::Ros(topic) => {
                let missing = format!("[command] ros2:{}: no bridge to ROS 2 is open", topic.name);
                Err(io::Error::new(io::ErrorKind::Unsupported, missing))
            }
        }
    }

    /// What `[base]` names.
    ///
    /// # Errors
    /// The port is taken or not ours.
    pub fn base(address: &BaseAddress) -> io::Result<Self> {
        match address {
            BaseAddress::Datagrams(address, controller) => Self::bind("base", address, vec![*controller]),
            BaseAddress::Serial(line) => Ok(Self::Line(line.clone())),
        }
    }

    fn bind(
        section: &'static str,
        address: &DatagramAddress,
        subscribers: Vec<SocketAddr>,
    ) -> io::Result<Self> {
        let DatagramAddress { local, sender } = *address;
        let socket = UdpSocket::bind(local)
            .map_err(|error| io::Error::new(error.kind(), format!("[{section}] udp:{local}: {error}")))?;
        Ok(Self::Port(socket, Listening { section, only: sender, ..Listening::default() }, subscribers))
    }

    /// The port that is bound, if it is one.
    #[must_use]
    pub fn local_address(&self) -> Option<SocketAddr> {
        match self {
            Self::Port(socket, ..) => socket.local_addr().ok(),
            Self::Line(_) => None,
        }
    }

    /// Who hears of senders that should not be there.
    pub fn notify(&mut self, notices: Sender<String>) {
        if let Self::Port(_, listening, _) = self {
            listening.notices = Some(notices);
        }
    }

    /// Opens it on the calling thread, and says why it cannot be used yet, if so.
    ///
    /// # Errors
    /// The socket cannot be watched.
    pub fn open(self, closed: StopFlag) -> io::Result<(FrameLink, Option<io::Error>)> {
        let (carrier, problem) = match self {
            Self::Port(socket, listening, subscribers) => {
                (Carrier::Port(UdpFramePort::from_socket(socket, listening, subscribers)?), None)
            }
            Self::Line(line) => {
                let (line, problem) = ReconnectingLine::new(line.device, line.baud);
                (Carrier::Line(LinePort::new(line)), problem)
            }
        };
        Ok((FrameLink { carrier, closed }, problem))
    }
}

impl FramePort for FrameLink {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::carriers::PseudoTerminal;
    use crate::executor::run_until;
    use std::time::Duration;

    /// The sender that is followed gets what is sent, who only listens gets it too, and a sender that was refused gets nothing.
    #[test]
    fn permits_go_to_followed_sender_and_listeners() {
        let [sender, refused, listener] = [(); 3].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
        let mut command = CommandConfiguration::on_port("127.0.0.1:0".parse().unwrap());
        command.subscribers = vec![listener.local_addr().unwrap()];
        let bound = BoundFrames::command(&command).unwrap();
        let port = bound.local_address().unwrap();
        sender.send_to(b"first", port).unwrap();
        let flag = StopFlag::default();
        run_until(&flag, |tasks| {
            let (flag, refused) = (&flag, &refused);
            let (mut link, _) = bound.open(StopFlag::default())?;
            tasks.spawn(async move {
                let mut buffer = [0; 16];
                let first = link.receive(&mut buffer).await.unwrap();
                link.follow();
                refused.send_to(b"second", port).unwrap();
                let second = link.receive(&mut buffer).await.unwrap();
                assert_eq!((first.length, second.length), (5, 6));
                assert_ne!(first.peer, second.peer, "another address is another peer");
                link.send(b"permit").await.unwrap();
                flag.stop();
            });
            Ok(())
        })
        .unwrap();
        let heard = |socket: &UdpSocket| {
            socket.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
            socket.recv(&mut [0; 16]).ok()
        };
        assert_eq!([heard(&sender), heard(&listener), heard(&refused)], [Some(6), Some(6), None]);
    }

    /// A request on a serial line is found behind noise, and the answer comes out of the other end.
    #[test]
    fn frames_cross_a_serial_line_both_ways() {
        let terminal = PseudoTerminal::open().unwrap();
        let address =
            CommandAddress::Serial(SerialAddress { device: terminal.device.clone(), baud: 230_400 });
        let bound = BoundFrames::command(&CommandConfiguration {
            address,
            ..CommandConfiguration::on_port("127.0.0.1:0".parse().unwrap())
        });
        // The first test vector of the book, Velocity link.
        let digits = "46470101070000000100000088130000960000000000003f000080be3a601443";
        let request: Vec<u8> =
            (0..32).map(|at| u8::from_str_radix(&digits[2 * at..2 * at + 2], 16).unwrap()).collect();
        let flag = StopFlag::default();
        run_until(&flag, |tasks| {
            let (flag, near, request) = (&flag, &terminal.near, &request);
            let (mut link, problem) = bound.unwrap().open(StopFlag::default())?;
            assert!(problem.is_none());
            rustix::io::write(near, &[b"FGF".as_slice(), request].concat())?;
            tasks.spawn(async move {
                let mut buffer = [0; 64];
                let frame = link.receive(&mut buffer).await.unwrap();
                assert_eq!(&buffer[..frame.length], request);
                link.send(b"permit").await.unwrap();
                flag.stop();
            });
            Ok(())
        })
        .unwrap();
        let mut answer = [0; 16];
        let count = rustix::io::read(&terminal.near, &mut answer[..]).unwrap();
        assert_eq!(&answer[..count], b"permit");
    }
}
