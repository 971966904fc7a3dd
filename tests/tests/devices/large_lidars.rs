//! Lidars of 32 rings as a robot's file names them: every ring for the guard, sixteen for people.

use std::collections::BTreeSet;

use floorguard_configuration::{EXAMPLE, parse};
use floorguard_drivers::lidar::LidarDecoder as _;
use floorguard_recording::LidarView;
use floorguard_recording::capture::{Capture, LIDAR_DATA_PORT};
use floorguard_tests::data::recording;
use floorguard_types::sensing::LidarPacket;
use floorguard_types::time::Stamp;

/// A recorded HDL-32E: its packets have 32 rings with returns, and the sweeps the elevations of the sixteen chosen ones.
#[test]
fn recorded_hdl32e_fills_guard_packets_and_sweeps() {
    let Some(file) = recording("vlp16_packets/NEG_hdl32e_monterey_200pkts.pcap") else { return };
    let text = EXAMPLE.replace("model = \"vlp16\"", "model = \"hdl32e\"");
    let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
    let mut decoder = robot.lidar_decoder();
    let mut view = LidarView::new(robot.lidar_decoder(), robot.ring_angles(), 1);
    let mut packet = LidarPacket::EMPTY;
    let (mut rings, mut sweeps) = (BTreeSet::new(), Vec::new());
    for datagram in Capture::open(&file).expect("it opens") {
        let datagram = datagram.expect("it is whole");
        if datagram.destination_port != LIDAR_DATA_PORT {
            continue;
        }
        let arrival = Stamp::from_micros(datagram.captured_us);
        // The first packets tell no model apart; the robot's file does.
        if decoder.decode_datagram(&datagram.payload, arrival, &mut packet).is_ok() {
            let columns = packet.columns.iter().flat_map(|column| column.range_raw.iter().enumerate());
            rings.extend(columns.filter(|(_, raw)| **raw > 0).map(|(ring, _)| ring));
        }
        sweeps.extend(view.push(&datagram.payload, arrival));
    }
    assert_eq!(rings.len(), 32, "the guard sees returns of every ring");
    let points: Vec<_> = sweeps.iter().flat_map(|(_, points)| points).collect();
    assert!(points.len() > 2_000, "{} points in {} sweeps", points.len(), sweeps.len());
    let chosen_deg = robot.ring_angles().rings.map(|(sine, ..)| sine.asin().to_degrees());
    for point in points {
        let [x_m, y_m, z_m] = point.position_m;
        let elevation_deg = z_m.atan2(x_m.hypot(y_m)).to_degrees();
        let expected_deg = chosen_deg[usize::from(point.ring)];
        // The lasers leave a little beside the centre: seen from 2 m by up to a degree.
        let beside_deg = (0.03_f32 / x_m.hypot(y_m)).to_degrees() + 0.05;
        assert!((elevation_deg - expected_deg).abs() < beside_deg, "{elevation_deg} for {expected_deg}");
    }
}
