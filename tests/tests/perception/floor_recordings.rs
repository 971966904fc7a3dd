//! Floors of recorded depth pictures against keys that were fitted elsewhere.

use std::io::Read as _;

use floorguard_laboratory::evaluate::{FloorReport, FloorTask, floor};
use floorguard_perception::floor::{Expectation, Plane, floor_of_points};
use floorguard_tests::data::{bench_input, recording};

/// Intrinsics under which the keys were made.
const KINECT: [f32; 4] = [525.0, 525.0, 319.5, 239.5];
/// What the issue allows.
const ANGLE_MAX_DEGREES: f64 = 0.3;
const DISTANCE_MAX_M: f64 = 0.01;
const IOU_MIN: f64 = 0.95;

fn compare(name: &str, report: &FloorReport, (normal, distance_m): ([f64; 3], f64)) {
    let length = normal.iter().map(|value| value * value).sum::<f64>().sqrt();
    let cosine: f64 = report.normal.iter().zip(normal).map(|(a, b)| f64::from(*a) * b / length).sum();
    let (angle, error) =
        (cosine.min(1.0).acos().to_degrees(), (f64::from(report.distance_m) - distance_m).abs());
    println!("{name}: {angle:.3}°, {:.1} mm, overlap {:?}", 1_000.0 * error, report.floor_iou);
    assert!(angle <= ANGLE_MAX_DEGREES, "{name}: normal off by {angle}°");
    assert!(error <= DISTANCE_MAX_M, "{name}: distance off by {error} m");
}

#[test]
fn real_floors_lie_where_the_keys_say() {
    let Some(key) = recording("rgbd_floor/key.csv") else { return };
    let key = std::fs::read_to_string(key).expect("the key is text");
    let mut compared = 0;
    for line in key.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |index: usize| cells[index].parse::<f64>().expect("a number");
        let name = cells[0];
        let (Some(depth), Some(truth)) = (
            recording(&format!("rgbd_floor/{name}_depth_mm.png")),
            recording(&format!("rgbd_floor/{name}_floor_mask.png")),
        ) else {
            return;
        };
        let task = FloorTask { depth, intrinsics: KINECT, truth: Some(truth), mounting: None, out: None };
        let report = floor(&task).expect("a floor");
        assert_eq!(report.returns, number(1) as u64, "{name}: pixels with a depth");
        compare(name, &report, ([number(2), number(3), number(4)], number(5)));
        let overlap = report.floor_iou.expect("a mask was given");
        assert!(overlap >= IOU_MIN, "{name}: overlap {overlap}");
        compared += 1;
    }
    assert!(compared >= 2, "only {compared} frames");
}

#[test]
fn synthetic_floors_lie_where_they_were_put() {
    let Some(truth) = bench_input("depth/truth.json") else { return };
    let text = std::fs::read_to_string(truth).expect("the truth is text");
    let truth: serde_json::Value = serde_json::from_str(&text).expect("the truth is JSON");
    let mut compared = 0;
    for frame in truth["frames"].as_array().expect("frames") {
        let name = format!("depth/depth_{}.png", frame["k"]);
        let Some(depth) = bench_input(&name).filter(|path| path.exists()) else { continue };
        let task = FloorTask { depth, intrinsics: KINECT, truth: None, mounting: None, out: None };
        let report = floor(&task).expect("a floor");
        // That file's normals point down.
        let component = |index: usize| -frame["normal"][index].as_f64().expect("a number");
        let normal = [component(0), component(1), component(2)];
        compare(&name, &report, (normal, frame["h"].as_f64().expect("a number")));
        compared += 1;
    }
    assert!(compared > 0, "no frame");
}

/// Points of a cloud that stands in a file as text, metres.
fn cloud(name: &str) -> Option<Vec<[f32; 3]>> {
    let path = recording(name)?;
    let mut text = String::new();
    let file = std::fs::File::open(path).expect("it is there");
    flate2::read::GzDecoder::new(file).read_to_string(&mut text).expect("it is text");
    let (_, rows) = text.split_once("DATA ascii\n").expect("a cloud as text");
    let point = |row: &str| {
        let mut cells = row.split(' ').map(|cell| cell.parse::<f32>().expect("a number"));
        core::array::from_fn(|_| cells.next().expect("three places"))
    };
    Some(rows.lines().map(point).collect())
}

/// The floor that counts as such in the key: nearer to its plane than 4 cm.
const ON_FLOOR_M: f32 = 0.04;

/// A lidar that is mounted askew, people and a tripod in the room: the key's planes, and the same points in them.
#[test]
fn lidar_floors_match_the_keys() {
    const FOLDER: &str = "vlp16_clouds/acfr_lab";
    let Some(key) = recording(&format!("{FOLDER}/key.csv")) else { return };
    let key = std::fs::read_to_string(key).expect("the key is text");
    let column = |name: &str| key.lines().next().expect("a head").split(',').position(|cell| cell == name);
    let mut compared = 0;
    for line in key.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |name: &str| cells[column(name).expect("a column")].parse::<f32>().expect("a number");
        let Some(points) = cloud(&format!("{FOLDER}/{}_full.pcd.gz", cells[0])) else { return };
        let truth =
            Plane::new([number("floor_nx"), number("floor_ny"), number("floor_nz")], number("floor_d"))
                .expect("a plane");
        // What the mounting says: about 1.6 m above the floor, within 10° of level.
        let expectation = Expectation {
            mounted: Plane::new([0.0, 0.0, 1.0], 1.6).expect("a plane"),
            tilt_max_rad: 0.174_533,
            distance_range_m: [1.4, 1.8],
        };
        let found = floor_of_points(points.iter().copied(), &expectation, 7).expect("a floor");
        let angle = f64::from(found.tilt_from_rad(&truth)).to_degrees();
        let error_m = (found.distance_m - truth.distance_m).abs();
        let on = |plane: &Plane, point: &[f32; 3]| plane.height_m(*point).abs() < ON_FLOOR_M;
        let both = points.iter().filter(|point| on(&found, point) && on(&truth, point)).count();
        let either = points.iter().filter(|point| on(&found, point) || on(&truth, point)).count();
        let overlap = both as f64 / either as f64;
        println!("{}: {angle:.3}°, {:.1} mm, overlap {overlap:.3}", cells[0], 1_000.0 * error_m);
        assert!(angle <= ANGLE_MAX_DEGREES, "{}: normal off by {angle}°", cells[0]);
        assert!(f64::from(error_m) <= DISTANCE_MAX_M, "{}: distance off by {error_m} m", cells[0]);
        assert!(overlap >= IOU_MIN, "{}: overlap {overlap}", cells[0]);
        compared += 1;
    }
    assert!(compared >= 5, "only {compared} clouds");
}
