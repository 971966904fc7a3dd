//! Network captures: `.pcap` and `.pcapng`, plain or `.gz`, as a stream of UDP datagrams.

mod datagram;
mod reader;

pub use datagram::Datagram;
pub use reader::{Capture, CaptureError, CaptureNotes};
