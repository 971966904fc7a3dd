//! The published logs and their relations, as the examples read them.

use std::io::Read;
use std::path::{Path, PathBuf};

use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::ScanRecord;

/// Name, log and relations of each, in the folder of [`folder`].
pub const LOGS: [[&str; 3]; 5] = [
    ["aces", "radish_aces.clf.bz2", "keys/radish_aces.relations"],
    ["intel", "radish_intel.clf.bz2", "intel.pseudo_relations.gz"],
    ["fr101", "fr101.rebuilt_odometry.scans.gz", "fr101.pseudo_relations.gz"],
    ["edmonton", "edmonton.rebuilt_odometry.scans.gz", "edmonton.pseudo_relations.gz"],
    ["fhw", "fhw.rebuilt_odometry.scans.gz", "fhw.pseudo_relations.gz"],
];

/// Where they lie.
pub fn folder() -> PathBuf {
    PathBuf::from("../shared/data/slam2d_logs")
}

/// The scans of a log.
pub fn records(log: &Path) -> Vec<ScanRecord> {
    let text = unpack(log);
    if log.to_string_lossy().contains("clf") { carmen(&text) } else { rebuilt(&text) }
}

/// The text of a packed file.
pub fn unpack(path: &Path) -> String {
    let file = std::fs::File::open(path).unwrap();
    let mut text = String::new();
    if path.extension().is_some_and(|e| e == "gz") {
        flate2::read::MultiGzDecoder::new(file).read_to_string(&mut text).unwrap();
    } else if path.extension().is_some_and(|e| e == "bz2") {
        bzip2::read::MultiBzDecoder::new(file).read_to_string(&mut text).unwrap();
    } else {
        std::io::BufReader::new(file).read_to_string(&mut text).unwrap();
    }
    text
}

fn carmen(text: &str) -> Vec<ScanRecord> {
    let mut records = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("FLASER")) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let beams: usize = words[1].parse().unwrap();
        let number = |i: usize| words[2 + beams + i].parse::<f64>().unwrap();
        records.push(ScanRecord {
            time_s: number(6),
            odometry: Some(Se2::new(number(0), number(1), number(2))),
            first_angle_rad: -std::f32::consts::FRAC_PI_2,
            step_rad: std::f32::consts::PI / beams as f32,
            ranges_m: words[2..2 + beams].iter().map(|w| w.parse().unwrap()).collect(),
            ..ScanRecord::default()
        });
    }
    records
}

fn rebuilt(text: &str) -> Vec<ScanRecord> {
    text.lines()
        .map(|line| {
            let n: Vec<f64> = line.split_whitespace().map(|w| w.parse().unwrap()).collect();
            ScanRecord {
                time_s: n[0],
                odometry: Some(Se2::new(n[1], n[2], n[3])),
                first_angle_rad: n[5] as f32,
                step_rad: n[6] as f32,
                ranges_m: n[7..].iter().map(|r| *r as f32).collect(),
                ..ScanRecord::default()
            }
        })
        .collect()
}
