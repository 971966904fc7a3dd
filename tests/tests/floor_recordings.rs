//! Floors of recorded depth pictures against keys that were fitted elsewhere.

use floorguard_hosted::evaluate::{FloorReport, FloorTask, floor};
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
