//! Whatever a driver refuses, it says so in words of its own, with the figure that is wrong.

use std::collections::BTreeSet;
use std::string::{String, ToString};

use crate::canopen::{Emergency, SdoError};
use crate::microscan3::{FragmentError, MessageError, ScanError};
use crate::s300::TelegramError;
use crate::vectornav;
use crate::velodyne::{DecodeError, GprmcError, Model, PacketError, PositionError};
use crate::xsens::DeviceFault;

/// All texts differ, and none is empty.
fn differ<T: core::fmt::Display>(reasons: &[T]) {
    let reported: BTreeSet<String> = reasons.iter().map(ToString::to_string).collect();
    assert_eq!(reported.len(), reasons.len(), "{reported:?}");
    assert!(reported.iter().all(|text| text.len() > 8), "{reported:?}");
}

/// The text names each of these words.
fn names(reason: &impl core::fmt::Display, words: &[&str]) {
    let reported = reason.to_string();
    assert!(words.iter().all(|word| reported.contains(word)), "{reported}: {words:?}");
}

#[test]
fn drives_and_encoders() {
    let classes = [
        (0x0000, "no error"),
        (0x8110, "CAN overrun"),
        (0x8120, "CAN error passive"),
        (0x8130, "heartbeat lost"),
        (0x8140, "bus-off"),
        (0x8210, "wrong length"),
        (0x8220, "wrong length"),
        (0x8611, "following error"),
        (0x1000, "generic"),
        (0x1FFF, "generic"),
        (0x2310, "current"),
        (0x3210, "voltage"),
        (0x4210, "temperature"),
        (0x5441, "hardware"),
        (0x6010, "software"),
        (0x7305, "sensor"),
        (0x8000, "monitoring"),
        (0x9000, "external"),
        (0xFF01, "device"),
    ];
    for (code, class) in classes {
        let emergency = Emergency { code, ..Emergency::default() };
        names(&emergency, &[class, &std::format!("{code:04X}h")]);
        assert_eq!(emergency.is_cleared(), code == 0);
    }
    // CiA 301, table 22.
    let codes = [
        0x0503_0000,
        0x0504_0000,
        0x0504_0001,
        0x0601_0000,
        0x0601_0001,
        0x0601_0002,
        0x0602_0000,
        0x0604_0041,
        0x0604_0042,
        0x0604_0043,
        0x0604_0047,
        0x0606_0000,
        0x0607_0010,
        0x0607_0012,
        0x0607_0013,
        0x0609_0011,
        0x0609_0030,
        0x0800_0000,
        0x0800_0020,
        0x0800_0022,
    ];
    let reasons: BTreeSet<String> = codes
        .iter()
        .map(|code| SdoError(*code).to_string().split(" (").next().unwrap_or_default().to_string())
        .collect();
    assert_eq!(reasons.len(), codes.len(), "each code has a reason of its own: {reasons:?}");
    assert!(!reasons.contains("unknown reason"));
    names(&SdoError(0x1234_5678), &["unknown reason", "12345678h"]);
}

#[test]
fn safety_scanners() {
    differ(&[
        FragmentError::Short { length: 3 },
        FragmentError::Foreign,
        FragmentError::Total { total: 7 },
        FragmentError::Outside { offset: 1, length: 2, total: 9 },
    ]);
    names(&FragmentError::Outside { offset: 11, length: 22, total: 33 }, &["11", "22", "33"]);
    let messages = [
        MessageError::Short { length: 3 },
        MessageError::Invalid { found: 0x41 },
        MessageError::Block { offset: 4, size: 5 },
    ];
    differ(&messages);
    names(&messages[1], &["0x41", "0x56"]);
    differ(&[
        ScanError::Fragment(FragmentError::Foreign),
        ScanError::Message(MessageError::Short { length: 3 }),
        ScanError::NoGeometry,
        ScanError::NoMeasurement,
        ScanError::Geometry,
        ScanError::Beams { found: 1, announced: 2 },
        ScanError::Device,
    ]);
    let telegrams = [
        TelegramError::Block { found: 0xCCCC },
        TelegramError::Values { found: 540, expected: 541 },
        TelegramError::LockOut { status: 1 },
    ];
    differ(&telegrams);
    names(&telegrams[1], &["540", "541"]);
}

#[test]
fn lidar_and_inertial_sensor() {
    differ(&[
        PacketError::Length { received: 100 },
        PacketError::BlockFlag { block: 1, found: [0xFF, 0xDD] },
        PacketError::Azimuth { block: 1, azimuth_cdeg: 36_000 },
        PacketError::ReturnMode { found: 0x36 },
        PacketError::Stamp { micros: 3_700_000_000 },
    ]);
    let wrong = DecodeError::WrongModel { configured: Model::Vlp16, product_byte: 0x28, period_us: None };
    let late = DecodeError::WrongModel { configured: Model::HiRes, product_byte: 0x21, period_us: Some(553) };
    names(&wrong, &["VLP-16", "0x28"]);
    names(&late, &["Puck Hi-Res", "553", "1327"]);
    differ(&[
        wrong,
        late,
        DecodeError::Packet(PacketError::Length { received: 1 }),
        DecodeError::ModelUndecided,
        DecodeError::UnknownProduct { product_byte: 9 },
        DecodeError::TooManyLasers { model: Model::Hdl32E, lasers_max: 16 },
        DecodeError::Rotation { gap_cdeg: 0 },
        DecodeError::NoPairs { first_cdeg: 1, second_cdeg: 2 },
        DecodeError::NotNewer { stamp_us: 4 },
    ]);
    names(&PositionError::Length { received: 511 }, &["511", "512"]);
    differ(&[GprmcError::Other, GprmcError::Checksum { computed: 0x5A }, GprmcError::Field(3)]);
    differ(&[
        DeviceFault::WrongProduct,
        DeviceFault::OtherItems,
        DeviceFault::Rejected(3),
        DeviceFault::LowerRate,
        DeviceFault::LineTooSlow,
        DeviceFault::NoAnswer,
    ]);
    differ(&[
        vectornav::DeviceFault::WrongProduct,
        vectornav::DeviceFault::OtherItems,
        vectornav::DeviceFault::Rejected(7),
        vectornav::DeviceFault::LineTooSlow,
        vectornav::DeviceFault::NoAnswer,
    ]);
    names(&vectornav::DeviceFault::Rejected(0x0B), &["0B"]);
}
