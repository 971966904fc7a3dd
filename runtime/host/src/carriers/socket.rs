//! UDP sockets of Linux for the epoll loop.

use std::io;
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::sync::mpsc::Sender;

use floorguard_runtime::clock;
use floorguard_runtime::io::{DatagramReceiver, FirstSender, Received};

use crate::executor::Source;
use floorguard_configuration::SenderAddress;

/// Senders that are counted separately; later ones are left unnamed.
const SENDERS_MAX: usize = 8;

/// Who is listened to on a port, and who hears of others.
#[derive(Clone, Debug, Default)]
pub struct Listening {
    /// The section of `robot.toml` that names the device.
    pub section: &'static str,
    /// The only sender that is listened to; without it the one whose messages are understood first.
    pub only: Option<SenderAddress>,
    /// The reporting task; it never blocks the receiving one.
    pub notices: Option<Sender<String>>,
    /// Senders that were heard of.
    pub known: Vec<SocketAddr>,
    /// The device, as soon as a message of one was understood.
    pub first: FirstSender<IpAddr>,
}

impl Listening {
    /// Whether a sender is listened to. Once for each, people hear of one that should not be there.
    pub(super) fn hears(&mut self, from: SocketAddr) -> bool {
        let Self { section, only, notices, known, first } = self;
        let only = *only;
        let is_heard = only.map_or_else(|| first.hears(from.ip()), |only| only.is(from));
        if known.contains(&from) || known.len() >= SENDERS_MAX {
            return is_heard;
        }
        known.push(from);
        let what = match (only, known.first()) {
            (Some(only), _) if !is_heard => Some(format!(
                "[{section}] datagrams of {from} are left out: only sender {only} is listened to"
            )),
            (None, _) if !is_heard => first.device().map(|device| {
                format!(
                    "[{section}] datagrams of {from} are left out: {device} was understood first; if another one is the robot's, \
                     name it: sender = \"ADDRESS\""
                )
            }),
            (None, Some(first)) if *first != from => Some(format!(
                "[{section}] datagrams come from {first} and from {from}, too; unplug what is not the robot's, or name the \
                 device: sender = \"{}\"",
                first.ip()
            )),
            _ => None,
        };
        if let (Some(what), Some(notices)) = (what, notices) {
            // The parent process has ended: so does the robot.
            let _ = notices.send(what);
        }
        is_heard
    }
}

/// A bound UDP port. Use it on the thread that made it.
pub struct UdpReceiver {
    socket: Source<UdpSocket>,
    listening: Listening,
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
        Ok(Self { socket: Source::new(socket)?, listening })
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
            if self.listening.hears(from) {
                return Ok(Received { length, arrival });
            }
        }
    }

    fn keep_sender(&mut self) {
        self.listening.first.keep();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::TaskSet;
    use embassy_futures::yield_now;
    use std::cell::Cell;

    /// Another lidar in the network does not keep a dead one healthy.
    #[test]
    fn only_the_first_understood_sender_counts() {
        let (notices, heard) = std::sync::mpsc::channel();
        let port = UdpSocket::bind("127.0.0.1:0").unwrap();
        let listening = Listening { section: "lidar", notices: Some(notices), ..Listening::default() };
        let mut receiver = UdpReceiver::from_socket(port, listening).unwrap();
        let address = receiver.local_address().unwrap();
        let [device, restarted, stranger] =
            ["127.0.0.1:0", "127.0.0.1:0", "127.0.0.2:0"].map(|ip| UdpSocket::bind(ip).unwrap());
        let lengths = std::cell::RefCell::new(Vec::new());
        let mut tasks = TaskSet::new();
        tasks.spawn(async {
            while let Ok(received) = receiver.receive(&mut [0; 8]).await {
                lengths.borrow_mut().push(received.length);
                if received.length == 2 {
                    receiver.keep_sender();
                }
            }
        });
        for (socket, length) in
            [(&stranger, 1), (&device, 2), (&stranger, 3), (&restarted, 4), (&stranger, 5)]
        {
            socket.send_to(&[0; 8][..length], address).unwrap();
        }
        tasks.poll_until_quiet().unwrap();
        drop(tasks);
        assert_eq!(*lengths.borrow(), [1, 2, 4]);
        let notices: Vec<String> = heard.try_iter().collect();
        assert!(notices.iter().any(|notice| notice.contains("name")), "{notices:?}");
    }

    /// Datagrams that wait in the kernel are taken one by one, and every other task has its turn in between.
    #[test]
    fn flooded_port_takes_turns_with_other_tasks() {
        let mut receiver = UdpReceiver::bind("127.0.0.1:0".parse().unwrap()).unwrap();
        let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        let address = receiver.local_address().unwrap();
        (0..50).for_each(|_| assert_eq!(sender.send_to(b"junk", address).unwrap(), 4));
        let (taken, most_at_once) = (Cell::new(0_u32), Cell::new(0));
        let mut tasks = TaskSet::new();
        tasks.spawn(async {
            while receiver.receive(&mut [0; 8]).await.is_ok() {
                taken.set(taken.get() + 1);
            }
        });
        tasks.spawn(async {
            let mut before = 0;
            while taken.get() < 50 {
                yield_now().await;
                most_at_once.set(most_at_once.get().max(taken.get() - before));
                before = taken.get();
            }
        });
        tasks.poll_until_quiet().unwrap();
        drop(tasks);
        assert_eq!((taken.get(), most_at_once.get()), (50, 1));
    }
}
