//! Runs the published logs through the mapping of a microcontroller and prints the relation errors, how much of its room is used, and
//! the time a scan takes.

use std::io::Read;
use std::path::{Path, PathBuf};

use floorguard_localisation::graph_mapping::{GraphMappingConfig, MappingStep, OfMicrocontroller};
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::ScanRecord;
use floorguard_mapping_host::metrics::{read_relations, score_relations};

fn unpack(path: &Path) -> String {
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

fn main() {
    let data = PathBuf::from("../shared/data/slam2d_logs");
    let which: Vec<String> = std::env::args().skip(1).collect();
    let all = [
        ("aces", "radish_aces.clf.bz2", "keys/radish_aces.relations"),
        ("intel", "radish_intel.clf.bz2", "intel.pseudo_relations.gz"),
        ("fr101", "fr101.rebuilt_odometry.scans.gz", "fr101.pseudo_relations.gz"),
        ("edmonton", "edmonton.rebuilt_odometry.scans.gz", "edmonton.pseudo_relations.gz"),
        ("fhw", "fhw.rebuilt_odometry.scans.gz", "fhw.pseudo_relations.gz"),
    ];
    println!("{} bytes", size_of::<OfMicrocontroller>());
    for (name, log, key) in all {
        if which.is_empty() || which.iter().any(|w| w == name) {
            evaluate(name, &data.join(log), &data.join(key));
        }
    }
}

fn evaluate(name: &str, log: &Path, key: &Path) {
    let text = unpack(log);
    let records = if log.to_string_lossy().contains("clf") { carmen(&text) } else { rebuilt(&text) };
    let relations = read_relations(&unpack(key)).unwrap();
    let config = GraphMappingConfig::default();
    let mut mapper = Box::new(OfMicrocontroller::new(config).unwrap());
    let (mut places, mut full_at, mut worst_ms) = (Vec::new(), None, 0.0_f64);
    let began = std::time::Instant::now();
    for record in &records {
        let start = std::time::Instant::now();
        let points = record.points(config.range_least_m, config.range_most_m);
        let step = mapper.push(&points, record.odometry.unwrap().single());
        worst_ms = worst_ms.max(start.elapsed().as_secs_f64() * 1.0e3);
        if step == MappingStep::Full && full_at.is_none() {
            full_at = Some(record.time_s);
        }
        places.push((record.time_s, mapper.pose_in_scan()));
    }
    let mean_ms = began.elapsed().as_secs_f64() * 1.0e3 / records.len() as f64;
    let path: Vec<(f64, Se2)> = places
        .into_iter()
        .map(|(time_s, (scan, pose))| (time_s, mapper.scans()[usize::from(scan)].pose.compose(pose).into()))
        .collect();
    let score = score_relations(&relations, &path, 0.6);
    println!(
        "{name:9} {:.4} m max {:.3}  {:.3} deg missing {}; {} scans, {} edges, full after {:.0?} s; {mean_ms:.2} ms a scan, at most {worst_ms:.1}",
        score.translation_mean_m(),
        score.translation_max_m(),
        score.rotation_mean_rad().to_degrees(),
        score.without_pose,
        mapper.scans().len(),
        mapper.edges().len(),
        full_at.map(|at| at - records[0].time_s)
    );
    println!("          {:?}", mapper.counters());
}
