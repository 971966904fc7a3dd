//! The ports of the lidar and of the bench link, on `embassy-net`.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_net::udp::{PacketMetadata, RecvError, UdpSocket};
use embassy_net::{Config, IpAddress, Ipv4Address, Ipv4Cidr, Runner, Stack, StackResources, StaticConfigV4};
use floorguard_runtime::clock;
use floorguard_runtime::io::{DatagramReceiver, FirstSender, Received};
use static_cell::StaticCell;

use crate::ethernet::Ethernet;

/// Our address on the emulator's network.
pub const MINE: Ipv4Address = Ipv4Address::new(10, 0, 2, 15);
const GATEWAY: Ipv4Address = Ipv4Address::new(10, 0, 2, 2);
/// Port of the lidar (book, Velodyne).
const LIDAR_PORT: u16 = 2_368;
/// Port of the bench link.
const BENCH_PORT: u16 = 2_369;
/// Datagrams that the socket holds: 10 ms of lidar.
const DATAGRAMS: usize = 8;
const DATAGRAM_BYTES: usize = 1_300;

/// Lidar datagrams that reached the task.
static RECEIVED: AtomicU32 = AtomicU32::new(0);

/// Lidar datagrams that reached the task; wraps.
pub fn received() -> u32 {
    RECEIVED.load(Ordering::Relaxed)
}

/// Buffers of a socket.
struct Buffers<const METADATA: usize, const BYTES: usize> {
    received_metadata: [PacketMetadata; METADATA],
    received: [u8; BYTES],
    sent_metadata: [PacketMetadata; 2],
    sent: [u8; 128],
}

impl<const METADATA: usize, const BYTES: usize> Buffers<METADATA, BYTES> {
    const fn new() -> Self {
        Self {
            received_metadata: [PacketMetadata::EMPTY; METADATA],
            received: [0; BYTES],
            sent_metadata: [PacketMetadata::EMPTY; 2],
            sent: [0; 128],
        }
    }

    fn socket(&'static mut self, stack: Stack<'static>, port: u16) -> UdpSocket<'static> {
        let mut socket = UdpSocket::new(
            stack,
            &mut self.received_metadata,
            &mut self.received,
            &mut self.sent_metadata,
            &mut self.sent,
        );
        // The port is free and the stack has an address: binding cannot fail.
        socket.bind(port).unwrap();
        socket
    }
}

/// The stack and what drives it. Call once.
pub fn stack(ethernet: Ethernet) -> (Stack<'static>, Runner<'static, Ethernet>) {
    static RESOURCES: StaticCell<StackResources<2>> = StaticCell::new();
    let config = Config::ipv4_static(StaticConfigV4 {
        address: Ipv4Cidr::new(MINE, 24),
        gateway: Some(GATEWAY),
        dns_servers: heapless::Vec::new(),
    });
    embassy_net::new(ethernet, config, RESOURCES.init(StackResources::new()), 0x666c_6f6f)
}

/// The port that the bench link answers on. Call once.
pub fn bench_socket(stack: Stack<'static>) -> UdpSocket<'static> {
    static BUFFERS: StaticCell<Buffers<4, 256>> = StaticCell::new();
    BUFFERS.init(Buffers::new()).socket(stack, BENCH_PORT)
}

/// The lidar's port.
pub struct LidarSocket {
    socket: UdpSocket<'static>,
    first: FirstSender<IpAddress>,
}

impl LidarSocket {
    /// Opens it. Call once.
    pub fn open(stack: Stack<'static>) -> Self {
        // Read and written by the processor alone: frames come from the ring.
        #[unsafe(link_section = ".dtcm.lidar_socket")]
        static BUFFERS: StaticCell<Buffers<DATAGRAMS, { DATAGRAMS * DATAGRAM_BYTES }>> = StaticCell::new();
        let socket = BUFFERS.init_with(Buffers::new).socket(stack, LIDAR_PORT);
        Self { socket, first: FirstSender::UNKNOWN }
    }
}

impl DatagramReceiver for LidarSocket {
    type Error = RecvError;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, RecvError> {
        loop {
            let (length, from) = self.socket.recv_from(buffer).await?;
            RECEIVED.fetch_add(1, Ordering::Relaxed);
            if self.first.hears(from.endpoint.addr) {
                return Ok(Received { length, arrival: clock::now() });
            }
        }
    }

    fn keep_sender(&mut self) {
        self.first.keep();
    }
}
