//! Runs the published logs through the mapping of a microcontroller and prints the relation errors, how much of its room is used, and
//! the time a scan takes.

use std::path::Path;

use floorguard_localisation::graph_mapping::{GraphMappingConfig, MappingStep, OfMicrocontroller};
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::metrics::{read_relations, score_relations};

mod published;

fn main() {
    let data = published::folder();
    let which: Vec<String> = std::env::args().skip(1).collect();
    println!("{} bytes", size_of::<OfMicrocontroller>());
    for [name, log, key] in published::LOGS {
        if which.is_empty() || which.iter().any(|w| w == name) {
            evaluate(name, &data.join(log), &data.join(key));
        }
    }
}

fn evaluate(name: &str, log: &Path, key: &Path) {
    let records = published::records(log);
    let relations = read_relations(&published::unpack(key)).unwrap();
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
