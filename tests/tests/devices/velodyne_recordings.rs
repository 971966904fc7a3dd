//! Every lidar recording against the keys that independent tools made of it.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_drivers::velodyne::{
    DecodeError, Decoder, Gprmc, Model, ModelChoice, Packet, PositionPacket, PpsState, Returns, ReturnsOf,
    SweepBuilder,
};
use floorguard_recording::capture::{Capture, CaptureError};
use floorguard_tests::data::recording;
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

const DATA_PORT: u16 = 2_368;
const POSITION_PORT: u16 = 8_308;

/// Rows of a key as columns by name.
fn key(path: &str) -> Option<Vec<BTreeMap<String, String>>> {
    let text = std::fs::read_to_string(recording(path)?).expect("a key is text");
    let mut lines = text.lines();
    let names: Vec<_> = lines.next().expect("a key has a header").split(',').map(str::to_owned).collect();
    Some(lines.map(|line| names.iter().cloned().zip(line.split(',').map(str::to_owned)).collect()).collect())
}

fn number(row: &BTreeMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|_| panic!("{name} is no number in {row:?}"))
}

fn payloads(path: &Path, port: u16) -> Vec<(Stamp, Vec<u8>)> {
    Capture::open(path)
        .expect("the recording opens")
        .map(|datagram| datagram.expect("the recording is whole"))
        .filter(|datagram| datagram.destination_port == port)
        .map(|datagram| (Stamp::from_micros(datagram.captured_us), datagram.payload))
        .collect()
}

const RECORDINGS: [(&str, &str); 5] = [
    ("cu_vlp16_single_600rpm", "pcap.gz"),
    ("einride_office_600rpm", "pcap.gz"),
    ("timm_hall_last_300rpm", "pcap.gz"),
    ("mrpt_gps_600rpm", "pcap"),
    ("lidarutils_2014fw_600rpm", "pcap"),
];

#[test]
fn integers_of_every_packet_equal_the_key() {
    for (name, ending) in RECORDINGS {
        let Some(path) = recording(&format!("vlp16_packets/{name}.{ending}")) else { continue };
        let Some(rows) = key(&format!("vlp16_packets/keys/{name}.packets.csv")) else { continue };
        let packets = payloads(&path, DATA_PORT);
        assert_eq!(packets.len(), rows.len(), "{name}");
        for ((_, payload), row) in packets.iter().zip(&rows) {
            let packet = Packet::new_checked(payload).unwrap_or_else(|error| panic!("{name}: {error}"));
            let azimuths = packet.azimuths();
            assert_eq!(f64::from(packet.stamp_us()), number(row, "sensor_us"), "{name}");
            assert_eq!(f64::from(azimuths[0]), number(row, "az0"), "{name}");
            assert_eq!(f64::from(azimuths[11]), number(row, "az11"), "{name}");
            let cells: Vec<_> = packet.blocks().flat_map(|block| block.channels()).collect();
            let hits = cells.iter().filter(|(raw, _)| *raw != 0);
            assert_eq!(hits.clone().count() as f64, number(row, "n_nonzero"), "{name}");
            let distance: u64 = hits.clone().map(|(raw, _)| u64::from(*raw)).sum();
            assert_eq!(distance as f64, number(row, "sum_dist_raw"), "{name}");
            let intensity: u64 = cells.iter().map(|(_, reflectivity)| u64::from(*reflectivity)).sum();
            assert_eq!(intensity as f64, number(row, "sum_intensity"), "{name}");
            let mut crc = flate2::Crc::new();
            crc.update(payload);
            assert_eq!(format!("{:08x}", crc.sum()), row["xor_crc32"], "{name}");
        }
    }
}

/// What the key tells of one revolution: blocks, then sums and extremes of its cells, then cells of each laser.
#[derive(Default)]
struct Revolution {
    blocks: u32,
    cells: u32,
    distance: u64,
    reflectivity: u64,
    extremes: Option<(u16, u16)>,
    lasers: [u32; 16],
}

#[test]
fn integers_of_every_revolution_equal_the_key() {
    for (name, ending) in RECORDINGS {
        let Some(path) = recording(&format!("vlp16_packets/{name}.{ending}")) else { continue };
        let Some(rows) = key(&format!("vlp16_packets/keys/{name}.revs_raw.csv")) else { continue };
        let mut revolutions = vec![Revolution::default()];
        let mut last = 0;
        for (_, payload) in payloads(&path, DATA_PORT) {
            let packet = Packet::new_checked(&payload).expect("checked by another test");
            for block in packet.blocks() {
                if last > block.azimuth_cdeg && last - block.azimuth_cdeg > 18_000 {
                    revolutions.push(Revolution::default());
                }
                last = block.azimuth_cdeg;
                let revolution = revolutions.last_mut().expect("never empty");
                revolution.blocks += 1;
                for (channel, (raw, reflectivity)) in block.channels().enumerate() {
                    if raw == 0 {
                        continue;
                    }
                    revolution.cells += 1;
                    revolution.distance += u64::from(raw);
                    revolution.reflectivity += u64::from(reflectivity);
                    let (least, most) = revolution.extremes.unwrap_or((raw, raw));
                    revolution.extremes = Some((least.min(raw), most.max(raw)));
                    revolution.lasers[channel % 16] += 1;
                }
            }
        }
        assert_eq!(revolutions.len(), rows.len(), "{name}");
        for (revolution, row) in revolutions.iter().zip(&rows) {
            assert_eq!(f64::from(revolution.blocks), number(row, "blocks"), "{name}");
            assert_eq!(f64::from(revolution.cells), number(row, "n_nonzero"), "{name}");
            assert_eq!(revolution.distance as f64, number(row, "sum_dist_raw"), "{name}");
            assert_eq!(revolution.reflectivity as f64, number(row, "sum_intensity_nonzero"), "{name}");
            let (least, most) = revolution.extremes.expect("every revolution has returns");
            assert_eq!(f64::from(least), number(row, "min_dist_raw"), "{name}");
            assert_eq!(f64::from(most), number(row, "max_dist_raw"), "{name}");
            for (laser, cells) in revolution.lasers.iter().enumerate() {
                assert_eq!(f64::from(*cells), number(row, &format!("n_laser{laser:02}")), "{name}");
            }
        }
    }
}

/// The two azimuth rules of the book, Velodyne: Azimuth.
#[derive(Clone, Copy, PartialEq)]
enum AzimuthRule {
    /// Ours: from each block to its successor; the last takes the gap before.
    PerBlock,
    /// The key's: one rate for the whole packet.
    PacketAverage,
}

/// Points of a single-return packet of a VLP-16 in double precision and straight from the bytes.
fn points_by(rule: AzimuthRule, payload: &[u8]) -> Vec<[f64; 3]> {
    let word = |at: usize| f64::from(u16::from_le_bytes([payload[at], payload[at + 1]]));
    let turned = |from: usize, to: usize| (word(100 * to + 2) - word(100 * from + 2) + 36_000.0) % 36_000.0;
    let mut points = Vec::new();
    for block in 0..12 {
        for channel in 0..32 {
            let raw = word(100 * block + 4 + 3 * channel);
            if raw == 0.0 {
                continue;
            }
            let (firing, laser) = (channel / 16, channel % 16);
            let within_ns = (55_296 * firing + 2_304 * laser) as f64;
            let gap = match rule {
                AzimuthRule::PerBlock => turned(block.min(10), block.min(10) + 1),
                AzimuthRule::PacketAverage => turned(0, 11) / 11.0,
            };
            let azimuth = (word(100 * block + 2) + gap * within_ns / 110_592.0).round();
            let azimuth = (azimuth / 100.0).to_radians();
            let elevation = if laser % 2 == 0 { laser as f64 - 15.0 } else { laser as f64 };
            let elevation = elevation.to_radians();
            let range_m = raw * 0.002;
            points.push([
                range_m * elevation.cos() * azimuth.cos(),
                -range_m * elevation.cos() * azimuth.sin(),
                range_m * elevation.sin() - 0.04191 * elevation.tan(),
            ]);
        }
    }
    points
}

#[test]
fn points_of_every_recording_equal_an_independent_decoder() {
    for (name, ending) in RECORDINGS {
        let Some(path) = recording(&format!("vlp16_packets/{name}.{ending}")) else { continue };
        let Some(rows) = key(&format!("vlp16_packets/keys/{name}.velodyne_decoder.csv")) else { continue };
        let returns = Returns::new(Model::Vlp16);
        let (mut reflectivity, mut worst_m) = (0_u64, 0.0_f64);
        let (mut count, mut sums) = (0_u32, [0.0_f64; 3]);
        for (_, payload) in payloads(&path, DATA_PORT) {
            let packet = Packet::new_checked(&payload).expect("checked by another test");
            let ours = points_by(AzimuthRule::PerBlock, &payload);
            let theirs = points_by(AzimuthRule::PacketAverage, &payload);
            let mut expected = ours.into_iter().zip(theirs);
            returns.for_each(&packet, ReturnsOf::DistinctEchoes, |each| {
                let point = each.point_in_sensor;
                let found = [point.x_m, point.y_m, point.z_m].map(f64::from);
                let (ours, theirs) = expected.next().expect("as many as in the bytes");
                let off_m = [0, 1, 2].map(|axis| (found[axis] - ours[axis]).abs());
                // 10 micrometres (book, Velodyne: Test packets), and single precision far away.
                let limit_m = 1.0e-5 + f64::from(each.distance_raw) * 0.002 * 5.0e-7;
                assert!(off_m.into_iter().all(|off_m| off_m < limit_m), "{name}: {each:?} against {ours:?}");
                worst_m = worst_m.max((ours[0] - theirs[0]).hypot(ours[1] - theirs[1]));
                // The key's decoder keeps 0.1 to 200 m.
                if each.distance_raw >= 50 {
                    count += 1;
                    reflectivity += u64::from(each.reflectivity);
                    sums.iter_mut().zip(theirs).for_each(|(sum, value)| *sum += value);
                }
            });
            assert!(expected.next().is_none(), "{name}: fewer than expected");
        }
        println!("{name}: {count} points; the azimuth rules are up to {worst_m:.6} m apart");
        let total = |column: &str| rows.iter().map(|row| number(row, column)).sum::<f64>();
        assert_eq!(f64::from(count), total("n_points"), "{name}");
        assert_eq!(reflectivity as f64, total("sum_intensity"), "{name}");
        // The packet's average is the key's own rule: 10 micrometres a point.
        let tolerance_m = f64::from(count) * 1.0e-5;
        for (sum, column) in sums.iter().zip(["sum_x", "sum_y", "sum_z"]) {
            let wanted = total(column);
            assert!((sum - wanted).abs() < tolerance_m, "{name} {column}: {sum} against {wanted}");
        }
    }
}

#[test]
fn single_packets_of_a_fourth_project_are_understood() {
    let Some(path) = recording("vlp16_packets/gadomski_single_packet.pcap") else { return };
    let packets = payloads(&path, DATA_PORT);
    assert_eq!(packets.len(), 1);
    let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let (columns, lost) = decoder.decode(&packets[0].1, packets[0].0).expect("a packet of a VLP-16");
    assert_eq!((columns.columns.len(), lost), (24, 0));
    let Some(path) = recording("vlp16_packets/gadomski_position_packet.pcap") else { return };
    let packets = payloads(&path, POSITION_PORT);
    assert_eq!(packets.len(), 1);
    PositionPacket::new_checked(&packets[0].1).expect("a position packet");
}

#[test]
fn sweeps_hold_every_return_once() {
    for (name, ending) in RECORDINGS {
        let Some(path) = recording(&format!("vlp16_packets/{name}.{ending}")) else { continue };
        let Some(rows) = key(&format!("vlp16_packets/keys/{name}.packets.csv")) else { continue };
        let mut decoder = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
        let mut builder = SweepBuilder::new(0);
        let mut building = Box::new(Sweep::<16>::EMPTY);
        let (mut hits, mut sweeps) = (0, 0);
        let count = |sweep: &Sweep<16>| -> usize {
            sweep.used_columns().iter().flat_map(|column| column.range_raw).filter(|raw| *raw != 0).count()
        };
        for (arrival, payload) in payloads(&path, DATA_PORT) {
            let (packet, lost) =
                decoder.decode(&payload, arrival).unwrap_or_else(|error| panic!("{name}: {error}"));
            builder.add(&packet, lost, &mut building, |sweep| {
                hits += count(sweep);
                sweeps += 1;
                assert_eq!(sweep.dropped_columns, 0, "{name}");
            });
        }
        hits += count(&building);
        let expected: f64 = rows.iter().map(|row| number(row, "n_nonzero")).sum();
        if name == "timm_hall_last_300rpm" {
            // At half the speed two or three firings share a column and the nearer return stays.
            assert!((0.33..0.6).contains(&(hits as f64 / expected)), "{hits} of {expected}");
        } else {
            assert_eq!(hits as f64, expected, "{name}");
        }
        let revolutions =
            key(&format!("vlp16_packets/keys/{name}.revs_raw.csv")).expect("present beside the other key");
        assert_eq!(sweeps + 1, revolutions.len(), "{name}");
        assert_eq!(decoder.counters().refused, 0, "{name}");
    }
}

#[test]
fn the_people_recording_decodes_to_its_key() {
    let Some(path) = recording("vlp16_clouds/fabu_hall_people_A_reencoded.pcap.gz") else { return };
    let Some(rows) = key("vlp16_clouds/fabu_hall_people_A_reencoded.frames.csv") else { return };
    let packets = payloads(&path, DATA_PORT);
    let mut decoder = Decoder::new(ModelChoice::Auto);
    for (arrival, payload) in &packets {
        decoder.decode(payload, *arrival).unwrap_or_else(|error| panic!("{error}"));
    }
    assert_eq!(decoder.model(), Some(Model::Vlp16));
    for row in &rows {
        let first = number(row, "first_packet") as usize;
        let count = number(row, "packets") as usize;
        let (mut hits, mut distance) = (0_u64, 0_u64);
        for (_, payload) in &packets[first..first + count] {
            let packet = Packet::new_checked(payload).expect("a data packet");
            for (raw, _) in packet.blocks().flat_map(|block| block.channels()) {
                hits += u64::from(raw != 0);
                distance += u64::from(raw);
            }
        }
        assert_eq!(hits as f64, number(row, "n_nonzero"));
        assert_eq!(distance as f64, number(row, "sum_dist_raw"));
    }
}

#[test]
fn position_packets_equal_the_key() {
    for (name, ending) in [("mrpt_gps_600rpm", "pcap"), ("lidarutils_2014fw_600rpm", "pcap")] {
        let Some(path) = recording(&format!("vlp16_packets/{name}.{ending}")) else { continue };
        let Some(rows) = key(&format!("vlp16_packets/keys/{name}.position.csv")) else { continue };
        let packets = payloads(&path, POSITION_PORT);
        assert_eq!(packets.len(), rows.len(), "{name}");
        for ((_, payload), row) in packets.iter().zip(&rows) {
            let position = PositionPacket::new_checked(payload).expect("a position packet");
            assert_eq!(f64::from(position.stamp_us()), number(row, "sensor_us"), "{name}");
            let expected = match row["pps_status_byte202"].as_str() {
                "0" => PpsState::Absent,
                "1" => PpsState::Synchronising,
                "2" => PpsState::Locked,
                _ => PpsState::Error,
            };
            assert_eq!(position.pps(), expected, "{name}");
            // The sentence holds commas itself: its first field is enough to find it in the split row.
            assert_eq!(position.sentence().split(',').next(), Some(row["nmea"].trim_matches('"')), "{name}");
            assert_eq!(Gprmc::parse(position.sentence()).is_ok(), name.starts_with("mrpt"), "{name}");
        }
    }
}

#[test]
fn an_hdl32e_is_not_taken_for_a_vlp16() {
    let Some(path) = recording("vlp16_packets/NEG_hdl32e_monterey_200pkts.pcap") else { return };
    let mut forced = Decoder::new(ModelChoice::Fixed(Model::Vlp16));
    let mut automatic = Decoder::new(ModelChoice::Auto);
    let mut accepted_by_forced = 0;
    for (arrival, payload) in payloads(&path, DATA_PORT) {
        match forced.decode(&payload, arrival) {
            Ok(_) => accepted_by_forced += 1,
            Err(DecodeError::WrongModel { configured, product_byte, .. }) => {
                assert_eq!((configured, product_byte), (Model::Vlp16, 0x21));
            }
            Err(other) => panic!("{other}"),
        }
        let _ = automatic.decode(&payload, arrival);
    }
    // One packet alone cannot tell; the second does, for good.
    assert!(accepted_by_forced <= 1, "{accepted_by_forced}");
    assert_eq!(automatic.model(), Some(Model::Hdl32E));
}

#[test]
fn truncated_capture_is_used_and_reported() {
    let Some(path) = recording("vlp16_packets/mrpt_gps_600rpm.pcap") else { return };
    let bytes = std::fs::read(path).expect("the recording is readable");
    let whole = Capture::read("whole", std::io::Cursor::new(bytes.clone())).expect("a capture").count();
    let cut = bytes.len() - 700;
    let mut capture = Capture::read("cut", std::io::Cursor::new(bytes[..cut].to_vec())).expect("a capture");
    let delivered = capture.by_ref().take_while(Result::is_ok).count();
    assert!(delivered + 2 >= whole && delivered < whole, "{delivered} of {whole}");
    let mut again = Capture::read("cut", std::io::Cursor::new(bytes[..cut].to_vec())).expect("a capture");
    let error = again.find_map(Result::err);
    assert!(matches!(error, Some(CaptureError::Truncated { .. })), "{error:?}");
    let text = Capture::read("text", std::io::Cursor::new(b"no capture at all, just words".to_vec()));
    assert!(matches!(text.err(), Some(CaptureError::NotACapture { .. })));
}
