//! `floorguard map3d --colour camera`: pictures of a room, each pixel followed to its wall, give the cloud the walls' colours.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};

use super::space_room::{room_range_m, space_bag};

const SIZE: [u32; 2] = [160, 120];
const FOCAL_PX: f64 = 90.0;
/// The lidar's first pose in the map is at the end of the first sweep: here in the room.
const FIRST_M: [f64; 3] = [-1.5, 0.0, 0.8];

fn map3d(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .arg("map3d")
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Of the wall, floor or ceiling on which a place of the room lies, from −4, −3 to 5, 4 and 2.6 m high; `None` near a corner.
fn colour(place_m: [f64; 3]) -> Option<[u8; 3]> {
    let planes = [
        (0, -4.0, [40, 40, 0]),
        (0, 5.0, [200, 0, 0]),
        (1, -3.0, [0, 200, 0]),
        (1, 4.0, [0, 0, 200]),
        (2, 0.0, [200, 200, 0]),
        (2, 2.6, [0, 200, 200]),
    ];
    let near: Vec<_> = planes.iter().filter(|(axis, at, _)| (place_m[*axis] - at).abs() < 0.1).collect();
    (near.len() == 1).then(|| near[0].2)
}

/// A camera that looks along x from 0.1 m over the lidar, and a picture every 0.2 s of the drive.
fn pictures(folder: &Path) {
    let below_m = 0.1;
    for number in 0..20 {
        let at_s = 0.05 + 0.2 * f64::from(number);
        let from = [-1.5 + 0.4 * (at_s - 1.0).max(0.0), 0.0, 0.8 + below_m];
        let picture = image::RgbImage::from_fn(SIZE[0], SIZE[1], |column, row| {
            let across = (f64::from(column) - 79.5) / FOCAL_PX;
            let down = (f64::from(row) - 59.5) / FOCAL_PX;
            let length = (1.0 + across * across + down * down).sqrt();
            let along = [1.0, -across, -down].map(|part| part / length);
            let range_m = room_range_m(from, along);
            image::Rgb(colour([0, 1, 2].map(|axis| from[axis] + along[axis] * range_m)).unwrap_or_default())
        });
        picture.save(folder.join(format!("front_{:.6}.png", 1.7e9 + at_s))).expect("written");
    }
}

fn camera_file(path: &Path, camera_from_lidar: &Value) {
    let file = json!({
        "width": SIZE[0], "height": SIZE[1], "focal_px": [FOCAL_PX, FOCAL_PX], "centre_px": [79.5, 59.5],
        "camera_from_lidar": camera_from_lidar,
    });
    std::fs::write(path, file.to_string()).expect("written");
}

/// Places in the room and colours of a cloud.
fn points(ply: &[u8]) -> Vec<([f64; 3], [u8; 3])> {
    let end = ply.windows(11).position(|window| window == b"end_header\n").expect("a header") + 11;
    let point = |row: &[u8]| {
        let value = |at: usize| f64::from(f32::from_le_bytes(row[at..at + 4].try_into().expect("4 octets")));
        ([0, 1, 2].map(|axis| value(4 * axis) + FIRST_M[axis]), [row[12], row[13], row[14]])
    };
    ply[end..].chunks_exact(23).map(point).collect()
}

#[test]
fn cloud_has_the_colours_of_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("readable").to_owned();
    let (bag, out, camera, taken) = (path("room.mcap"), path("map"), path("camera.json"), path("pictures"));
    space_bag(Path::new(&bag), 40);
    std::fs::create_dir(&taken).expect("a folder");
    pictures(Path::new(&taken));
    let mounting = json!([[0, -1, 0, 0], [0, 0, -1, 0.1], [1, 0, 0, 0], [0, 0, 0, 1]]);
    camera_file(Path::new(&camera), &mounting);
    let arguments =
        [&bag, "--out", &out, "--json", "--colour", "camera", "--camera", &camera, "--pictures", &taken];
    let output = map3d(&arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary: Value = serde_json::from_slice(&output.stdout).expect("one object");
    let counts = &summary["pictures"];
    // The first was taken before the first pose; of those at standstill one counts, of the moving ones all but those within 0.1 m.
    assert_eq!((&counts["pictures"], &counts["without_pose"]), (&json!(20), &json!(1)), "{summary}");
    assert!(counts["used"].as_u64().is_some_and(|used| (7..=9).contains(&used)), "{summary}");
    let cloud = points(&std::fs::read(format!("{out}/cloud.ply")).expect("a cloud"));
    let coloured: Vec<_> = cloud.iter().filter(|(_, rgb)| *rgb != [96; 3]).collect();
    assert_eq!(counts["points_coloured"], coloured.len(), "{summary}");
    let judged: Vec<bool> =
        coloured.iter().filter_map(|(place_m, rgb)| Some(colour(*place_m)? == *rgb)).collect();
    let right = judged.iter().filter(|is_right| **is_right).count();
    assert!(judged.len() > 2_000 && right * 100 >= judged.len() * 98, "{right} of {}", judged.len());
    // Nothing behind the camera has a colour.
    assert!(coloured.iter().all(|(place_m, _)| place_m[0] > -1.5));
    refusals([&bag, &out, &camera, &taken]);
}

fn refusals([bag, out, camera, taken]: [&str; 4]) {
    let code = |more: &[&str]| {
        let output = map3d(&[&[bag, "--out", out, "--colour", "camera"], more].concat());
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert_eq!(code(&[]).0, Some(2), "without a camera");
    // The bag itself has no pictures.
    let (status, words) = code(&["--camera", camera]);
    assert!(status == Some(3) && words.contains("no CompressedImage"), "{words}");
    camera_file(Path::new(camera), &Value::Null);
    let (status, words) = code(&["--camera", camera, "--pictures", taken]);
    assert!(status == Some(3) && words.contains("calibrate camera-lidar"), "{words}");
}
