//! The bridge from clouds of a ROS 2 driver to the lidar link: what its Python sends, decoded and judged by plane geometry.

use std::process::Command;

use floorguard_drivers::lidar_link::Decoder;
use floorguard_types::time::Stamp;

/// The datagrams of two turns in a round room of 3 m, 0.8 m above its floor, seen by 64 rings; `None` where there is no Python.
fn datagrams() -> Option<Vec<Vec<u8>>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/ros2_lidar_columns.py");
    let Ok(output) = Command::new("python3").args(["-B", script, "--vector"]).output() else {
        println!("skipped: there is no python3");
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    Some(lines.lines().map(|line| line.as_bytes().chunks(2).map(byte).collect()).collect())
}

#[test]
fn clouds_of_ros_become_columns() {
    let Some(datagrams) = datagrams() else { return };
    let mut decoder = Decoder::new(16);
    let (mut columns, mut cells, mut next_cdeg) = (0, 0, None);
    for (number, bytes) in (0_u64..).zip(&datagrams) {
        // Both turns come at once, each when it is over.
        let arrival = Stamp::from_micros(10_000_000 + 100_000 * (number / 57 + 1));
        let (packet, lost) = decoder.decode(bytes, arrival).unwrap();
        assert_eq!((packet.rings, packet.range_unit_mm, lost), (16, 4, 0));
        for column in &packet.columns {
            columns += 1;
            let azimuth_cdeg = column.azimuth_cdeg;
            assert!(next_cdeg.is_none_or(|next| next == azimuth_cdeg), "{azimuth_cdeg} after {next_cdeg:?}");
            next_cdeg = Some((azimuth_cdeg + 40) % 36_000);
            for (ring, raw) in (0_u8..).zip(column.range_raw.iter().take(16)).filter(|(_, raw)| **raw != 0) {
                cells += 1;
                let elevation = (-15.0 + 2.0 * f32::from(ring)).to_radians();
                let plane_m = f32::from(*raw) * 0.004 * elevation.cos();
                // The nearest point of a ring lies up to a degree below its elevation, on the floor or at the wall.
                let down = (1.0_f32.to_radians() - elevation).tan();
                let floor_m = if down > 0.0 { 0.8 / down } else { f32::INFINITY };
                assert!(plane_m < 3.005 && plane_m > floor_m.min(3.0) - 0.005, "{plane_m} m in ring {ring}");
            }
        }
    }
    assert!(columns == 16 * datagrams.len() && columns > 1_700, "{columns} columns");
    // 64 rings 0.7° apart reach every ring, and 1,024 of their columns every column of ours.
    assert_eq!(cells, 16 * columns);
}
