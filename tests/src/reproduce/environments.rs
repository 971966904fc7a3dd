//! The four environments of Figure 5: two artificial rooms, and two parts of recorded buildings.

use floorguard_laboratory::mission::Robot;
use floorguard_robot::site::{Floor, rooms, ros_map};
use floorguard_types::geometry::Point2;

use crate::data::recording;

/// A place to clean.
pub struct Environment {
    /// Its floor.
    pub floor: Floor,
}

/// A part of a recorded map: its file, and the smallest and largest corner in metres.
type Part = (&'static str, (f32, f32), (f32, f32));

/// An office with a piece of corridor, and
/// two offices with the corridor before them.
const RECORDED: [Part; 2] = [
    ("Freiburg52_scan_furnitures", (20.4, 9.4), (27.9, 16.6)),
    ("lab_c_scan_furnitures", (13.8, 5.4), (20.2, 13.2)),
];

/// All environments; recorded ones that are absent are left out, with a line that says so.
///
/// # Errors
/// A map that cannot be read.
pub fn environments() -> anyhow::Result<Vec<Environment>> {
    let radius_m = Robot::PUBLISHED.radius_m;
    let mut all = vec![
        Environment { floor: Floor::new("plain", rooms::plain()?, radius_m)? },
        Environment { floor: Floor::new("furnished", rooms::furnished()?, radius_m)? },
    ];
    for (name, low, high) in RECORDED {
        let Some(path) = recording(&format!("grid_maps/{name}.png")) else { continue };
        let map = ros_map::load(&path)?;
        let part = rooms::cut_out(&map, Point2::new(low.0, low.1), Point2::new(high.0, high.1))?;
        all.push(Environment { floor: Floor::new(name, part, radius_m)? });
    }
    Ok(all)
}
