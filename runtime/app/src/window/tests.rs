//! Both wires end to end: the simulated rig writes the bytes, the drivers read them. What the window then holds is judged by plane
//! geometry of the room; recordings by their key.

use clap::Parser;
use floorguard_mapping::sliding_window::{Face, WindowPoint};

use super::WindowArguments;
use super::simulated::{Simulated, play};
use floorguard_robot::actuated::WindowMap;

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    arguments: WindowArguments,
}

fn arguments(words: &[&str]) -> WindowArguments {
    Line::parse_from([&["window"], words].concat()).arguments
}

fn played(room: &str, seconds: &str, more: &[&str]) -> Simulated {
    let words = [&["--scenario", room, "--seconds", seconds, "--out", "x"], more].concat();
    play(&arguments(&words), room).unwrap()
}

fn refused(map: &WindowMap, kind: &str) -> u64 {
    map.taken.refused.get(kind).map_or(0, |one| one.count)
}

/// Surfaces of the room: walls 2.45 m (and 3.45 m ahead) from its middle, floor, ceiling open, the box 1.0 m ahead.
fn distance_m(one: &WindowPoint) -> f32 {
    let point = one.point;
    let walls = [3.45 - point.x_m, point.x_m + 2.45, 2.45 - point.y_m, point.y_m + 2.45];
    let wall = walls.iter().map(|one| one.abs()).fold(f32::INFINITY, f32::min);
    let low = [1.0 - point.x_m, -0.2 - point.y_m, 0.1 - point.z_m];
    let high = [point.x_m - 1.4, point.y_m - 0.2, point.z_m - 0.5];
    let outside: f32 = low.iter().zip(high).map(|(low, high)| low.max(high).max(0.0).powi(2)).sum();
    wall.min(outside.sqrt()).min(point.z_m.abs())
}

#[test]
fn the_published_box_is_where_it_stands() {
    for lidar in ["urg", "ust"] {
        let Simulated { map, session, .. } = played("box", "21", &["--lidar", lidar]);
        assert!(session.faults.is_empty(), "{:?}", session.faults);
        assert!(session.clock_uncertainty_us().unwrap() <= 2_500);
        let points: Vec<WindowPoint> = map.window.points().collect();
        let far = points.iter().filter(|one| distance_m(one) > 0.12).count();
        assert!(points.len() > 2_500 && far * 100 < points.len(), "{lidar}: {far} of {}", points.len());
        let face = points.iter().filter(|one| {
            one.face == Face::Front && one.point.y_m.abs() < 0.18 && (0.15..0.45).contains(&one.point.z_m)
        });
        let ahead: Vec<f32> = face.map(|one| one.point.x_m).collect();
        let mean = ahead.iter().sum::<f32>() / ahead.len() as f32;
        assert!(
            ahead.len() > 20 && (mean - 1.0).abs() < 0.011,
            "{lidar}: {mean} m from {} cells",
            ahead.len()
        );
        let scans = if lidar == "urg" { 195..=215 } else { 780..=860 };
        assert!(
            scans.contains(&map.taken.scans),
            "{lidar}: {} scans, {:?}",
            map.taken.scans,
            map.taken.refused
        );
    }
}

#[test]
fn the_robot_may_turn_and_drive() {
    let Simulated { map, .. } = played("drive", "25", &[]);
    let frame = map.window.frame_in_odometry();
    assert!(frame.x_m > 0.6 && frame.heading_rad > 0.4, "{frame:?}");
    let walls = map.window.points().filter(|one| one.point.z_m > 1.9).map(|one| {
        let (sin, cos) = libm::sincosf(frame.heading_rad);
        let x = frame.x_m + cos * one.point.x_m - sin * one.point.y_m;
        let y = frame.y_m + sin * one.point.x_m + cos * one.point.y_m;
        [3.45 - x, x + 2.45, 2.45 - y, y + 2.45].iter().map(|one| one.abs()).fold(f32::INFINITY, f32::min)
    });
    let walls: Vec<f32> = walls.collect();
    let far = walls.iter().filter(|one| **one > 0.15).count();
    assert!(walls.len() > 200 && far * 50 < walls.len(), "{far} of {}", walls.len());
}

#[test]
fn a_person_who_walks_is_no_surface() {
    let Simulated { map, .. } = played("person", "16", &[]);
    assert!(map.taken.people > 200, "{} points on people", map.taken.people);
    let walks = map.arrows();
    let right = walks.iter().filter(|one| (-0.45..0.0).contains(&one.velocity_y_mps)).count();
    assert!(walks.len() >= 3 && right * 10 >= walks.len() * 7, "{right} of {}: {walks:?}", walks.len());
}

#[test]
fn a_stalled_motor_ends_the_scans() {
    let Simulated { map, session, .. } = played("box", "20", &["--fault", "motor-stalled"]);
    // Stalled at 10 s; a third of a second later no scan enters any more.
    assert!(map.now.as_micros() < 10_500_000, "{:?}", map.now);
    assert!(refused(&map, "motor_stalled") > 80, "{:?} {:?}", map.taken.refused, session.faults);
}

#[test]
fn scans_far_from_an_angle_are_refused() {
    let Simulated { map, .. } = played("box", "15", &["--fault", "angles-lost"]);
    assert_eq!(
        map.taken.scans, 0,
        "angles are 60 ms apart: each scan of 50 ms has a beam that none belongs to"
    );
    assert!(refused(&map, "angle_missing") > 100 && map.window.points().count() == 0);
}

#[test]
fn damaged_scans_enter_nowhere() {
    let whole = played("box", "15", &[]).map;
    let Simulated { map, .. } = played("box", "15", &["--fault", "damaged-check"]);
    let damaged = refused(&map, "damaged");
    assert!((40..=60).contains(&damaged), "{damaged}");
    assert_eq!(map.taken.scans + damaged, whole.taken.scans);
}

/// The two recordings of a tilted lidar become maps; counts and sums are those of their key.
#[test]
fn recordings_become_maps() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/actuated_lidar");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return;
    }
    let key = [
        ("turboslam_subset", 276, 87_348_u64, 227_171.52),
        ("turboslam_lidar_servoAngle_imu_3hz_8hz_8hz", 204, 56_552, 157_597.29),
    ];
    for (name, scans, ranges, sum_m) in key {
        let file = |kind: &str| folder.join(format!("{name}.{kind}.csv.gz")).display().to_string();
        let (scan, servo) = (file("scan"), file("servo_deg"));
        let out = tempfile::tempdir().unwrap();
        let place = out.path().join("map");
        let words = [scan.as_str(), "--servo", &servo, "--out", place.to_str().unwrap()];
        let arguments = arguments(&words);
        let outcome = super::run(&arguments);
        // Angles are missing where none was sent for a while: more than a fifth, and the command says so.
        let words = outcome.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(words.is_empty() || words.contains("no angle of the servo"), "{name}: {words}");
        let summary: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(place.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["recorded_scans"], scans, "{name}");
        // The key counted before ranges were rounded to text: one of 10.00 m may be within or not.
        assert!(summary["recorded_ranges"].as_u64().unwrap().abs_diff(ranges) <= 1, "{name}: {summary}");
        assert!((summary["recorded_sum_m"].as_f64().unwrap() - sum_m).abs() < 11.0, "{name}: {summary}");
        assert_eq!((&summary["grid_columns"], &summary["grid_rows"]), (&124.into(), &48.into()));
        assert_eq!((&summary["map_columns"], &summary["map_rows"]), (&100.into(), &100.into()));
        assert!(summary["free_m2"].as_f64().unwrap() > 0.0 && summary["occupied_m2"].as_f64().unwrap() > 1.0);
        let picture = std::fs::read(place.join("map.pgm")).unwrap();
        assert!(picture.starts_with(b"P5\n100 100\n255\n") && picture.len() == 15 + 10_000);
        let window = image::open(place.join("window.png")).unwrap();
        assert_eq!((window.width(), window.height()), (3 * 124 * 4 + 16, 48 * 4));
        assert!(std::fs::read_to_string(place.join("index.html")).unwrap().contains("floor.png"));
    }
}
