//! People by a camera's boxes in a recorded hall: the boxes are drawn from an independent key, by a pinhole of this file.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use floorguard_app::cameras::{CalibrateArguments, CalibrateWhat, CameraLidarArguments, calibrate};
use floorguard_app::mapping_commands::{BoxMethod, CleanArguments, clean_map};
use floorguard_tests::data::recording;

const FOLDER: &str = "vlp16_clouds/fabu_hall_people_A_reencoded";
/// Pictures of the imagined camera.
const SIZE: [f64; 2] = [800.0, 600.0];
const FOCAL_PX: f64 = 400.0;
/// It looks 45° to the right, 0.1 m beside the lidar.
const RIGHT_RAD: f64 = std::f64::consts::FRAC_PI_4;
const CAMERA_IN_LIDAR: [f64; 3] = [0.0, 0.1, 0.05];
/// Duration of a sweep of 76 packets, seconds.
const SWEEP_S: f64 = 76.0 * 1.327_104e-3;

/// Column, row and depth.
fn project(point: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = [0, 1, 2].map(|axis: usize| point[axis] - CAMERA_IN_LIDAR[axis]);
    let (sin, cos) = RIGHT_RAD.sin_cos();
    let (ahead, right) = (cos * x - sin * y, -sin * x - cos * y);
    [0.5 * SIZE[0] + FOCAL_PX * right / ahead, 0.5 * SIZE[1] - FOCAL_PX * z / ahead, ahead]
}

fn rows(name: &str) -> Option<Vec<Vec<f64>>> {
    let text = std::fs::read_to_string(recording(&format!("{FOLDER}.{name}.csv"))?).expect("a key is text");
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    Some(text.lines().skip(1).map(row).collect())
}

/// A walking person of the key: the sweep and the box in the lidar's frame.
struct KeyPerson {
    sweep: f64,
    low: [f64; 3],
    high: [f64; 3],
}

fn key() -> Option<Vec<KeyPerson>> {
    let (clusters, frames) = (rows("fg_clusters")?, rows("frames")?);
    let tracks = rows("pseudo_tracks")?;
    let person = |row: &Vec<f64>| {
        let cluster = clusters.iter().find(|cluster| cluster[0] == row[0] && cluster[1] == row[5])?;
        let frame = frames.iter().find(|frame| frame[0] == row[0])?;
        let corner = |from: usize| [cluster[from], cluster[from + 1], cluster[from + 2]];
        Some(KeyPerson { sweep: frame[2], low: corner(6), high: corner(9) })
    };
    Some(tracks.iter().filter(|row| row[2] < 4.0).filter_map(person).collect())
}

/// The box of a person in the picture, where all of it is seen.
fn seen(person: &KeyPerson) -> Option<[f64; 4]> {
    let mut edges = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for corner in 0..8_usize {
        let side = |axis: usize| if corner >> axis & 1 == 0 { person.low[axis] } else { person.high[axis] };
        let [column, row, depth] = project([0, 1, 2].map(side));
        if depth < 0.5 {
            return None;
        }
        edges = [edges[0].min(column), edges[1].min(row), edges[2].max(column), edges[3].max(row)];
    }
    let is_inside = edges[0] > 0.0 && edges[1] > 0.0 && edges[2] < SIZE[0] && edges[3] < SIZE[1];
    is_inside.then_some(edges)
}

fn boxes_csv(people: &[KeyPerson]) -> String {
    let mut text = String::from("time_s,left,top,right,bottom,score,class\n");
    for person in people {
        if let Some([left, top, right, bottom]) = seen(person) {
            let time_s = (person.sweep + 0.5) * SWEEP_S;
            writeln!(text, "{time_s:.4},{left:.1},{top:.1},{right:.1},{bottom:.1},0.9,person").expect("text");
        }
    }
    text
}

/// Calibrates the imagined camera by points that this file's pinhole projects; answers the file.
fn calibrated(folder: &Path) -> PathBuf {
    let mut pairs = String::new();
    for point in [
        [3.0, -1.0, 0.3],
        [2.0, -2.5, -0.4],
        [4.0, -4.0, 0.9],
        [5.0, -2.0, -0.6],
        [1.5, -1.0, 0.2],
        [3.0, -3.5, 0.1],
    ] {
        let [column, row, _] = project(point);
        writeln!(pairs, "{},{},{},{column:.2},{row:.2}", point[0], point[1], point[2]).expect("text");
    }
    let (pairs_path, camera, out) =
        (folder.join("pairs.csv"), folder.join("camera.json"), folder.join("mounted.json"));
    std::fs::write(&pairs_path, pairs).expect("written");
    std::fs::write(&camera, r#"{"width":800,"height":600,"focal_px":[400,400],"centre_px":[400,300]}"#)
        .expect("written");
    let what =
        CameraLidarArguments { pairs: pairs_path, camera, out: out.clone(), photograph: None, json: false };
    calibrate(&CalibrateArguments { what: CalibrateWhat::CameraLidar(what) }).expect("the pairs fit");
    assert!(folder.join("mounted.svg").is_file());
    out
}

fn arguments(folder: &Path, capture: &Path) -> CleanArguments {
    CleanArguments {
        files: vec![capture.to_owned()],
        out: folder.join("clean"),
        boxes: Some(folder.join("boxes.csv")),
        camera: Some(folder.join("mounted.json")),
        cube_m: 0.05,
        ..CleanArguments::default()
    }
}

/// Places of `people.csv`, and how many of them lie farther than 0.3 m from every person of the key.
fn places(folder: &Path, people: &[KeyPerson]) -> (usize, usize) {
    let text = std::fs::read_to_string(folder.join("clean/people.csv")).expect("people were found");
    let places: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    let is_on = |place: &Vec<f64>, person: &KeyPerson| {
        (0..2).all(|axis| (person.low[axis] - 0.3..=person.high[axis] + 0.3).contains(&place[axis]))
    };
    let stray = places.iter().filter(|place| !people.iter().any(|person| is_on(place, person))).count();
    (places.len(), stray)
}

#[test]
fn boxes_become_places_of_the_key() {
    let capture = recording(&format!("{FOLDER}.pcap.gz"));
    let (Some(capture), Some(people)) = (capture, key()) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    calibrated(folder);
    let boxes = boxes_csv(&people);
    assert!(boxes.lines().count() > 100, "{} lines", boxes.lines().count());
    std::fs::write(folder.join("boxes.csv"), &boxes).expect("written");
    clean_map(&arguments(folder, &capture)).expect("the hall is cleaned");
    let (depth, stray) = places(folder, &people);
    println!("{depth} places, {stray} of them not on a person");
    assert!(depth >= 5 && stray * 20 <= depth, "{stray} of {depth} places lie beside everyone");
    let published = CleanArguments { box_method: BoxMethod::Nearest, ..arguments(folder, &capture) };
    clean_map(&published).expect("the hall is cleaned");
    let (nearest, stray_nearest) = places(folder, &people);
    println!("as published: {nearest} places, {stray_nearest} of them not on a person");
    assert!(stray_nearest >= stray, "the published rule is the better one: {stray_nearest} {stray}");
}

#[test]
fn boxes_that_do_not_fit_are_refused() {
    let Some(capture) = recording(&format!("{FOLDER}.pcap.gz")) else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let mounted = calibrated(folder);
    let why = |boxes: &str, camera: &str| {
        std::fs::write(folder.join("boxes.csv"), boxes).expect("written");
        std::fs::write(folder.join("other.json"), camera).expect("written");
        let camera = Some(folder.join("other.json"));
        let refused = clean_map(&CleanArguments { camera, ..arguments(folder, &capture) });
        assert!(!folder.join("clean/clean.ply").exists());
        refused.expect_err("refused").to_string()
    };
    let good = std::fs::read_to_string(&mounted).expect("written");
    let one = "1.0,100,100,200,300\n";
    assert!(why("2.0,100,100,200,300\n1.0,100,100,200,300\n", &good).contains("out of order"));
    assert!(why("1.0,900,100,1200,300\n", &good).contains("another size"));
    let sized = r#"{"width":640,"images":[{"time_s":1,"height":480,"boxes":[]}]}"#;
    assert!(why(sized, &good).contains("640×480"));
    assert!(why("900.0,100,100,200,300\n", &good).contains("clocks"));
    let mirrored = r#"{"width":800,"height":600,"focal_px":[400,400],"centre_px":[400,300],
        "camera_from_lidar":[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}"#;
    assert!(why(one, mirrored).contains("no rotation"));
    let without = r#"{"width":800,"height":600,"focal_px":[400,400],"centre_px":[400,300]}"#;
    assert!(why(one, without).contains("calibrate camera-lidar"));
    assert!(why("1.0,100\n", &good).contains("line 1"));
}
