//! `floorguard eval ground`: floors of real lidars against planes and labels that others found.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::replay_command::{floorguard, text};

fn data(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if !path.exists() {
        eprintln!("skipped: {name} is not there");
    }
    path.exists().then_some(path)
}

fn ground(words: &[&str]) -> Value {
    let output = floorguard(&[&["eval", "ground", "--json"], words].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    serde_json::from_slice(&output.stdout).expect("one object")
}

/// A VLP-16 tilted by 6.7°, 1.6 m above the floor of a laboratory; the planes of the key are those of RANSAC.
#[test]
fn plane_of_a_tilted_lidar_is_found() {
    let Some(key) = data("vlp16_clouds/acfr_lab/key.csv") else { return };
    let key = std::fs::read_to_string(key).expect("a key");
    let mut lines = key.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    for row in lines {
        let value = |name: &str| -> f64 {
            let column = head.iter().position(|other| *other == name).expect("a column");
            row[column].parse().expect("a number")
        };
        let Some(cloud) = data(&format!("vlp16_clouds/acfr_lab/{}_full.pcd.gz", row[0])) else { return };
        let found = ground(&[text(&cloud)]);
        let dot: f64 = ["floor_nx", "floor_ny", "floor_nz"]
            .iter()
            .zip(found["normal"].as_array().expect("a normal"))
            .map(|(name, part)| value(name) * part.as_f64().expect("a number"))
            .sum();
        assert!(dot.clamp(-1.0, 1.0).acos().to_degrees() < 0.3, "{}: {found}", row[0]);
        assert!((found["height_m"].as_f64().expect("a height") - value("floor_d")).abs() < 0.02, "{found}");
    }
}

/// 64 rings on a street, labelled by SemanticKITTI.
#[test]
fn labelled_street_is_found() {
    let names = ["lidar_ground_kitti/kitti00_000000.bin.gz", "lidar_ground_kitti/kitti00_000000.label.gz"];
    let [Some(cloud), Some(labels)] = names.map(data) else { return };
    let found = ground(&[text(&cloud), "--truth", text(&labels)]);
    let agreement = |key: &str| found["agreement"][key].as_f64().expect("a share");
    assert!(agreement("precision") > 0.98 && agreement("recall") > 0.8, "{found}");
}

/// The same cloud of four forms: 16 rings over a level floor 0.8 m below.
#[test]
fn every_form_of_a_cloud_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut rows: Vec<[f32; 3]> = Vec::new();
    for ring in 0..7_u8 {
        let (sin, cos) = (-15.0 + 2.0 * f32::from(ring)).to_radians().sin_cos();
        for column in 0..360_u16 {
            let (y, x) = f32::from(column).to_radians().sin_cos();
            let range_m = -0.8 / sin;
            rows.push([range_m * cos * x, range_m * cos * y, -0.8]);
        }
    }
    let words = rows.iter().fold(String::new(), |mut words, [x, y, z]| {
        writeln!(words, "{x} {y} {z}").expect("memory");
        words
    });
    let bytes: Vec<u8> = rows.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    let count = rows.len();
    let ply = |format: &str| {
        let properties = "property float x\nproperty float y\nproperty float z";
        format!("ply\nformat {format} 1.0\nelement vertex {count}\n{properties}\nend_header\n")
    };
    let pcd = |form: &str| {
        let head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1";
        format!("{head}\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {form}\n")
    };
    let forms: [(&str, Vec<u8>); 4] = [
        ("text.ply", [ply("ascii").as_bytes(), words.as_bytes()].concat()),
        ("binary.ply", [ply("binary_little_endian").as_bytes(), &bytes].concat()),
        ("text.pcd", [pcd("ascii").as_bytes(), words.as_bytes()].concat()),
        ("binary.pcd", [pcd("binary").as_bytes(), &bytes].concat()),
    ];
    for (name, content) in forms {
        let path = folder.path().join(name);
        std::fs::write(&path, &content).expect("written");
        let found = ground(&[text(&path)]);
        assert_eq!(found["points"].as_u64(), Some(count as u64), "{name}");
        assert!((found["height_m"].as_f64().expect("a height") - 0.8).abs() < 0.01, "{name}: {found}");
        assert!(found["floor_points"].as_u64() > Some(count as u64 * 9 / 10), "{name}: {found}");
        // Cut: it says how many points are missing.
        std::fs::write(&path, &content[..content.len() - 60]).expect("written");
        let output = floorguard(&["eval", "ground", text(&path)]);
        assert_eq!(output.status.code(), Some(3), "{name}: {output:?}");
    }
}
