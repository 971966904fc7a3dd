//! What a board must supply: serial lines are `embedded-io-async`; datagrams and CAN buses are here.

mod can_bus;
mod datagram;
mod slcan_bus;

pub use can_bus::CanBus;
pub use datagram::{DatagramReceiver, FirstSender, Received};
pub use slcan_bus::{SlcanBus, SlcanBusError};
