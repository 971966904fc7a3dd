//! Localises published logs in maps that others made of them: four starts in each log, two minutes from there.
//!
//! `cargo run --release -p floorguard-mapping-host --example localise_logs -- FOLDER`, with the folder of the two-dimensional logs. With
//! `carried` after it, each drive goes on at the next start; with `others`, three logs are localised in the maps of the other buildings.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use floorguard_mapping::Occupancy;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::grid_map::GridMap;
use floorguard_mapping_host::input::ScanRecord;
use floorguard_mapping_host::localise::{Belief, KnownMap, LocaliseConfig, Localiser};

/// A log, the log of others that corrects it, and their map of it.
const LOGS: [(&str, &str); 5] = [
    ("radish_aces.clf.bz2", "corrected_aces"),
    ("radish_intel.clf.bz2", "corrected_intel"),
    ("fr101.rebuilt_odometry.scans.gz", "corrected_freiburg-101"),
    ("edmonton.rebuilt_odometry.scans.gz", "corrected_edmonton"),
    ("fhw.rebuilt_odometry.scans.gz", "corrected_fhw"),
];
/// Starts in a log, and how long each is followed, seconds.
const STARTS: usize = 4;
const FOLLOWED_S: f64 = 120.0;
/// Half the share of a picture's grey scale above which a cell is occupied, and below which it is free: the values of the maps' files.
const OCCUPIED: f64 = 0.65;
const FREE: f64 = 0.196;

fn text(path: &Path) -> String {
    let file = std::fs::File::open(path).unwrap();
    let mut text = String::new();
    if path.extension().is_some_and(|extension| extension == "bz2") {
        bzip2::read::MultiBzDecoder::new(file).read_to_string(&mut text).unwrap();
    } else {
        flate2::read::MultiGzDecoder::new(file).read_to_string(&mut text).unwrap();
    }
    text
}

/// Scans of a CARMEN log with the pose beside each of them.
fn carmen(text: &str) -> Vec<ScanRecord> {
    let scan = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let beams: usize = words[1].parse().unwrap();
        let number = |index: usize| words[2 + beams + index].parse::<f64>().unwrap();
        ScanRecord {
            time_s: number(6),
            odometry: Some(Se2::new(number(0), number(1), number(2))),
            first_angle_rad: -std::f32::consts::FRAC_PI_2,
            step_rad: std::f32::consts::PI / beams as f32,
            ranges_m: words[2..2 + beams].iter().map(|word| word.parse().unwrap()).collect(),
            ..ScanRecord::default()
        }
    };
    text.lines().filter(|line| line.starts_with("FLASER")).map(scan).collect()
}

/// Scans of a log whose odometry was rebuilt: number, pose, beams, first angle, step, ranges.
fn rebuilt(text: &str) -> Vec<ScanRecord> {
    let scan = |line: &str| {
        let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        ScanRecord {
            time_s: numbers[0],
            odometry: Some(Se2::new(numbers[1], numbers[2], numbers[3])),
            first_angle_rad: numbers[5] as f32,
            step_rad: numbers[6] as f32,
            ranges_m: numbers[7..].iter().map(|range| *range as f32).collect(),
            ..ScanRecord::default()
        }
    };
    text.lines().map(scan).collect()
}

/// A map of ROS whose lower left corner stands in the file beside the picture.
fn map(folder: &Path, name: &str) -> GridMap {
    let yaml = std::fs::read_to_string(folder.join(format!("keys/{name}.map.yaml"))).unwrap();
    let value = |key: &str| yaml.lines().find_map(|line| line.strip_prefix(key)).unwrap().trim().to_owned();
    let origin = value("origin:").trim_matches(['[', ']']).to_owned();
    let corner: Vec<f64> = origin.split(',').map(|word| word.trim().parse().unwrap()).collect();
    let picture = image::open(folder.join(format!("keys/{name}.map.png"))).unwrap().to_luma8();
    let (columns, rows) = (picture.width() as usize, picture.height() as usize);
    let state = |index: usize| {
        let (column, row) = (index % columns, rows - 1 - index / columns);
        let darkness = 1.0 - f64::from(picture.get_pixel(column as u32, row as u32).0[0]) / 255.0;
        match darkness {
            darkness if darkness > OCCUPIED => Occupancy::Occupied,
            darkness if darkness < FREE => Occupancy::Free,
            _ => Occupancy::Unknown,
        }
    };
    let cells = (0..columns * rows).map(state).collect();
    let cell_m = value("resolution:").parse().unwrap();
    GridMap { columns, rows, cell_m, corner_m: [corner[0], corner[1]], cells }
}

/// The first ranges of a scan in centimetres, by which it is recognised in the corrected log.
fn key(record: &ScanRecord) -> Vec<i32> {
    record.ranges_m.iter().take(90).map(|range_m| (100.0 * range_m).round() as i32).collect()
}

/// When a drive was first found, in doubt and given up, and how far the found places lie from the corrected ones.
#[derive(Default)]
struct Course {
    found_s: Option<f64>,
    doubt_s: Option<f64>,
    given_up_s: Option<f64>,
    off_m: Vec<f64>,
}

/// Localises scans; times count from the first of them on.
fn course(
    localiser: &mut Localiser,
    records: &[ScanRecord],
    poses: &HashMap<Vec<i32>, Option<Se2>>,
) -> Course {
    let mut course = Course::default();
    for record in records {
        let since_s = Some(record.time_s - records[0].time_s);
        let answer = localiser.push(record);
        match answer.belief {
            Belief::Unknown => course.given_up_s = course.given_up_s.or(since_s),
            Belief::Doubt => course.doubt_s = course.doubt_s.or(since_s),
            Belief::Found if course.given_up_s.is_some() => course.found_s = course.found_s.or(since_s),
            Belief::Found => {}
        }
        if let (Belief::Found, Some(pose)) = (answer.belief, answer.pose) {
            let truth = poses.get(&key(record)).copied().flatten();
            course.off_m.extend(truth.map(|truth| truth.distance(pose)));
        }
    }
    course.off_m.sort_by(f64::total_cmp);
    course
}

/// The scans of the two minutes from a start on.
fn from_start(records: &[ScanRecord], start: usize) -> &[ScanRecord] {
    let records = &records[start * records.len() / STARTS..];
    let until_s = records[0].time_s + FOLLOWED_S;
    &records[..records.iter().take_while(|record| record.time_s <= until_s).count()]
}

/// A drive goes on elsewhere, as if the robot had been carried there: nothing tells the wheels.
fn carried(localiser: &mut Localiser, before: &[ScanRecord], after: &[ScanRecord], name: &str) {
    before.iter().for_each(|record| _ = localiser.push(record));
    let Some((last, first)) = before.last().zip(after.first()) else { return };
    let Some((here, there)) = last.odometry.zip(first.odometry) else { return };
    let later_s = last.time_s + 0.2 - first.time_s;
    let moved = |record: &ScanRecord| ScanRecord {
        time_s: record.time_s + later_s,
        odometry: record.odometry.map(|pose| here.compose(there.between(pose))),
        ..record.clone()
    };
    let after: Vec<ScanRecord> = after.iter().map(moved).collect();
    let Course { found_s, doubt_s, given_up_s, .. } = course(localiser, &after, &HashMap::new());
    println!(
        "{name} carried: doubt after {doubt_s:.1?} s, given up {given_up_s:.1?} s, found {found_s:.1?} s"
    );
}

/// Scans of a log.
fn scans(folder: &Path, file: &str) -> Vec<ScanRecord> {
    let text = text(&folder.join(file));
    if file.ends_with("bz2") { carmen(&text) } else { rebuilt(&text) }
}

/// Nothing is known yet in the map of a log.
fn localiser(folder: &Path, name: &str) -> Localiser {
    let config = LocaliseConfig::default();
    Localiser::new(KnownMap::new(map(folder, name), &config).expect("a map with walls"), config)
}

/// Four starts in each log, in its own map.
fn own_maps(folder: &Path) {
    for (file, name) in LOGS {
        let records = scans(folder, file);
        let corrected = carmen(&text(&folder.join(format!("{name}.log.gz"))));
        let poses: HashMap<_, _> = corrected.iter().map(|record| (key(record), record.odometry)).collect();
        for start in 0..STARTS {
            let mut localiser = localiser(folder, name);
            let Course { found_s, off_m, .. } = course(&mut localiser, from_start(&records, start), &poses);
            let (middle_m, worst_m) = (off_m.get(off_m.len() / 2), off_m.last());
            let scans = off_m.len();
            println!("{file} start {start}: found after {found_s:.1?} s; {:?}", localiser.statistics);
            println!("  off {middle_m:.2?} m in the median of {scans} scans, {worst_m:.2?} m at worst");
        }
    }
}

/// Each drive goes on at the next start of its log.
fn carried_drives(folder: &Path) {
    for (file, name) in LOGS {
        let records = scans(folder, file);
        for start in 1..STARTS {
            let (before, after) = (from_start(&records, start - 1), from_start(&records, start));
            carried(&mut localiser(folder, name), before, after, file);
        }
    }
}

/// Logs in the maps of the other buildings, where no place is right.
fn other_maps(folder: &Path) {
    for (file, own) in &LOGS[2..] {
        let records = scans(folder, file);
        for (_, name) in LOGS.iter().filter(|(_, name)| name != own) {
            let mut localiser = localiser(folder, name);
            let found_s = course(&mut localiser, from_start(&records, 0), &HashMap::new()).found_s;
            println!("{file} in {name}: found after {found_s:.1?} s; {:?}", localiser.statistics);
        }
    }
}

fn main() {
    let folder = std::env::args().nth(1).expect("the folder of the logs");
    let folder = Path::new(&folder);
    match std::env::args().nth(2).as_deref() {
        Some("carried") => carried_drives(folder),
        Some("others") => other_maps(folder),
        _ => own_maps(folder),
    }
}
