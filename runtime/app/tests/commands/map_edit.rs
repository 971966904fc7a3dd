//! `floorguard map edit` on a map that others made, and a map of the simulated robot's own drive.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};

use floorguard_mapping::Occupancy;
use floorguard_robot::site::ros_map;
use floorguard_types::geometry::Point2;

fn floorguard(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output().expect("the program starts")
}

fn edit(arguments: &[&str]) -> Output {
    floorguard(&[&["map", "edit"], arguments].concat())
}

fn state(map: &ros_map::OccupancyMap, x_m: f32, y_m: f32) -> Option<Occupancy> {
    map.geometry().cell_at(Point2::new(x_m, y_m)).and_then(|cell| map.get(cell)).copied()
}

/// A room of 6 × 4 m, 0.05 m a pixel, with its corner at −1, −1: walls of a pixel around free floor.
fn room(folder: &Path) -> std::path::PathBuf {
    let (columns, rows) = (120, 80);
    let mut picture = format!("P5\n{columns} {rows}\n255\n").into_bytes();
    for row in 0..rows {
        let is_wall = |column: usize| row == 0 || row == rows - 1 || column == 0 || column == columns - 1;
        picture.extend((0..columns).map(|column| if is_wall(column) { 0 } else { 254 }));
    }
    std::fs::write(folder.join("room.pgm"), picture).expect("written");
    let text = "image: room.pgm\nresolution: 0.05\norigin: [-1.0, -1.0, 0.0]\nnegate: 0\n\
                occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    std::fs::write(folder.join("room.yaml"), text).expect("written");
    folder.join("room.yaml")
}

#[test]
fn edited_map_has_what_was_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let (map, out) = (room(folder.path()), folder.path().join("edited"));
    let [map, place] = [&map, &out].map(|path| path.to_str().expect("a path"));
    let output = edit(&[
        map,
        "--out",
        place,
        "--crop",
        "-1,-1,3,3",
        "--forget",
        "2,2,3,3",
        "--erase",
        "-1,0,-0.9,1",
        "--no-go",
        "0,0;1,0;1,1;0,1",
    ]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let edited = ros_map::load(&out.join("map.yaml")).expect("a map of ROS");
    assert_eq!((edited.geometry().columns(), edited.geometry().rows()), (80, 80));
    assert_eq!(state(&edited, 1.5, 0.5), Some(Occupancy::Free));
    assert_eq!([state(&edited, 2.5, 2.5), state(&edited, 0.5, 0.5)], [Some(Occupancy::Unknown); 2]);
    assert_eq!(
        [state(&edited, -0.98, 0.5), state(&edited, -0.98, 1.5)],
        [Some(Occupancy::Free), Some(Occupancy::Occupied)]
    );
    let mask = ros_map::load(&out.join("no_go.yaml")).expect("a mask");
    assert_eq!(
        [state(&mask, 0.5, 0.5), state(&mask, 1.5, 0.5)],
        [Some(Occupancy::Occupied), Some(Occupancy::Free)]
    );
    // The edited map can be edited again, in its own folder.
    let output = edit(&[place, "--turn-deg", "90", "--out", place]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let turned = ros_map::load(&out.join("map.yaml")).expect("a map of ROS");
    assert_eq!(
        [state(&turned, -2.5, 2.5), state(&turned, -0.5, 1.5)],
        [Some(Occupancy::Unknown), Some(Occupancy::Free)]
    );
    for (arguments, code) in [
        (&[map, "--out", folder.path().to_str().expect("a path")][..], 2),
        (&[map, "--out", place, "--crop", "1,2,3"][..], 2),
        (&[map, "--out", place, "--no-go", "1,2;3,4"][..], 2),
        (&[map, "--out", place, "--crop", "50,50,60,60"][..], 3),
        (&["nowhere.yaml", "--out", place][..], 3),
    ] {
        assert_eq!(edit(arguments).status.code(), Some(code), "{arguments:?}");
    }
}

/// A published building whose walls stand at an angle is turned to them.
#[test]
fn published_map_is_turned_to_its_walls() {
    let map = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/slam2d_logs/keys/corrected_fhw.map.yaml");
    if !map.exists() {
        let _ = writeln!(std::io::stderr(), "skipped: slam2d_logs is absent");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("straight");
    let [map, place] = [&map, &out].map(|path| path.to_str().expect("a path"));
    for (input, expected) in [(map, None), (place, Some("turned by 0.0"))] {
        let output = edit(&[input, "--to-walls", "--out", place]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_straight =
            !words.contains("turned") || words.contains("turned by 0.") || words.contains("turned by -0.");
        assert!(expected.is_none() || is_straight, "turned again: {words}");
    }
}

/// The robot drives its route with wheels that err, and leaves the map of what it passed; the drive can be mapped again.
#[test]
fn simulated_drive_leaves_a_map() {
    let folder = tempfile::tempdir().expect("a folder");
    let (out, again) = (folder.path().join("maps/here"), folder.path().join("again"));
    let [place, second] = [&out, &again].map(|path| path.to_str().expect("a path"));
    let drive = ["simulate", "--scenario", "supermarket", "--duration", "25", "--json", "--map-here", place];
    let output = floorguard(&drive);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let map = ros_map::load(&out.join("map.yaml")).expect("a map of ROS");
    let free = map.values().iter().filter(|cell| **cell == Occupancy::Free).count();
    let walls = map.values().iter().filter(|cell| **cell == Occupancy::Occupied).count();
    assert!(free as f64 * 0.0025 > 20.0 && walls > 300, "{free} {walls}");
    let recording = folder.path().join("maps/here.mcap");
    let output = floorguard(&["map", recording.to_str().expect("a path"), "--out", second]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let bytes = |folder: &Path| std::fs::read(folder.join("map.pgm")).expect("a picture");
    assert!(bytes(&out) == bytes(&again), "the same drive gives the same map");
    let foreign = folder.path().to_str().expect("a path");
    assert_eq!(
        floorguard(&["simulate", "--scenario", "supermarket", "--map-here", foreign]).status.code(),
        Some(2)
    );
}
