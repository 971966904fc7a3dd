//! Runs the published logs through the mapping and prints the relation errors.

use std::io::Read;
use std::path::{Path, PathBuf};

use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::ScanRecord;
use floorguard_mapping_host::mapper::{MapConfig, Mapper};
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
            }
        })
        .collect()
}

/// The default settings, changed by `SET=name=value,…`.
fn settings() -> MapConfig {
    let mut config = MapConfig::default();
    let text = std::env::var("SET").unwrap_or_default();
    for pair in text.split(',').filter(|p| !p.is_empty()) {
        let (name, value) = pair.split_once('=').unwrap();
        let v: f64 = value.parse().unwrap();
        match name {
            "travel" => config.front_end.travel_m = v,
            "turn" => config.front_end.turn_rad = v,
            "range" => config.front_end.range_most_m = v as f32,
            "map_travel" => config.front_end.map_travel_m = v,
            "map_nodes" => config.front_end.map_nodes = v as usize,
            "dev" => config.front_end.descent.return_deviation_m = v as f32,
            "reach" => config.front_end.descent.reach_m = v as f32,
            "out" => config.align.outlier_m = v,
            "pdev" => config.align.point_deviation_m = v,
            "share" => config.align.matched_share = v,
            "recent" => config.align.pairs.recent = v as usize,
            "recent_max" => config.align.pairs.recent_max = v as usize,
            "other_max" => config.align.pairs.other_max = v as usize,
            "pdist" => config.align.pairs.distance_m = v,
            "pturn" => config.align.pairs.turn_rad = v,
            "last" => config.align.distances_m.extend([v as f32; 4]),
            "ratio" => config.loops.loss_ratio = v as f32,
            "score" => config.loops.score_least = v as f32,
            "stretch" => config.loops.stretch_m = v,
            _ => panic!("{name}"),
        }
    }
    config
}

/// Processor time of this thread, seconds.
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
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
    for (name, log, key) in all {
        if !which.is_empty() && !which.iter().any(|w| w == name) {
            continue;
        }
        evaluate(name, &data.join(log), &data.join(key));
    }
}

/// Maps a log, and prints its errors before and after the final alignment.
fn evaluate(name: &str, log: &Path, key: &Path) {
    let text = unpack(log);
    let records = if log.to_string_lossy().contains("clf") { carmen(&text) } else { rebuilt(&text) };
    // A millionth of the ranges decides nothing; a result that hangs on it is luck.
    let parts: f32 = std::env::var("PARTS_PER_MILLION").map_or(0.0, |text| text.parse().unwrap());
    let mut records = records;
    records
        .iter_mut()
        .flat_map(|record| &mut record.ranges_m)
        .for_each(|range| *range *= 1.0 + parts * 1.0e-6);
    let relations = read_relations(&unpack(key)).unwrap();
    let mut mapper = Mapper::new(settings());
    let show = |what: &str, mapper: &Mapper, since: f64| {
        let path = if what == "matched" { mapper.matched_trajectory() } else { mapper.trajectory() };
        let score = score_relations(&relations, &path, 0.6);
        println!(
            "{name:9} {what:8} {} nodes  {:.4} m max {:.3}  {:.3} deg missing {} cpu {:.0} ms",
            mapper.poses.len(),
            score.translation_mean_m(),
            score.translation_max_m(),
            score.rotation_mean_rad().to_degrees(),
            score.without_pose,
            (cpu_s() - since) * 1e3
        );
    };
    let start = cpu_s();
    let mut worst = 0.0_f64;
    for record in &records {
        let t = cpu_s();
        mapper.push(record).unwrap();
        worst = worst.max(cpu_s() - t);
    }
    show("online", &mapper, start);
    println!(
        "{name:9} {:?} loops {} worst {:.1} ms",
        mapper.closer.statistics,
        mapper.loops.len(),
        worst * 1e3
    );
    let start = cpu_s();
    mapper.finish().unwrap();
    show("aligned", &mapper, start);
    let start = cpu_s();
    show("matched", &mapper, start);
}
