//! The cylinders of a world, its reference path, and what a scanner sees in it.

use std::path::Path;

use anyhow::Context as _;
use floorguard_types::geometry::{Point2, Pose2};

use super::archive::tables;

/// Radius of the cylinders and half a cell of the reference path, metres.
const RADIUS_M: f32 = 0.075;
/// The robot starts here, headed along y.
const START: (f32, f32) = (-2.0, 3.0);
/// The goal lies this far ahead, metres.
const AHEAD_M: f32 = 10.0;
/// Speed of the reference, m/s.
const REFERENCE_MPS: f32 = 2.0;

/// A world.
#[derive(Clone, Debug)]
pub struct World {
    /// Its number in the benchmark.
    pub number: u32,
    /// Middle and radius of each cylinder.
    pub cylinders: Vec<(Point2, f32)>,
    /// Length of the reference path, metres.
    pub path_m: f32,
}

impl World {
    /// Where the robot starts.
    #[must_use]
    pub fn start() -> Pose2 {
        Pose2::new(START.0, START.1, std::f32::consts::FRAC_PI_2)
    }

    /// Where it shall go.
    #[must_use]
    pub fn goal() -> Point2 {
        Point2::new(START.0, START.1 + AHEAD_M)
    }

    /// Time of the reference, seconds.
    #[must_use]
    pub fn optimal_s(&self) -> f32 {
        self.path_m / REFERENCE_MPS
    }

    /// Range along a ray to the first cylinder; infinite where there is none. A ray from within one hits at once.
    #[must_use]
    pub fn range_m(&self, from: Point2, direction_rad: f32) -> f32 {
        let (sin, cos) = libm::sincosf(direction_rad);
        let ranges = self.cylinders.iter().filter_map(|(middle, radius_m)| {
            let (dx, dy) = (middle.x_m - from.x_m, middle.y_m - from.y_m);
            let (along_m, aside_m) = (dx * cos + dy * sin, dy * cos - dx * sin);
            let half_m2 = radius_m * radius_m - aside_m * aside_m;
            (half_m2 >= 0.0 && along_m > -radius_m).then(|| (along_m - libm::sqrtf(half_m2)).max(0.0))
        });
        ranges.fold(f32::INFINITY, f32::min)
    }
}

/// All worlds of a file, by number.
///
/// # Errors
/// The file is not the benchmark's.
pub fn load(path: &Path) -> anyhow::Result<Vec<World>> {
    let tables = tables(path)?;
    let mut worlds = Vec::new();
    for table in tables.iter().filter(|table| table.name.starts_with("cyl_")) {
        let number = table.name.trim_start_matches("cyl_");
        let reference = tables.iter().find(|other| other.name == format!("path_{number}"));
        let cells = reference.with_context(|| format!("world {number} has no path"))?;
        let cylinders = table.rows.iter().map(|row| (Point2::new(row[0], row[1]), row[2])).collect();
        worlds.push(World { number: number.parse()?, cylinders, path_m: length_m(&cells.rows) });
    }
    worlds.sort_by_key(|world| world.number);
    Ok(worlds)
}

/// Length of a reference path from start to goal, as the benchmark counts it.
fn length_m(cells: &[Vec<f32>]) -> f32 {
    let place = |cell: &Vec<f32>| {
        Point2::new(
            cell[0] * 2.0 * RADIUS_M - RADIUS_M - 60.0 * RADIUS_M,
            cell[1] * 2.0 * RADIUS_M + RADIUS_M + 5.0,
        )
    };
    let start = Point2::new(START.0, START.1);
    let points: Vec<Point2> =
        std::iter::once(start).chain(cells.iter().map(place)).chain([World::goal()]).collect();
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}
