//! The lidar's port on `embassy-net` over the chip's Ethernet.

use embassy_net::udp::{PacketMetadata, RecvError, UdpSocket};
use embassy_net::{Config, IpAddress, Ipv4Address, Ipv4Cidr, Runner, Stack, StackResources, StaticConfigV4};
use embassy_stm32::eth::{Ethernet, GenericPhy, PacketQueue, Sma};
use embassy_stm32::peripherals::{ETH, ETH_SMA};
use floorguard_runtime::clock;
use floorguard_runtime::io::{DatagramReceiver, FirstSender, Received};
use static_cell::StaticCell;

/// Our address on the lidar's network.
const MINE: Ipv4Address = Ipv4Address::new(192, 168, 1, 77);
const LIDAR_PORT: u16 = 2_368;
const DATAGRAMS: usize = 4;
const DATAGRAM_BYTES: usize = 1_300;

/// Descriptors and buffers of the DMA: 2 frames to send, answers to address requests alone; 16 received ones are 21 ms of
/// lidar.
pub type Queue = PacketQueue<2, 16>;
/// Where they lie: AXI SRAM, which the DMA reaches.
pub static QUEUE: StaticCell<Queue> = StaticCell::new();
/// Locally administered.
pub const HARDWARE_ADDRESS: [u8; 6] = [0x02, 0x00, 0x00, 0x00, 0x07, 0x43];

/// The controller.
pub type Device = Ethernet<'static, ETH, GenericPhy<Sma<'static, ETH_SMA>>>;

/// The stack and what drives it. Call once.
pub fn stack(device: Device) -> (Stack<'static>, Runner<'static, Device>) {
    static RESOURCES: StaticCell<StackResources<1>> = StaticCell::new();
    let config = Config::ipv4_static(StaticConfigV4 {
        address: Ipv4Cidr::new(MINE, 24),
        gateway: None,
        dns_servers: heapless::Vec::new(),
    });
    embassy_net::new(device, config, RESOURCES.init(StackResources::new()), 0x666c_6f6f)
}

struct Buffers {
    received_metadata: [PacketMetadata; DATAGRAMS],
    received: [u8; DATAGRAMS * DATAGRAM_BYTES],
    sent_metadata: [PacketMetadata; 1],
    sent: [u8; 64],
}

/// The lidar's port.
pub struct LidarSocket {
    socket: UdpSocket<'static>,
    first: FirstSender<IpAddress>,
}

impl LidarSocket {
    /// Opens it. Call once.
    pub fn open(stack: Stack<'static>) -> Self {
        // Read and written by the processor alone: frames come from `QUEUE`.
        #[unsafe(link_section = ".dtcm.lidar_socket")]
        static BUFFERS: StaticCell<Buffers> = StaticCell::new();
        let buffers = BUFFERS.init_with(|| Buffers {
            received_metadata: [PacketMetadata::EMPTY; DATAGRAMS],
            received: [0; DATAGRAMS * DATAGRAM_BYTES],
            sent_metadata: [PacketMetadata::EMPTY; 1],
            sent: [0; 64],
        });
        let mut socket = UdpSocket::new(
            stack,
            &mut buffers.received_metadata,
            &mut buffers.received,
            &mut buffers.sent_metadata,
            &mut buffers.sent,
        );
        // The port is free and the stack has an address: binding cannot fail.
        socket.bind(LIDAR_PORT).unwrap();
        Self { socket, first: FirstSender::UNKNOWN }
    }
}

impl DatagramReceiver for LidarSocket {
    type Error = RecvError;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<Received, RecvError> {
        loop {
            let (length, from) = self.socket.recv_from(buffer).await?;
            if self.first.hears(from.endpoint.addr) {
                return Ok(Received { length, arrival: clock::now() });
            }
        }
    }

    fn keep_sender(&mut self) {
        self.first.keep();
    }
}
