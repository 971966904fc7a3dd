//! The lines between simulator and robot on a virtual clock.

use floorguard_drivers::can::CanFrame;
use floorguard_runtime::configuration::ScannerModel;
use floorguard_runtime::tape::{TapeLine, frame_identifier};
use floorguard_sim::{Payload, Stream, WireEvent};
use floorguard_types::time::Stamp;

use floorguard_host::carriers::{CanPipe, DatagramPipe, DuplexPipe, PipeReader, PipeWriter, byte_pipe};
use floorguard_operator::telemetry::RunSinks;
use floorguard_recording::replay::ScannerPipe;
use floorguard_robot::assembly::ScannerCarrier;

/// The lines between simulator and robot.
pub(super) struct Lines {
    pub(super) lidar: DatagramPipe,
    pub(super) scanner: ScannerPipe,
    rear_scanner: PipeWriter,
    imu: PipeWriter,
    pub(super) can: CanPipe,
}

/// The robot's ends of the serial lines.
pub(super) struct Ends {
    pub(super) scanner: ScannerCarrier<PipeReader, DatagramPipe, DuplexPipe>,
    pub(super) rear_scanner: PipeReader,
    pub(super) imu: DuplexPipe,
    /// What the robot writes to the inertial sensor.
    pub(super) from_imu_line: PipeReader,
}

/// The bit rate that the simulated inertial sensor has.
pub(super) const IMU_BAUD: u32 = 115_200;

impl Lines {
    pub(super) fn new(scanner: ScannerModel) -> (Self, Ends) {
        let (scanner, scanner_reader) = ScannerPipe::new(scanner);
        let (imu, imu_reader) = byte_pipe();
        let (to_imu, from_imu_line) = byte_pipe();
        let (rear_scanner, rear_reader) = byte_pipe();
        let lines =
            Self { lidar: DatagramPipe::default(), scanner, rear_scanner, imu, can: CanPipe::default() };
        let imu = DuplexPipe { reader: imu_reader, writer: to_imu };
        (lines, Ends { scanner: scanner_reader, rear_scanner: rear_reader, imu, from_imu_line })
    }

    pub(super) fn deliver(&self, event: WireEvent, now_us: u64, sinks: &mut RunSinks) {
        let when = (now_us, event.at_us);
        match (event.stream, event.payload) {
            (Stream::LidarData, Payload::Bytes(bytes)) => {
                sinks.delivered(when, TapeLine::Lidar, &bytes);
                self.lidar.push(Stamp::from_micros(event.at_us), bytes);
            }
            (Stream::ScannerSerial | Stream::ScannerData, Payload::Bytes(bytes)) => {
                sinks.delivered(when, TapeLine::Scanner, &bytes);
                self.scanner.push(Stamp::from_micros(event.at_us), &bytes);
            }
            (Stream::RearScannerSerial, Payload::Bytes(bytes)) => {
                sinks.delivered(when, TapeLine::RearScanner, &bytes);
                self.rear_scanner.push(&bytes);
            }
            (Stream::ImuSerial, Payload::Bytes(bytes)) => {
                sinks.delivered(when, TapeLine::Imu, &bytes);
                self.imu.push(&bytes);
            }
            (Stream::Can, Payload::Frame(frame)) => {
                let frame = to_robot(&frame);
                let id = frame_identifier(&frame).unwrap_or_default().to_le_bytes();
                let bytes: Vec<u8> = id.iter().chain(frame.payload()).copied().collect();
                sinks.delivered(when, TapeLine::Can, &bytes);
                self.can.push(frame);
            }
            // Position packets only discipline the lidar's clock, which the arrival times already do.
            _ => {}
        }
    }
}

/// A frame of a simulated device as the robot's computer takes it.
pub(super) fn to_robot(frame: &floorguard_sim::CanFrame) -> CanFrame {
    let extended = || CanFrame::extended(frame.id, frame.payload());
    frame
        .extended
        .then(extended)
        .flatten()
        .unwrap_or_else(|| CanFrame::standard(frame.id as u16, frame.payload()))
}

/// A frame of the robot's computer as simulated devices take it.
pub(super) fn to_devices(frame: &CanFrame) -> floorguard_sim::CanFrame {
    match frame.extended_id() {
        Some(id) => floorguard_sim::CanFrame::extended(id, frame.payload()),
        None => {
            floorguard_sim::CanFrame::new(u32::from(frame.standard_id().unwrap_or_default()), frame.payload())
        }
    }
}
