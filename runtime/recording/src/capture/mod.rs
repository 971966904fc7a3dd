//! Network captures: `.pcap` and `.pcapng`, plain or `.gz`, as a stream of UDP datagrams.

mod datagram;
mod model;
mod reader;

pub use datagram::{Datagram, is_scanner_datagram};
pub use model::{LIDAR_DATA_PORT, settle_model};
pub use reader::{Capture, CaptureError, CaptureNotes};
