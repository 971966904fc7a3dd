//! Runs the published logs through the mapping and prints the relation errors.

use std::path::Path;

use floorguard_mapping_host::Se2;
use floorguard_mapping_host::input::ScanRecord;
use floorguard_mapping_host::mapper::{MapConfig, Mapper};
use floorguard_mapping_host::metrics::{read_relations, score_relations};

mod published;

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
            "still" => config.align.still = (v, 0.3 * v),
            "solve" => config.align.solver.share_least = v,
            "band" => config.align.solver.band = v as usize,
            "points" => config.loops.searched_points = v as usize,
            "searched" => config.loops.searched_share = v as f32,
            "poses" => config.poses_a_scan = v as usize,
            "partners" => config.locate.partners = v as usize,
            "step" => config.locate.step_least = v,
            "stride" => {
                config.align.rounds.iter_mut().for_each(|round| round.stride = v as usize);
            }
            "locate_stride" => config.locate.rounds[0].stride = v as usize,
            "ratio" => config.loops.loss_ratio = v as f32,
            "score" => config.loops.score_least = v as f32,
            "stretch" => config.loops.stretch_m = v,
            _ => panic!("{name}"),
        }
    }
    config
}

/// The log as another robot might have made it: `AS=half,mirrored,…`.
fn changed(mut records: Vec<ScanRecord>) -> Vec<ScanRecord> {
    let text = std::env::var("AS").unwrap_or_default();
    for word in text.split(',').filter(|word| !word.is_empty()) {
        let (what, by) = word.split_once('=').unwrap_or((word, "0"));
        let by: f64 = by.parse().unwrap();
        match what {
            // Every so manyth scan, and every so manyth beam.
            "scans" => records = records.into_iter().step_by(by as usize).collect(),
            "beams" => records.iter_mut().for_each(|record| {
                record.ranges_m = record.ranges_m.iter().step_by(by as usize).copied().collect();
                record.step_rad *= by as f32;
            }),
            "mirrored" => records.iter_mut().for_each(|record| {
                let beams = record.ranges_m.len() as f32 - 1.0;
                record.first_angle_rad = -(record.first_angle_rad + beams * record.step_rad);
                record.ranges_m.reverse();
                record.odometry =
                    record.odometry.map(|pose| Se2::new(pose.x_m, -pose.y_m, -pose.heading_rad));
            }),
            "from" => drop(records.drain(..(by * records.len() as f64) as usize)),
            "noise" => noisy(&mut records, by as f32),
            "distance" => odometry_scaled(&mut records, by, 1.0),
            "turn" => odometry_scaled(&mut records, 1.0, by),
            "alone" => records.iter_mut().for_each(|record| record.odometry = None),
            "range" => records.iter_mut().flat_map(|record| &mut record.ranges_m).for_each(|range| {
                *range = if *range > by as f32 { f32::INFINITY } else { *range };
            }),
            _ => panic!("{what}"),
        }
    }
    records
}

/// Sums of twelve numbers of a linear congruential generator, as deviations of this size.
fn noisy(records: &mut [ScanRecord], deviation_m: f32) {
    let mut state = 7_u64;
    for range in records.iter_mut().flat_map(|record| &mut record.ranges_m) {
        let mut sum = -6.0_f32;
        for _ in 0..12 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (state >> 40) as f32 / (1_u64 << 24) as f32;
        }
        *range += deviation_m * sum;
    }
}

/// Each step of the odometry longer, and turned further.
fn odometry_scaled(records: &mut [ScanRecord], distance: f64, turn: f64) {
    let (mut before, mut pose) = (None::<Se2>, Se2::default());
    for record in records {
        let Some(odometry) = record.odometry else { continue };
        if let Some(before) = before {
            let step = before.between(odometry);
            pose = pose.compose(Se2::new(distance * step.x_m, distance * step.y_m, turn * step.heading_rad));
        }
        before = Some(odometry);
        record.odometry = Some(pose);
    }
}

/// Processor time of this thread, seconds.
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}

fn main() {
    let data = published::folder();
    let which: Vec<String> = std::env::args().skip(1).collect();
    for [name, log, key] in published::LOGS {
        if which.is_empty() || which.iter().any(|w| w == name) {
            evaluate(name, &data.join(log), &data.join(key));
        }
    }
}

/// Maps a log, and prints its errors before and after the final alignment.
fn evaluate(name: &str, log: &Path, key: &Path) {
    let mut records = published::records(log);
    // A millionth of the ranges decides nothing; a result that hangs on it is luck.
    let parts: f32 = std::env::var("PARTS_PER_MILLION").map_or(0.0, |text| text.parse().unwrap());
    records
        .iter_mut()
        .flat_map(|record| &mut record.ranges_m)
        .for_each(|range| *range *= 1.0 + parts * 1.0e-6);
    let records = changed(records);
    let relations = read_relations(&published::unpack(key)).unwrap();
    let is_changed = std::env::var("AS").unwrap_or_default();
    // Of a thinned log only relations of scans that are there count.
    let tolerance_s = if is_changed.contains("scans=") { 1.0e-3 } else { 0.6 };
    let back = |pose: Se2| match is_changed.contains("mirrored") {
        true => Se2::new(pose.x_m, -pose.y_m, -pose.heading_rad),
        false => pose,
    };
    let mut mapper = Mapper::new(settings());
    let show = |what: &str, mapper: &Mapper, since: f64| {
        let path = if what == "matched" { mapper.matched_trajectory() } else { mapper.trajectory() };
        let path: Vec<(f64, Se2)> = path.into_iter().map(|(time_s, pose)| (time_s, back(pose))).collect();
        let score = score_relations(&relations, &path, tolerance_s);
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
