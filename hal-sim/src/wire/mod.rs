//! What is on each line and when, and encoders of the sensors' messages, written from the chapters on wire formats of the book (book, Velodyne;
//! book, Hesai; book, Ouster; book, SICK S300; book, microScan3; book, Xsens MTi; book, VectorNav; book, CoLa; book, RPLidar; book, Lidar link; book, Scan link; book, IMU link; book, Livox; book, Velocity link; book, SCIP 2.0).

mod cola;
mod event;
mod hesai;
mod imu_link;
mod lidar_link;
mod livox;
mod microscan3;
mod ouster;
mod rplidar;
mod s300;
mod scan_link;
mod scip;
mod vectornav;
mod velocity;
mod velodyne;
mod xbus;

pub use cola::{ColaHeader, cola_binary, cola_scan, cola_scan_binary, cola_telegram};
pub use event::{Payload, Stream, WireEvent};
pub use hesai::{FIRINGS, PandarPacket};
pub use imu_link::{IMU_HEAD_BYTES, IMU_START, imu_link_frame};
pub use lidar_link::ColumnsDatagram;
pub use livox::LivoxDatagram;
pub use microscan3::{
    BEAM_BYTES, BEAMS_FROM, BeamWords, DATAGRAM_HEADER, DEVICE_ERROR, MessageHeader, RUNS, STANDS_BY,
    encode_scan_message, scan_datagrams,
};
pub use ouster::{OusterFormat, OusterPacket};
pub use rplidar::{rplidar_capsule, rplidar_dense_capsule, rplidar_descriptor};
pub use s300::{ScanWords, TelegramHeader, encode_telegram, reseal_telegram};
pub use scan_link::{
    LINK_CRC_BYTES, SCAN_HEAD_BYTES, SCAN_START, ScanNote, reseal_link, scan_link_datagrams,
};
pub use scip::{scip_line, scip_number, scip_reply, scip_scan};
pub use vectornav::{
    COMMON_FIELDS, SATURATION_FIELD, VectorNavReader, VectorNavSample, reseal_vectornav, vectornav_frame,
    vectornav_sentence,
};
pub use velocity::{HeardPermit, SentVelocity, TakenVelocity, motion_report};
pub use velodyne::{DataPacket, ReturnMode, encode_position};
pub use xbus::{XbusParser, encode_message, reseal_message};

/// zlib CRC-32, by which long test packets are confirmed.
#[cfg(test)]
pub(crate) fn tests_crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| {
                if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 }
            },
        )
    })
}
