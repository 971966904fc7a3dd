//! Writes what our tools generate as the targets' first inputs: `corpus/TARGET/NUMBER` beside this package.

use std::fs;
use std::path::Path;

use floorguard_fuzz::{corpus, joined, ouster, scanning_corpus};
use floorguard_configuration::EXAMPLE;
use floorguard_tests::fuzz::{bridged_datagrams, bridged_samples, bridged_scans, livox_datagrams, cola_scans, files, messages, rplidar_turns};

/// Files for one target; of a long stream its beginning says enough.
const FILES_MAX: usize = 200;

fn main() -> std::io::Result<()> {
    let simulated = corpus();
    let lines: Vec<Vec<u8>> =
        simulated.can.iter().map(|frame| floorguard_sim::can::encode_slcan(frame).into_bytes()).collect();
    let scan = messages::microscan3_message(40);
    // Inputs that are read as numbers need no example of them, only space for some.
    let numbers: Vec<Vec<u8>> = (0..8).map(|value: u8| vec![value.wrapping_mul(37); 512]).collect();
    let of_targets: [(&str, Vec<Vec<u8>>); 21] = [
        ("velodyne", simulated.lidar.chunks(2).map(joined).collect()),
        ("position", simulated.position.clone()),
        ("s300", simulated.scanner.clone()),
        ("slcan", lines.chunks(8).map(|lines| lines.concat()).collect()),
        ("base", numbers.clone()),
        ("xsens", [simulated.imu.clone(), messages::xsens_messages()].concat()),
        ("vectornav", messages::vectornav_messages().chunks(4).map(|sent| sent.concat()).collect()),
        ("microscan3", vec![joined(&messages::microscan3_datagrams(&scan, 1)), scan]),
        ("velocity_link", messages::velocity_requests().chunks(8).map(joined).collect()),
        ("configuration", [vec![EXAMPLE.as_bytes().to_vec()], files::sections_of(EXAMPLE)].concat()),
        ("recording", vec![messages::recording()]),
        ("scip", scanning_corpus().replies.clone()),
        ("ouster", ouster().1.chunks(2).map(joined).collect()),
        ("lidar-link", bridged_datagrams().chunks(4).map(joined).collect()),
        ("imu-link", bridged_samples().chunks(4).map(|frames| frames.concat()).collect()),
        ("scan-link", bridged_scans().chunks(4).map(joined).collect()),
        ("livox", livox_datagrams().chunks(20).map(joined).collect()),
        ("cola", cola_scans()),
        ("rplidar", rplidar_turns().chunks(8).map(|answer| answer.concat()).collect()),
        ("scan_motor", numbers.clone()),
        ("runtime", numbers),
    ];
    for (target, inputs) in of_targets {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
        fs::create_dir_all(&folder)?;
        for (number, input) in inputs.iter().take(FILES_MAX).enumerate() {
            fs::write(folder.join(number.to_string()), input)?;
        }
        println!("{target}: {} inputs", inputs.len().min(FILES_MAX));
    }
    Ok(())
}
