//! The frames of the book, Xsens MTi: Test frames, and what must be refused.

use super::frame::FrameReceiver;
use super::measurement::{Measurement, MeasurementError, NoRotation, StatusWord, UtcTime};
use floorguard_types::time::Stamp;
use proptest::prelude::*;
use std::vec::Vec;

fn decoded(text: &str) -> Measurement {
    let bytes: Vec<u8> = text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
    let mut found = None;
    FrameReceiver::new().push(&bytes, Stamp::ZERO, |message, _| {
        assert_eq!(message.id, 0x36);
        found = Some(Measurement::decode(message.data).unwrap());
    });
    found.expect("one right frame")
}

fn near<const N: usize>(seen: Option<[f64; N]>, wanted: [f64; N], tolerance: f64) {
    for (a, b) in seen.unwrap().iter().zip(wanted) {
        assert!((a - b).abs() <= tolerance, "{seen:?} {wanted:?}");
    }
}

#[test]
fn xs1_manufacturer_example() {
    let seen = decoded(
        "FA FF 36 31 10 20 02 DF C5 10 60 04 00 45 9D A0 40 20 0C BE DC 9A FA 3F 54 9F 37 41 1C BB 70 80 20 0C BB AA 5C 80
         3B 8C 55 01 BB 81 33 00 E0 20 04 00 00 00 81 45",
    );
    assert_eq!((seen.packet_counter, seen.sample_time_fine), (Some(57_285), Some(4_562_336)));
    near(seen.acceleration_mps2, [-0.430_869_88, 0.830_554_43, 9.795_761_11], 1e-8);
    near(seen.rate_of_turn_radps, [-0.005_199_02, 0.004_282_59, -0.003_942_85], 1e-8);
    assert_eq!(seen.status, Some(StatusWord(0x81)));
}

#[test]
fn xs2_captured_frame() {
    let seen = decoded(
        "FA FF 36 44 10 20 02 E6 86 10 60 04 00 57 51 26 20 10 10 3F 7F 1D DE BD A6 35 08 BC 8E 1B CD 3A B3 C0 88 40 20 0C
         3E B6 FC 53 BF C6 F4 B9 41 17 26 91 80 20 0C BB B3 84 00 3C 1F C8 BD BA 8D E7 8C E0 20 04 00 00 00 01 7A",
    );
    assert_eq!((seen.packet_counter, seen.sample_time_fine), (Some(59_014), Some(5_722_406)));
    near(seen.quaternion, [0.996_549_49, -0.081_155_84, -0.017_347_24, 0.001_371_40], 1e-8);
    near(seen.acceleration_mps2, [0.357_393_83, -1.554_343_34, 9.446_915_63], 1e-8);
    near(seen.rate_of_turn_radps, [-0.005_478_38, 0.009_752_45, -0.001_082_65], 1e-8);
}

#[test]
fn xs3_fixed_point_12_20() {
    let seen = decoded(
        "FA FF 36 5F 10 20 02 A9 EA 10 60 04 03 15 18 DA 10 10 0C 0E 14 20 40 07 E3 01 14 0D 2F 19 37 E0 10 01 05 40 21 0C
         00 00 7D 65 FF 8B B2 CA FF EB FC 2E 40 11 0C 00 00 01 41 FF FE D6 45 FF FF CC C5 80 21 0C FF FF FB 1B 00 00 03 AC
         FF FF FF A6 80 31 10 00 10 00 01 FF FF FF FA 00 00 00 05 00 00 00 00 6A",
    );
    assert_eq!((seen.packet_counter, seen.sample_time_fine), (Some(43_498), Some(51_714_266)));
    near(seen.acceleration_mps2, [0.030_613_899_23, -7.268_850_326_54, -1.250_932_693_48], 1e-11);
    near(seen.delta_velocity_mps, [0.000_306_129, -0.072_688_103, -0.012_507_439], 1e-9);
    near(seen.rate_of_turn_radps, [-0.001_194_953_92, 0.000_896_453_86, -0.000_085_830_69], 1e-11);
    near(seen.delta_quaternion, [1.000_000_953_67, -5.722_045_9e-6, 4.768_371_6e-6, 0.0], 1e-11);
    assert_eq!(seen.status, Some(StatusWord(5)));
}

#[test]
fn xs4_fixed_point_16_32() {
    let seen = decoded(
        "FA FF 36 79 10 20 02 AA 4E 10 60 04 03 15 44 6E 10 10 0C 14 F8 0A C0 07 E3 01 14 0D 2F 1A 37 E0 10 01 05 40 22 12
         0B D2 D9 60 00 00 BC 86 A0 00 FF F8 C8 2A B0 00 FF FE 40 12 12 00 1E 13 9F 00 00 ED 67 C1 00 FF FF FC E1 A7 84 FF
         FF 80 22 12 00 47 9A D2 00 00 00 6D 5F BF 00 00 FF 0A 39 05 FF FF 80 32 18 00 00 00 01 00 01 00 00 5B A6 00 00 00
         00 8C 01 00 00 FF FE C5 69 FF FF 5D",
    );
    near(seen.acceleration_mps2, [0.046_186_052_26, -7.263_570_785_52, -1.218_098_640_44], 2e-11);
    near(seen.delta_velocity_mps, [0.000_458_933_18, -0.072_635_591_03, -0.012_181_787_75], 2e-11);
    near(seen.rate_of_turn_radps, [0.001_092_602_03, 0.001_668_914_92, -0.003_750_263_47], 2e-11);
    near(
        seen.delta_quaternion,
        [1.000_000_000_23, 5.462_672_56e-6, 8.344_883_10e-6, -1.875_101_59e-5],
        2e-11,
    );
}

#[test]
fn xs5_double_precision() {
    let seen = decoded(
        "FA FF 36 93 10 20 02 AA B2 10 60 04 03 15 6F F2 10 10 0C 1B C3 8B 40 07 E3 01 14 0D 2F 1B 37 E0 10 01 05 40 23 18
         3F 71 32 F3 A0 00 00 00 C0 1D 00 38 A0 00 00 00 BF F3 67 8D 80 00 00 00 40 13 18 3F 05 F5 7A 00 00 00 00 BF B2 8F
         80 20 00 00 00 BF 88 D6 7F 80 00 00 00 80 23 18 3F 14 9A DE 60 00 00 01 3F 35 3D 82 80 00 00 00 BF 18 50 FD C0 00
         00 00 80 33 20 3F F0 00 00 00 00 00 01 3E 9A 5F D4 E0 00 00 00 3E BB 30 02 E0 00 00 01 BE 9F 1F FD 00 00 00 00 CF",
    );
    near(
        seen.acceleration_mps2,
        [0.004_198_981_914_669_275, -7.250_216_007_232_666, -1.212_781_429_290_771_5],
        0.0,
    );
    near(
        seen.rate_of_turn_radps,
        [7.860_166_806_494_818e-5, 0.000_324_100_838_042_795_66, -9.275_959_746_446_46e-5],
        0.0,
    );
    near(
        seen.delta_quaternion,
        [
            1.000_000_000_000_000_2,
            3.930_083_209_979_784_4e-7,
            1.620_503_894_628_200_4e-6,
            -4.637_979_600_374_819_7e-7,
        ],
        0.0,
    );
}

#[test]
fn xs6_all_items_of_the_robot() {
    let seen = decoded(
        "FA FF 36 71 10 20 02 FF FF 10 60 04 00 01 E2 40 20 10 10 3F 00 00 00 3F 00 00 00 BF 00 00 00 3F 00 00 00 20 30 0C
         41 20 00 00 C1 A0 00 00 43 33 80 00 40 20 0C 00 00 00 00 00 00 00 00 41 1D 00 00 40 30 0C 3E 80 00 00 BE 80 00 00
         00 00 00 00 80 20 0C 3F 00 00 00 BF 80 00 00 3E 00 00 00 C0 20 0C 3F 00 00 00 3E 80 00 00 BF 40 00 00 E0 20 04 00
         00 00 03 2A",
    );
    near(seen.quaternion, [0.5, 0.5, -0.5, 0.5], 0.0);
    near(seen.euler_deg, [10.0, -20.0, 179.5], 0.0);
    near(seen.acceleration_mps2, [0.0, 0.0, 9.8125], 0.0);
    near(seen.free_acceleration_mps2, [0.25, -0.25, 0.0], 0.0);
    near(seen.rate_of_turn_radps, [0.5, -1.0, 0.125], 0.0);
    near(seen.magnetic_field, [0.5, 0.25, -0.75], 0.0);
}

#[test]
fn xs7_mixed_formats_and_an_unknown_item() {
    let seen = decoded(
        "FA FF 36 55 10 20 02 00 00 20 37 18 3F F8 00 00 00 00 00 00 C0 02 00 00 00 00 00 00 C0 66 60 00 00 00 00 00 80 21
         0C 00 18 00 00 FF E8 00 00 00 00 04 00 40 22 12 CF 5C 28 F6 00 09 30 A3 D7 0A FF F6 80 00 00 00 FF FF E0 10 01 07
         08 10 04 42 12 00 00 7F F0 03 01 02 03 D9",
    );
    near(seen.euler_deg, [1.5, -2.25, -179.0], 0.0);
    near(seen.rate_of_turn_radps, [1.5, -1.5, 0.000_976_562_5], 0.0);
    near(seen.acceleration_mps2, [9.81, -9.81, -0.5], 1e-9);
    assert_eq!(seen.status, Some(StatusWord(7)));
    assert_eq!(seen.temperature_c, Some(36.5));
}

#[test]
fn what_is_wrong_is_refused() {
    let not_a_number = [0x40, 0x20, 12, 0x7F, 0xC0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    assert_eq!(Measurement::decode(&not_a_number), Err(MeasurementError::NotFinite));
    assert_eq!(Measurement::decode(&[0x40, 0x20, 12, 0]), Err(MeasurementError::Overrun));
    assert_eq!(Measurement::decode(&[0x40, 0x20, 1, 0]), Err(MeasurementError::Length));
    let mut zero_quaternion = std::vec![0x20, 0x10, 16];
    zero_quaternion.extend([0; 16]);
    assert_eq!(Measurement::decode(&zero_quaternion), Err(MeasurementError::Norm));
    assert!(StatusWord(1 << 11).is_clipping() && !StatusWord(0x7).is_clipping());
}

proptest! {
    #[test]
    fn any_bytes_are_a_measurement_or_an_error(data: Vec<u8>) {
        let _ = Measurement::decode(&data);
    }
}

/// XS-8.
#[test]
fn xs8_time_of_day() {
    let seen = decoded("FA FF 36 0F 10 10 0C 1D CD 65 00 07 E7 01 1F 17 3B 3A 07 A0");
    let utc = UtcTime {
        nanoseconds: 500_000_000,
        year: 2023,
        month: 1,
        day: 31,
        hour: 23,
        minute: 59,
        second: 58,
        flags: 7,
    };
    assert_eq!(seen.utc, Some(utc));
}

#[test]
fn status_bits_stand_where_the_specification_has_them() {
    let bit = |number: u32| StatusWord(1 << number);
    assert!(bit(0).self_test_passed() && bit(1).filter_valid() && bit(2).satellite_fix());
    assert_eq!(StatusWord(0b11_000).no_rotation(), NoRotation::Running);
    assert_eq!(StatusWord(0b10_000).no_rotation(), NoRotation::RotationDetected);
    assert_eq!(StatusWord(0b00_000).no_rotation(), NoRotation::Done);
    assert!(bit(5).representative_motion() && bit(6).clock_synchronised());
    for axis in 0..3 {
        let only = core::array::from_fn(|index| index == axis);
        assert_eq!(bit(8 + axis as u32).clipping_accelerometer(), only);
        assert_eq!(bit(11 + axis as u32).clipping_gyroscope(), only);
        assert_eq!(bit(14 + axis as u32).clipping_magnetometer(), only);
    }
    assert!(bit(21).sync_in() && bit(22).sync_out());
    assert_eq!(StatusWord(5 << 23).filter_mode(), 5);
    let clipping: Vec<u32> = (0..32).filter(|number| bit(*number).is_clipping()).collect();
    assert_eq!(clipping, [8, 9, 10, 11, 12, 13, 14, 15, 16, 19]);
}

/// Each flag of the status word is one bit (book, Xsens MTi: Data items).
#[test]
fn each_flag_of_the_status_is_one_bit() {
    type Meaning = fn(StatusWord) -> bool;
    let meanings: [(u32, Meaning); 6] = [
        (1, StatusWord::filter_valid),
        (2, StatusWord::satellite_fix),
        (5, StatusWord::representative_motion),
        (6, StatusWord::clock_synchronised),
        (21, StatusWord::sync_in),
        (22, StatusWord::sync_out),
    ];
    for (bit, meaning) in meanings {
        assert!(meaning(StatusWord(1 << bit)) && !meaning(StatusWord(!(1 << bit))), "bit {bit}");
    }
}

/// Items that no vector holds, each alone: coarse time, rotation matrix, pressure, high rates.
#[test]
fn items_that_few_devices_send() {
    let item = |kind: u16, data: &[u8]| {
        let mut bytes = kind.to_be_bytes().to_vec();
        bytes.push(data.len() as u8);
        bytes.extend(data);
        Measurement::decode(&bytes).unwrap()
    };
    let floats =
        |count: u8| (1..=count).flat_map(|value| f32::from(value).to_be_bytes()).collect::<Vec<u8>>();
    assert_eq!(item(0x1070, &[0, 0, 1, 2]).sample_time_coarse, Some(258));
    assert_eq!(item(0x3010, &[0, 1, 0x86, 0xA0]).pressure_pa, Some(100_000));
    assert_eq!(item(0x4040, &floats(3)).high_rate_acceleration_mps2, Some([1.0, 2.0, 3.0]));
    assert_eq!(item(0x8040, &floats(3)).high_rate_of_turn_radps, Some([1.0, 2.0, 3.0]));
    let by_columns = [[1.0, 4.0, 7.0], [2.0, 5.0, 8.0], [3.0, 6.0, 9.0]];
    assert_eq!(item(0x2020, &floats(9)).rotation_matrix, Some(by_columns));
}
