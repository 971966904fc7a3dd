//! What a board must supply: serial lines are `embedded-io-async`; datagrams, frames and CAN buses are here.

mod can_bus;
mod datagram;
mod frame_port;
mod line_bus;
mod slcan_bus;

pub use can_bus::CanBus;
pub use datagram::{DatagramReceiver, FirstSender, Received};
pub use frame_port::{FramePort, LinePort, LinePortError, PortFrame, receive_from};
pub use line_bus::LineBus;
pub use slcan_bus::{SlcanBus, SlcanBusError};
