//! The bridge from scans of a ROS 2 driver to the scan link: what its Python sends, decoded and judged by plane geometry; and the example
//! of the book, which is the reference encoder's.

use std::process::Command;

use floorguard_configuration::BRIDGED_EXAMPLE;
use floorguard_drivers::scan_link::Decoder;
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

/// The lines that an example prints as its vector; `None` where there is no Python.
fn vector(script: &str) -> Option<Vec<String>> {
    let script = format!("{}/../examples/{script}", env!("CARGO_MANIFEST_DIR"));
    let Ok(output) = Command::new("python3").args(["-B", &script, "--vector"]).output() else {
        println!("skipped: there is no python3");
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect())
}

fn bytes_of(line: &str) -> Vec<u8> {
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    line.as_bytes().chunks(2).map(byte).collect()
}

/// A wall 4 m ahead, a box of 40 cm before it at 1.5 m, nothing behind.
fn expected_m(bearing: f64) -> Option<f64> {
    let ahead = bearing.cos();
    let wall_m = (ahead > 0.2).then(|| 4.0 / ahead);
    let is_box = ahead > 0.0 && (1.5 * bearing.tan()).abs() <= 0.2;
    if is_box { Some(1.5 / ahead) } else { wall_m }
}

#[test]
fn scans_of_ros_become_beams() {
    let Some(lines) = vector("ros2_scan_beams.py") else { return };
    let mut decoder = Decoder::new(BRIDGED_EXAMPLE);
    let mut scans = Vec::new();
    for (number, line) in (0_u64..).zip(&lines) {
        // Three datagrams of each come at once, when its turn is over.
        let arrival = Stamp::from_micros(10_000_000 + 100_000 * (number / 3 + 1));
        scans.extend(decoder.decode(&bytes_of(line), arrival).unwrap().cloned().map(|scan| (scan, arrival)));
    }
    // One of a device that turns counter-clockwise, one of a device that turns clockwise: the same room.
    assert_eq!((scans.len(), decoder.counters().refused, decoder.counters().lost), (2, 0, 0));
    for (scan, arrival) in &scans {
        let mut hits = 0;
        for (beam, found) in (0_u32..).zip(&scan.beams) {
            let bearing = (-180.0 + 0.25 * f64::from(beam)).to_radians();
            // At its sides the box begins or ends within a beam.
            let at_edge = ((1.5 * bearing.tan()).abs() - 0.2).abs() < 0.01;
            match (found, expected_m(bearing)) {
                (BeamReturn::Hit(range_mm), Some(range_m)) => {
                    hits += 1;
                    let difference_m = (f64::from(*range_mm) * 0.001 - range_m).abs();
                    assert!(difference_m < 0.001 || at_edge, "beam {beam}: {range_mm} mm, {range_m} m");
                }
                (BeamReturn::Unknown, None) => {}
                other => panic!("beam {beam}: {other:?}"),
            }
        }
        assert!(hits > 600, "{hits}");
        // The middle of a turn of 100 ms.
        let age_us = scan.stamp.past_us(*arrival);
        assert!((49_900..50_100).contains(&age_us), "{age_us} µs");
    }
}

#[test]
fn book_has_the_reference_vector() {
    let Some(lines) = vector("scan_beams.py") else { return };
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/src/wire-formats/scan-link.md");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(lines.len() == 1 && page.contains(&lines[0]), "{lines:?}");
}
