//! The simulator's ends of the real carriers, and the addresses under which the robot finds its own.

use std::net::UdpSocket;
use std::os::fd::AsFd;
use std::time::Duration;

use anyhow::Context;
use embedded_can::Frame as _;
use floorguard_runtime::configuration::{RobotConfiguration, ScannerModel};
use floorguard_sim::CanFrame as SimCanFrame;
use floorguard_sim::can::{SlcanDecoder, encode_slcan};
use floorguard_sim::{Payload, Stream, WireEvent};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use socketcan::{CanFrame as KernelFrame, CanSocket, Socket};

use floorguard_configuration::{CanAddress, ScipAddress, SerialAddress};
use floorguard_host::carriers::{Listening, PseudoTerminal};
use floorguard_host::executor::Lateness;
use floorguard_robot::assembly::PeopleInbox;
use floorguard_robot::assembly::{ImuLink, Links, ScannerLink};

/// Bit rates of the simulated lines; a pseudo-terminal takes any.
const SCANNER_BAUD: u32 = 500_000;
const IMU_BAUD: u32 = 115_200;
/// A read takes what is there, up to this.
const PORTION_BYTES: usize = 4_096;
/// Frames taken from the kernel at once.
const FRAMES_MAX: usize = 256;
/// Symbols a second on a line of motor controllers.
const LINE_BAUD: u32 = 115_200;
/// The longest sleep, microseconds.
const SLEEP_US: u64 = 10_000;

/// The devices' end of the CAN bus.
enum CanEnd {
    /// An SLCAN adapter on a pseudo-terminal.
    Adapter(PseudoTerminal, SlcanDecoder),
    /// An interface of the kernel, which the robot uses as well.
    Interface(CanSocket),
    /// The line of motor controllers.
    Line(PseudoTerminal),
}

/// The safety scanner's end of its line.
enum ScannerEnd {
    Serial(PseudoTerminal),
    Datagrams(UdpSocket),
    /// A scanner that must be asked.
    Asked(PseudoTerminal),
}

/// The simulator's ends of the lines.
pub(super) struct Ends {
    lidar: UdpSocket,
    scanner: ScannerEnd,
    rear_scanner: Option<PseudoTerminal>,
    imu: PseudoTerminal,
    can: CanEnd,
    /// Messages that a full line refused.
    pub refused: u64,
}

impl Ends {
    /// Both ends: the simulator's and the robot's. Without a CAN interface of the kernel the bus is an SLCAN adapter.
    pub fn open(robot: &RobotConfiguration, can_interface: Option<&str>) -> anyhow::Result<(Self, Links)> {
        let (lidar, robot_lidar) = loopback()?;
        let terminal = || PseudoTerminal::open().context("no pseudo-terminal");
        let (scanner, robot_scanner) = ScannerEnd::open(robot.scanner.model)?;
        let rear_scanner = robot.rear_scanner.map(|_| terminal()).transpose()?;
        let rear_line = rear_scanner.as_ref().map(|line| line.device.clone());
        let imu = terminal()?;
        let is_line = robot.motors.is_some_and(|motors| motors.protocol.is_serial());
        let (can, address) = match can_interface {
            _ if is_line => {
                let line = terminal()?;
                let address = SerialAddress { device: line.device.clone(), baud: LINE_BAUD };
                (CanEnd::Line(line), CanAddress::Line(address))
            }
            Some(name) => (CanEnd::Interface(open_interface(name)?), CanAddress::SocketCan(name.to_owned())),
            None => {
                let adapter = terminal()?;
                let address = CanAddress::Slcan(adapter.device.clone());
                (CanEnd::Adapter(adapter, SlcanDecoder::default()), address)
            }
        };
        let links = Links {
            lidar: Some((robot_lidar, Listening::default())),
            scanner: robot_scanner,
            rear_scanner: rear_line.map(|device| SerialAddress { device, baud: SCANNER_BAUD }),
            imu: Some(ImuLink::Serial(SerialAddress { device: imu.device.clone(), baud: IMU_BAUD })),
            can: Some(address),
            base: None,
            command: None,
            tap: None,
            mission: None,
            navigation: None,
            people: PeopleInbox::default(),
            learning: None,
            lateness: Lateness::default(),
            latches: None,
        };
        Ok((Self { lidar, scanner, rear_scanner, imu, can, refused: 0 }, links))
    }

    /// Puts on the line what a device sends.
    pub fn deliver(&mut self, event: WireEvent) {
        let delivered = match (event.stream, event.payload) {
            (Stream::LidarData, Payload::Bytes(bytes)) => self.lidar.send(&bytes).is_ok(),
            (Stream::ScannerSerial | Stream::ScannerData, Payload::Bytes(bytes)) => self.scanner.send(&bytes),
            (Stream::RearScannerSerial, Payload::Bytes(bytes)) => {
                self.rear_scanner.as_ref().is_none_or(|line| write_all(line, &bytes))
            }
            (Stream::ImuSerial, Payload::Bytes(bytes)) => write_all(&self.imu, &bytes),
            (Stream::Can, Payload::Frame(frame)) => self.can.send(&frame),
            _ => true,
        };
        self.refused += u64::from(!delivered);
    }

    /// What the robot has written to the bus, to the inertial sensor, and to a scanner that is asked.
    pub fn receive(&mut self) -> (Vec<SimCanFrame>, [(Stream, Vec<u8>); 2]) {
        let asked = match &self.scanner {
            ScannerEnd::Asked(line) => read_all(line),
            ScannerEnd::Serial(_) | ScannerEnd::Datagrams(_) => Vec::new(),
        };
        let written = [(Stream::ImuSerial, read_all(&self.imu)), (Stream::ScannerSerial, asked)];
        (self.can.receive(&mut self.refused), written)
    }

    /// Sleeps until the robot writes something, or a time has passed.
    pub fn wait(&self, at_most_us: u64) -> anyhow::Result<()> {
        let can = match &self.can {
            CanEnd::Adapter(terminal, _) | CanEnd::Line(terminal) => terminal.near.as_fd(),
            CanEnd::Interface(socket) => socket.as_fd(),
        };
        let mut lines =
            [can, self.imu.near.as_fd()].map(|line| PollFd::from_borrowed_fd(line, PollFlags::IN));
        let timeout = Timespec { tv_sec: 0, tv_nsec: (at_most_us.min(SLEEP_US) * 1_000) as i64 };
        match poll(&mut lines, Some(&timeout)) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
        // A terminal that nobody has opened yet is always ready to say so.
        if lines.iter().any(|line| line.revents().contains(PollFlags::HUP)) {
            std::thread::sleep(Duration::from_micros(at_most_us.clamp(200, 1_000)));
        }
        Ok(())
    }
}

/// A UDP connection on the loopback: the sending end, and the robot's.
fn loopback() -> anyhow::Result<(UdpSocket, UdpSocket)> {
    let robot = UdpSocket::bind("127.0.0.1:0").context("no UDP port on the loopback")?;
    let device = UdpSocket::bind("127.0.0.1:0")?;
    device.connect(robot.local_addr()?)?;
    Ok((device, robot))
}

impl ScannerEnd {
    fn open(model: ScannerModel) -> anyhow::Result<(Self, ScannerLink)> {
        match model {
            ScannerModel::S300 => {
                let line = PseudoTerminal::open().context("no pseudo-terminal")?;
                let address = SerialAddress { device: line.device.clone(), baud: SCANNER_BAUD };
                Ok((Self::Serial(line), ScannerLink::Serial(address)))
            }
            ScannerModel::Ranging(model) if !model.sends_datagrams() => {
                let line = PseudoTerminal::open().context("no pseudo-terminal")?;
                let address = SerialAddress { device: line.device.clone(), baud: SCANNER_BAUD };
                Ok((Self::Asked(line), ScannerLink::Wire(ScipAddress::Serial(address), model)))
            }
            ScannerModel::MicroScan3 { .. } | ScannerModel::Ranging(_) => {
                let (device, robot) = loopback()?;
                Ok((Self::Datagrams(device), ScannerLink::Datagrams(robot, Listening::default())))
            }
        }
    }

    fn send(&self, bytes: &[u8]) -> bool {
        match self {
            Self::Serial(line) | Self::Asked(line) => write_all(line, bytes),
            Self::Datagrams(socket) => socket.send(bytes).is_ok(),
        }
    }
}

impl CanEnd {
    fn send(&mut self, frame: &SimCanFrame) -> bool {
        match self {
            Self::Adapter(terminal, _) => write_all(terminal, encode_slcan(frame).as_bytes()),
            Self::Line(terminal) => write_all(terminal, frame.payload()),
            Self::Interface(socket) => {
                to_kernel(frame).is_some_and(|frame| socket.write_frame(&frame).is_ok())
            }
        }
    }

    fn receive(&mut self, refused: &mut u64) -> Vec<SimCanFrame> {
        match self {
            Self::Adapter(terminal, decoder) => {
                let (frames, replies) = decoder.push(&read_all(terminal));
                *refused += u64::from(!write_all(terminal, &replies));
                frames
            }
            Self::Line(terminal) => {
                read_all(terminal).chunks(8).map(|portion| SimCanFrame::new(0, portion)).collect()
            }
            Self::Interface(socket) => {
                let frames = (0..FRAMES_MAX).map_while(|_| socket.read_frame().ok());
                frames.filter_map(|frame| from_kernel(&frame)).collect()
            }
        }
    }
}

fn to_kernel(frame: &SimCanFrame) -> Option<KernelFrame> {
    if frame.extended {
        return KernelFrame::new(embedded_can::ExtendedId::new(frame.id)?, frame.payload());
    }
    KernelFrame::new(embedded_can::StandardId::new(frame.id as u16)?, frame.payload())
}

fn from_kernel(frame: &KernelFrame) -> Option<SimCanFrame> {
    match frame.id() {
        embedded_can::Id::Standard(id) if frame.is_data_frame() => {
            Some(SimCanFrame::new(u32::from(id.as_raw()), frame.data()))
        }
        _ => None,
    }
}

fn open_interface(name: &str) -> anyhow::Result<CanSocket> {
    let socket = CanSocket::open(name).with_context(|| {
        format!("{name}: no such CAN interface; make one with: ip link add dev {name} type vcan; ip link set up {name}")
    })?;
    socket.set_nonblocking(true)?;
    Ok(socket)
}

pub(super) fn write_all(line: &PseudoTerminal, bytes: &[u8]) -> bool {
    bytes.is_empty() || rustix::io::write(&line.near, bytes).is_ok_and(|count| count == bytes.len())
}

pub(super) fn read_all(line: &PseudoTerminal) -> Vec<u8> {
    let mut bytes = vec![0; PORTION_BYTES];
    // Nothing there, or nobody at the other end yet: no bytes.
    let count = rustix::io::read(&line.near, &mut bytes[..]).unwrap_or(0);
    bytes.truncate(count);
    bytes
}
