//! The line between a simulated or recorded safety scanner and the robot's task, of the kind that its model has.

use floorguard_runtime::configuration::ScannerModel;
use floorguard_types::time::Stamp;

use floorguard_host::carriers::{DatagramPipe, DuplexPipe, PipeReader, PipeWriter, byte_pipe};
use floorguard_robot::assembly::ScannerCarrier;

/// The end into which bytes are put.
pub enum ScannerPipe {
    /// Bytes of telegrams.
    Serial(PipeWriter),
    /// Datagrams.
    Datagrams(DatagramPipe),
    /// Bytes of a scanner that must be asked, and what it is asked.
    Asked(PipeWriter, PipeReader),
}

impl ScannerPipe {
    /// Both ends.
    pub fn new(model: ScannerModel) -> (Self, ScannerCarrier<PipeReader, DatagramPipe, DuplexPipe>) {
        match model {
            ScannerModel::S300 => {
                let (writer, reader) = byte_pipe();
                (Self::Serial(writer), ScannerCarrier::Serial(reader))
            }
            ScannerModel::Ranging(model) if !model.sends_datagrams() => {
                let ((to_robot, reader), (writer, from_robot)) = (byte_pipe(), byte_pipe());
                (
                    Self::Asked(to_robot, from_robot),
                    ScannerCarrier::Asked(DuplexPipe { reader, writer }, model),
                )
            }
            ScannerModel::MicroScan3 { .. } | ScannerModel::Ranging(_) => {
                let pipe = DatagramPipe::default();
                (Self::Datagrams(pipe.clone()), ScannerCarrier::Datagrams(pipe))
            }
        }
    }

    /// Bytes of a line, or a datagram that arrived at a time.
    pub fn push(&self, arrival: Stamp, bytes: &[u8]) {
        match self {
            Self::Serial(writer) | Self::Asked(writer, _) => writer.push(bytes),
            Self::Datagrams(pipe) => pipe.push(arrival, bytes.to_vec()),
        }
    }

    /// What the scanner was asked since the last call.
    #[must_use]
    pub fn asked(&self) -> Vec<u8> {
        match self {
            Self::Asked(_, from_robot) => from_robot.drain(),
            Self::Serial(_) | Self::Datagrams(_) => Vec::new(),
        }
    }
}
