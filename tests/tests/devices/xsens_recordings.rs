//! Recordings of a real MTi against the text of an independent decoder and an item-by-item key.
//!
//! Whole numbers are exact. The text has every digit of a double, so that numbers are compared bit for bit; the items
//! have nine digits.

use std::collections::BTreeMap;
use std::io::Read as _;

use floorguard_drivers::xsens::{FrameReceiver, Item, Items, LocalFrame, Measurement, NumberFormat, encode};
use floorguard_tests::data::recording;
use floorguard_types::time::Stamp;

/// What stands in front of an item's numbers in the text.
const NAMES: [(&str, u16); 19] = [
    ("Temperature", 0x0810),
    ("UTCTime", 0x1010),
    ("PacketCounter", 0x1020),
    ("SampleTimeFine", 0x1060),
    ("SampleTimeCoarse", 0x1070),
    ("Quaternion", 0x2010),
    ("RotationMatrix", 0x2020),
    ("EulerAngles", 0x2030),
    ("BaroPressure", 0x3010),
    ("DeltaV", 0x4010),
    ("Acceleration", 0x4020),
    ("FreeAcceleration", 0x4030),
    ("AltitudeEllipsoid", 0x5020),
    ("PositionECEF", 0x5030),
    ("LatLon", 0x5040),
    ("RateOfTurn", 0x8020),
    ("DeltaQ", 0x8030),
    ("MagneticField", 0xC020),
    ("VelocityXYZ", 0xD010),
];

fn unpacked(path: &str) -> Option<String> {
    let mut text = String::new();
    let file = std::fs::File::open(recording(path)?).unwrap();
    flate2::read::GzDecoder::new(file).read_to_string(&mut text).unwrap();
    Some(text)
}

/// Data of all messages, received in portions of changing size, with the place of each in the file.
fn messages(number: u8) -> Option<Vec<(usize, Vec<u8>)>> {
    let bytes = std::fs::read(recording(&format!("xsens_mti/{number}_output.bin"))?).unwrap();
    let mut receiver = FrameReceiver::new();
    let (mut found, mut begin) = (Vec::new(), 0);
    let mut rest = bytes.as_slice();
    for size in (1..200).cycle() {
        let (portion, after) = rest.split_at(size.min(rest.len()));
        receiver.push(portion, Stamp::ZERO, |message, length| {
            assert_eq!(message.id, 0x36);
            found.push((begin, message.data.to_vec()));
            begin += length;
        });
        rest = after;
        if rest.is_empty() {
            break;
        }
    }
    let counters = receiver.counters();
    assert_eq!((counters.frames, counters.checksum_failures, counters.skipped), (100, 0, 0));
    assert_eq!(begin, bytes.len());
    Some(found)
}

fn numbers(item: &Item<'_>) -> Vec<f64> {
    let size = match item.format {
        NumberFormat::Float32 | NumberFormat::Fixed1220 => 4,
        NumberFormat::Fixed1632 => 6,
        NumberFormat::Float64 => 8,
    };
    match item.data.len() / size {
        1 => item.numbers::<1>().unwrap().to_vec(),
        2 => item.numbers::<2>().unwrap().to_vec(),
        3 => item.numbers::<3>().unwrap().to_vec(),
        4 => item.numbers::<4>().unwrap().to_vec(),
        9 => item.numbers::<9>().unwrap().to_vec(),
        count => panic!("{count} numbers in {:04X}", item.kind),
    }
}

/// The identifier as it stands on the wire.
fn identifier(item: &Item<'_>) -> u16 {
    let frame = match item.local_frame {
        Some(LocalFrame::EastNorthUp) => 0,
        Some(LocalFrame::NorthEastDown) => 4,
        Some(LocalFrame::NorthWestUp) => 8,
        None => 12,
    };
    let format = match item.format {
        NumberFormat::Float32 => 0,
        NumberFormat::Fixed1220 => 1,
        NumberFormat::Fixed1632 => 2,
        NumberFormat::Float64 => 3,
    };
    item.kind | frame | format
}

/// Whole numbers, and structures of satellite receivers that are skipped.
fn is_number_list(kind: u16) -> bool {
    !matches!(kind, 0x1010..=0x1070 | 0x3010 | 0x7010 | 0x7020 | 0xE010 | 0xE020)
}

#[test]
fn every_item_equals_its_key() {
    for number in [1, 2, 5] {
        let (Some(messages), Some(key)) =
            (messages(number), unpacked(&format!("xsens_mti/{number}_items.csv.gz")))
        else {
            return;
        };
        let mut rows = key.lines().skip(1).map(|row| row.split(',').collect::<Vec<_>>());
        let mut count = 0;
        for (begin, data) in &messages {
            for item in Items::new(data) {
                let item = item.unwrap();
                let row = rows.next().expect("as many rows as items");
                count += 1;
                assert_eq!(row[1].parse::<usize>().unwrap(), *begin);
                assert_eq!(format!("0x{:04x}", identifier(&item)), row[2].to_lowercase());
                assert_eq!(item.data.len(), row[3].parse::<usize>().unwrap());
                let hexadecimal: String = item.data.iter().map(|byte| format!("{byte:02x}")).collect();
                assert_eq!(hexadecimal, row[5]);
                if row[4] == "raw" {
                    continue;
                }
                let key: Vec<f64> = row[4].split(' ').map(|number| number.parse().unwrap()).collect();
                if is_number_list(item.kind) {
                    let seen = numbers(&item);
                    assert_eq!(seen.len(), key.len());
                    for (seen, key) in seen.iter().zip(&key) {
                        assert!((seen - key).abs() <= 5.1e-9 * key.abs(), "{row:?}: {seen}");
                    }
                } else {
                    assert_eq!(f64::from(item.whole(item.data.len()).unwrap()), key[0], "{row:?}");
                }
            }
        }
        assert!(rows.next().is_none(), "as many items as rows");
        assert!(count > 700, "{count}");
    }
}

/// One message of the text: item → lines behind it.
type Reported = BTreeMap<String, Vec<String>>;

fn reported(text: &str) -> Vec<Reported> {
    text.trim_end()
        .split("\n\n")
        .map(|message| {
            let mut items = Reported::new();
            let mut name = String::new();
            for line in message.lines() {
                if let Some(value) = line.strip_prefix("  ") {
                    let value =
                        value.rsplit_once(':').filter(|(label, _)| label.len() <= 5 && name != "UTCTime");
                    let number = value.map_or(line.trim(), |(_, number)| number.trim());
                    items.entry(name.clone()).or_default().push(number.to_owned());
                } else {
                    name = line.split(['(', ':']).next().unwrap().to_owned();
                }
            }
            items
        })
        .collect()
}

#[test]
fn messages_equal_an_independent_decoders_text() {
    for number in [1, 2, 5] {
        let (Some(messages), Some(text)) =
            (messages(number), unpacked(&format!("xsens_mti/{number}_output.golden.gz")))
        else {
            return;
        };
        let reported = reported(&text);
        assert_eq!(reported.len(), messages.len());
        let mut compared = 0;
        for ((_, data), reported) in messages.iter().zip(&reported) {
            let measurement = Measurement::decode(data).unwrap();
            let items: BTreeMap<u16, Vec<f64>> = Items::new(data)
                .map(Result::unwrap)
                .filter(|item| is_number_list(item.kind))
                .map(|item| (item.kind, numbers(&item)))
                .collect();
            for (name, values) in reported {
                compared += 1;
                compare(name, values, &measurement, &items);
            }
        }
        assert!(compared > 700, "{compared}");
    }
}

fn compare(name: &str, values: &[String], measurement: &Measurement, items: &BTreeMap<u16, Vec<f64>>) {
    let binary = |text: &str| u32::from_str_radix(text, 2).unwrap();
    match name {
        "StatusWord" | "StatusByte" => assert_eq!(measurement.status.unwrap().0, binary(&values[0])),
        "UTCTime" => {
            let utc = measurement.utc.unwrap();
            let (year, month, day) = (utc.year, utc.month, utc.day);
            let (hour, minute, second) = (utc.hour, utc.minute, utc.second);
            let fraction = format!("{:09}", utc.nanoseconds);
            let point = if utc.nanoseconds == 0 { "" } else { "." };
            let text = format!(
                "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}{point}{}Z",
                fraction.trim_end_matches('0')
            );
            assert_eq!(text, values[0]);
        }
        "PacketCounter" => assert_eq!(measurement.packet_counter.unwrap().to_string(), values[0]),
        "SampleTimeFine" => assert_eq!(measurement.sample_time_fine.unwrap().to_string(), values[0]),
        "SampleTimeCoarse" => assert_eq!(measurement.sample_time_coarse.unwrap().to_string(), values[0]),
        "BaroPressure" => assert_eq!(measurement.pressure_pa.unwrap().to_string(), values[0]),
        "GNSSPVTData" | "GNSSSatInfo" => {}
        _ => {
            let (_, kind) =
                NAMES.iter().find(|(known, _)| *known == name).unwrap_or_else(|| panic!("{name}"));
            let key: Vec<f64> = values.iter().map(|number| number.parse().unwrap()).collect();
            assert_eq!(items[kind], key, "{name}");
            assert_eq!(typed(*kind, measurement).unwrap_or_else(|| key.clone()), key, "{name}");
        }
    }
}

/// The same numbers as the typed measurement has them.
fn typed(kind: u16, measurement: &Measurement) -> Option<Vec<f64>> {
    match kind {
        0x0810 => measurement.temperature_c.map(|number| vec![number]),
        0x2010 => measurement.quaternion.map(|numbers| numbers.to_vec()),
        0x2030 => measurement.euler_deg.map(|numbers| numbers.to_vec()),
        0x4010 => measurement.delta_velocity_mps.map(|numbers| numbers.to_vec()),
        0x4020 => measurement.acceleration_mps2.map(|numbers| numbers.to_vec()),
        0x4030 => measurement.free_acceleration_mps2.map(|numbers| numbers.to_vec()),
        0x8020 => measurement.rate_of_turn_radps.map(|numbers| numbers.to_vec()),
        0x8030 => measurement.delta_quaternion.map(|numbers| numbers.to_vec()),
        0xC020 => measurement.magnetic_field.map(|numbers| numbers.to_vec()),
        // Of satellites, or in another order.
        _ => None,
    }
}

/// The manual leaves the order of the matrix open; the quaternion of the same message settles it.
#[test]
fn the_rotation_matrix_agrees_with_the_quaternion() {
    let Some(messages) = messages(5) else { return };
    let mut compared = 0;
    for (_, data) in &messages {
        let measurement = Measurement::decode(data).unwrap();
        let (Some([w, x, y, z]), Some(matrix)) = (measurement.quaternion, measurement.rotation_matrix) else {
            continue;
        };
        compared += 1;
        let from_quaternion = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ];
        for (seen, wanted) in matrix.iter().flatten().zip(from_quaternion.iter().flatten()) {
            assert!((seen - wanted).abs() < 1e-6, "{matrix:?} {from_quaternion:?}");
        }
    }
    assert_eq!(compared, 92);
}

/// Real data with real damage: each flipped bit costs the frame that it hits, and at most the next one.
#[test]
fn a_flipped_bit_costs_its_frame() {
    let Some(path) = recording("xsens_mti/1_output.bin") else { return };
    let bytes = std::fs::read(path).unwrap();
    for bit in (0..bytes.len() * 8).step_by(1_009) {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        // What follows the recording is what a false length may wait for.
        for _ in 0..500 {
            damaged.extend_from_slice(&encode(0x31, &[]).unwrap());
        }
        let mut receiver = FrameReceiver::new();
        let (mut data, mut others) = (0, 0);
        receiver.push(&damaged, Stamp::ZERO, |message, _| match message.id {
            0x36 => data += 1,
            _ => others += 1,
        });
        assert!((98..=99).contains(&data), "bit {bit}: {data} messages left");
        assert!(others >= 499, "bit {bit}: {others}");
    }
}
