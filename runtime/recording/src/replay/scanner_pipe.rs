//! The line between a simulated or recorded safety scanner and the robot's task, of the kind that its model has.

use floorguard_runtime::configuration::ScannerModel;
use floorguard_types::time::Stamp;

use floorguard_host::carriers::{DatagramPipe, PipeReader, PipeWriter, byte_pipe};
use floorguard_robot::assembly::ScannerCarrier;

/// The end into which bytes are put.
pub enum ScannerPipe {
    /// Bytes of telegrams.
    Serial(PipeWriter),
    /// Datagrams.
    Datagrams(DatagramPipe),
}

impl ScannerPipe {
    /// Both ends.
    pub fn new(model: ScannerModel) -> (Self, ScannerCarrier<PipeReader, DatagramPipe>) {
        match model {
            ScannerModel::S300 => {
                let (writer, reader) = byte_pipe();
                (Self::Serial(writer), ScannerCarrier::Serial(reader))
            }
            ScannerModel::MicroScan3 { .. } => {
                let pipe = DatagramPipe::default();
                (Self::Datagrams(pipe.clone()), ScannerCarrier::Datagrams(pipe))
            }
        }
    }

    /// Bytes of a line, or a datagram that arrived at a time.
    pub fn push(&self, arrival: Stamp, bytes: &[u8]) {
        match self {
            Self::Serial(writer) => writer.push(bytes),
            Self::Datagrams(pipe) => pipe.push(arrival, bytes.to_vec()),
        }
    }
}
