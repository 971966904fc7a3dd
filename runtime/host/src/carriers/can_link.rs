//! The CAN bus that `robot.toml` names, whatever carries it.

use std::io;

use floorguard_drivers::can::CanFrame;
use floorguard_runtime::io::{CanBus, LineBus, SlcanBus, SlcanBusError};

use super::reconnect::ReconnectingLine;
use super::socket_can::SocketCanBus;
use floorguard_configuration::CanAddress;

/// Adapters for SLCAN are USB devices: the speed does not matter to them, but must be one that Linux accepts.
const SLCAN_BAUD: u32 = 115_200;

/// A CAN bus on Linux. Use it on the thread that made it.
pub enum CanLink {
    /// An interface of the kernel.
    Socket(SocketCanBus),
    /// An adapter on a serial line.
    Slcan(SlcanBus<ReconnectingLine>),
    /// The line of motor controllers.
    Line(LineBus<ReconnectingLine>),
}

impl CanLink {
    /// The bus of an address, and why it cannot be used yet, if so.
    #[must_use]
    pub fn new(address: &CanAddress) -> (Self, Option<io::Error>) {
        match address {
            CanAddress::SocketCan(interface) => {
                let mut bus = SocketCanBus::new(interface.clone());
                let problem = bus.open().err();
                (Self::Socket(bus), problem)
            }
            CanAddress::Slcan(device) => {
                let (line, problem) = ReconnectingLine::new(device.clone(), SLCAN_BAUD);
                (Self::Slcan(SlcanBus::new(line)), problem)
            }
            CanAddress::Line(address) => {
                let (line, problem) = ReconnectingLine::new(address.device.clone(), address.baud);
                (Self::Line(LineBus::new(line)), problem)
            }
        }
    }
}

impl CanBus for CanLink {
    type Error = io::Error;

    async fn receive(&mut self) -> io::Result<CanFrame> {
        match self {
            Self::Socket(bus) => bus.receive().await,
            Self::Slcan(bus) => bus.receive().await.map_err(plain),
            Self::Line(line) => line.receive().await.map_err(plain),
        }
    }

    async fn send(&mut self, frame: &CanFrame) -> io::Result<()> {
        match self {
            Self::Socket(bus) => bus.send(frame).await,
            Self::Slcan(bus) => bus.send(frame).await.map_err(plain),
            Self::Line(line) => line.send(frame).await.map_err(plain),
        }
    }
}

fn plain(error: SlcanBusError<io::Error>) -> io::Error {
    match error {
        SlcanBusError::Line(error) => error,
        SlcanBusError::Ended => io::Error::from(io::ErrorKind::UnexpectedEof),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::carriers::SerialLine;
    use crate::executor::{TaskSet, advance_virtual, use_virtual_clock};
    use embassy_futures::yield_now;
    use embassy_sync::blocking_mutex::raw::NoopRawMutex;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_drivers::three_wheel_base::ThreeWheelBase;
    use floorguard_runtime::clock;
    use floorguard_runtime::shared::{Motion, Shared};
    use floorguard_runtime::tasks::can_bus;
    use floorguard_types::time::Stamp;
    use std::io::{Read, Write};
    use std::os::unix::net::UnixStream;

    const FLOOD: usize = 2_000;
    const FRAME: &[u8] = b"t7F080102030405060708\r";
    const START_US: u64 = 1_000_000;

    /// Two thousand frames wait, and the guard decides in every round: the tick sends what it has to, and frames are taken.
    #[test]
    fn flooded_bus_and_decisions_do_not_starve_others() {
        let (here, mut there) = UnixStream::pair().unwrap();
        there.write_all(&FRAME.repeat(FLOOD)).unwrap();
        there.set_nonblocking(true).unwrap();
        let mut unread = here.try_clone().unwrap();
        use_virtual_clock(START_US);
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let shared = Box::new(
            Shared::<NoopRawMutex>::new(
                robot.guard(),
                Motion::new(robot.wheels()),
                Stamp::from_micros(START_US),
            )
            .unwrap(),
        );
        let bus = SlcanBus::new(SerialLine::from_descriptor(here.into()).unwrap());
        let mut tasks = TaskSet::new();
        tasks.spawn(can_bus(&*shared, bus, (ThreeWheelBase::new(robot.base()), robot.tricycle())));
        tasks.spawn(async {
            loop {
                shared.decide(|guard| guard.tick(clock::now()));
                yield_now().await;
            }
        });
        for round in 0..100 {
            advance_virtual(START_US + round * 1_000);
            tasks.poll_round();
        }
        drop(tasks);
        let (mut sent, mut left) = (Vec::new(), Vec::new());
        // Both end where nothing more is there.
        let _ = (there.read_to_end(&mut sent), unread.read_to_end(&mut left));
        let taken = FLOOD - left.len() / FRAME.len();
        assert!((200..1_000).contains(&taken), "{taken} frames in 100 rounds");
        // Behind the words that open the adapter, SYNC every 10 ms.
        let syncs = sent.windows(4).filter(|word| *word == b"t080").count();
        assert!((8..=11).contains(&syncs), "{syncs}: {}", String::from_utf8_lossy(&sent));
    }
}
