//! The supermarket aisle with labels: what is floor, and who is where.

use std::collections::BTreeMap;
use std::io::Read as _;

use flate2::read::GzDecoder;
use floorguard_perception::people::{
    Association, FloorMask, PeoplePipeline, RingAngles, SweepContext, TrackStatus, TrackerParameters,
};
use floorguard_tests::data::bench_input;
use floorguard_tests::lidar_frames::{datagrams, packets, sweep_of};
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3, Twist2};
use floorguard_types::sensing::LidarPacket;
use serde_json::Value;

const PACKETS_PER_FRAME: usize = 75;
const SENSOR_HEIGHT_M: f32 = 0.9;

fn all_packets() -> Option<Vec<LidarPacket>> {
    Some(packets(&datagrams(&bench_input("lidar/synthetic_vlp16.pcap.gz")?)))
}

fn unpacked(path: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    GzDecoder::new(std::fs::File::open(bench_input(path)?).ok()?).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

fn mounting(pitch_rad: f32) -> Transform3 {
    Transform3::from_mounting(Point3::new(0.0, 0.0, SENSOR_HEIGHT_M), 0.0, pitch_rad, 0.0)
}

/// Lasers of the wire alternate: 0 is the lowest ring, 1 the lowest of the upper half (book, Velodyne: Laser angles).
fn ring_of_laser(laser: usize) -> usize {
    if laser.is_multiple_of(2) { laser / 2 } else { 8 + laser / 2 }
}

/// Floor marked right, marked wrongly, missed.
fn floor_counts(pitch_rad: f32) -> Option<[u32; 3]> {
    let packets = all_packets()?;
    let (mut mask, angles) = (Box::new(FloorMask::new()), RingAngles::vlp16());
    let mut counts = [0_u32; 3];
    for frame in [0_usize, 5, 10, 15, 19] {
        let labels = unpacked(&format!("lidar/frame_{frame:02}.label.gz"))?;
        let sweep = sweep_of(&packets[frame * PACKETS_PER_FRAME..][..PACKETS_PER_FRAME]);
        mask.find(&sweep, &angles, &mounting(pitch_rad));
        assert_eq!(labels.len(), sweep.column_count * 16, "one label a cell");
        for (index, label) in labels.iter().enumerate() {
            let (column, ring) = (index / 16, ring_of_laser(index % 16));
            if sweep.columns[column].range_raw[ring] == 0 {
                continue;
            }
            match (mask.is_floor(column, ring), *label == 0) {
                (true, true) => counts[0] += 1,
                (true, false) => counts[1] += 1,
                (false, true) => counts[2] += 1,
                (false, false) => {}
            }
        }
    }
    Some(counts)
}

#[test]
fn floor_is_distinguished_from_objects_on_it() {
    // Level, and with a mounting angle that is wrong by a degree either way.
    for pitch_deg in [0.0_f32, 1.0, -1.0] {
        let Some([right, wrong, missed]) = floor_counts(pitch_deg.to_radians()) else { return };
        let precision = f64::from(right) / f64::from(right + wrong);
        let recall = f64::from(right) / f64::from(right + missed);
        println!("pitch {pitch_deg}°: precision {precision:.4}, recall {recall:.4}");
        let (precision_min, recall_min) = if pitch_deg == 0.0 { (0.90, 0.98) } else { (0.90, 0.97) };
        assert!(
            precision >= precision_min && recall >= recall_min,
            "pitch {pitch_deg}°: {precision} {recall}"
        );
    }
}

struct Person {
    id: u64,
    position: Point2,
}

/// People of a frame with enough returns to be seen, and all people.
fn people(frame: &Value) -> (Vec<Person>, Vec<Person>) {
    let person = |value: &Value| Person {
        id: value["id"].as_u64().expect("an id"),
        position: Point2::new(value["x"].as_f64().expect("x") as f32, value["y"].as_f64().expect("y") as f32),
    };
    let rows = frame["people"].as_array().expect("people");
    let near = |row: &&Value| person(row).position.norm() < 12.0;
    let seen = |row: &&Value| row["points"].as_u64().expect("points") >= POINTS_MIN && near(row);
    (rows.iter().filter(seen).map(person).collect(), rows.iter().map(person).collect())
}

/// Fewer returns than this are no visible person: two rings of eight.
const POINTS_MIN: u64 = 16;
/// A track farther than this from a person is somebody else, metres (book, Tracking: Metrics).
const MATCH_M: f32 = 0.5;

#[derive(Debug, Default)]
struct Score {
    present: u32,
    misses: u32,
    false_tracks: u32,
    switches: u32,
    matched: u32,
    error_m: f64,
}

/// CLEAR-MOT with greedy matching by distance; last frame's pairs are kept while they hold.
fn score(association: Association) -> Option<Score> {
    let packets = all_packets()?;
    let truth: Value = serde_json::from_slice(&unpacked("lidar/truth.json.gz")?).expect("json");
    let context =
        SweepContext { sensor_in_base: mounting(0.0), twist: Twist2::ZERO, base_in_odom: Pose2::default() };
    let parameters = TrackerParameters { association, ..TrackerParameters::DEFAULT };
    let mut pipeline = Box::new(PeoplePipeline::with_tracker(RingAngles::vlp16(), parameters));
    let mut score = Score::default();
    let mut last: BTreeMap<u64, u32> = BTreeMap::new();
    for (index, frame) in truth["frames"].as_array()?.iter().enumerate() {
        let sweep = sweep_of(&packets[index * PACKETS_PER_FRAME..][..PACKETS_PER_FRAME]);
        let output = pipeline.process(&sweep, &context);
        let tracks: Vec<_> = output
            .tracks
            .iter()
            .filter(|track| track.status == TrackStatus::Confirmed && track.person_probability >= 0.5)
            .filter(|track| track.state.position.norm() < 12.0)
            .collect();
        if index < WARM_UP {
            continue;
        }
        let (seen, everybody) = people(frame);
        let mut pairs = Vec::new();
        for person in &seen {
            for track in &tracks {
                let distance_m = person.position.distance(track.state.position);
                let kept = last.get(&person.id) == Some(&track.id);
                pairs.push((!kept, distance_m, person.id, track.id));
            }
        }
        pairs.retain(|pair| pair.1 <= MATCH_M);
        pairs.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut matches: BTreeMap<u64, u32> = BTreeMap::new();
        for (_, distance_m, person, track) in pairs {
            if !matches.contains_key(&person) && !matches.values().any(|other| *other == track) {
                matches.insert(person, track);
                score.error_m += f64::from(distance_m);
                score.switches += u32::from(last.get(&person).is_some_and(|before| *before != track));
            }
        }
        score.present += seen.len() as u32;
        score.misses += (seen.len() - matches.len()) as u32;
        score.matched += matches.len() as u32;
        // A track of a person who is hidden or hardly seen is no false one.
        score.false_tracks += tracks
            .iter()
            .filter(|track| !matches.values().any(|matched| *matched == track.id))
            .filter(|track| !everybody.iter().any(|p| p.position.distance(track.state.position) <= MATCH_M))
            .count() as u32;
        last.extend(matches);
    }
    Some(score)
}

/// Sweeps after which a person must have been confirmed as one: 1 s.
const WARM_UP: usize = 10;

#[test]
fn people_in_an_aisle_are_followed() {
    for association in [Association::Nearest, Association::Joint] {
        let Some(score) = score(association) else { return };
        let errors = score.misses + score.false_tracks + score.switches;
        let mota = 1.0 - f64::from(errors) / f64::from(score.present);
        let error_m = score.error_m / f64::from(score.matched);
        println!("{association:?}: MOTA {mota:.3}, mean error {error_m:.3} m, {score:?}");
        assert!(mota >= 0.85 && score.switches <= 1 && error_m < 0.15, "{association:?}: MOTA {mota}");
    }
}

#[test]
fn every_stage_has_a_time() {
    for measured in floorguard_tests::bench::run() {
        println!("{measured:?}");
        for stage in ["decode", "sweep", "floor", "clusters", "motion", "people", "track", "guard"] {
            let time = measured.stages.iter().find(|time| time.stage == stage).expect("every stage");
            // Some are what two measurements differ by: on a busy computer that may be nothing.
            assert!(time.ns_per_sweep >= 0.0 && time.ns_per_point.is_finite(), "{time:?}");
        }
        let whole = measured.stages.iter().find(|time| time.stage == "datagrams to tracks");
        assert!(whole.is_some_and(|time| time.ns_per_sweep > 0.0), "{whole:?}");
        assert!(measured.decisions.is_in_time(), "{:?}", measured.decisions);
    }
}
