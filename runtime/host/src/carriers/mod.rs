//! How bytes reach the tasks: sockets, connections, serial lines and CAN of Linux, and in-process pipes on the virtual clock.

mod can_link;
mod can_pipe;
mod frame_link;
mod pipe;
mod reconnect;
mod scip_wire;
mod serial;
mod socket;
mod socket_can;
mod stream;

pub use can_link::CanLink;
pub use can_pipe::CanPipe;
pub use frame_link::{BoundFrames, FrameLink, UdpFramePort};
pub use pipe::{DatagramPipe, DuplexPipe, PipeReader, PipeWriter, byte_pipe};
pub use reconnect::ReconnectingLine;
pub use scip_wire::ScipWire;
pub use serial::{PseudoTerminal, SerialLine};
pub use socket::{Listening, UdpReceiver};
pub use socket_can::SocketCanBus;
pub use stream::ReconnectingStream;
