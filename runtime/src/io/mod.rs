//! What a board must supply. Serial lines are `embedded-io-async`; CAN is the trait of the drivers; datagrams are here.

mod datagram;

pub use datagram::{DatagramReceiver, Received};
