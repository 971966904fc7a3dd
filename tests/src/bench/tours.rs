//! Tours over cells of recorded buildings, for ours and for the peers: the same distances round the walls.

use std::path::Path;
use std::time::{Duration, Instant};

use floorguard_cleaning::{Distances, TourSolver};
use floorguard_laboratory::mission::Robot;
use floorguard_navigation::{PathSearch, SearchCell};
use floorguard_robot::site::{Floor, ros_map};
use floorguard_types::random::Pcg32;

use super::cpu::{Stopwatch, Took};
use super::peers::OurTime;
use crate::data::recording;

/// Most cells of a tour: those of the robot's own planner.
const NODES: usize = 1_026;
/// Buildings.
const MAPS: [(&str, &str); 2] = [
    ("willow", "grid_maps/willow-full-0.05.yaml"),
    ("freiburg-101", "slam2d_logs/keys/corrected_freiburg-101.map.yaml"),
];
/// Cells, and the time that ours may take.
const SIZES: [(usize, Duration); 3] =
    [(100, Duration::from_millis(50)), (300, Duration::from_millis(50)), (1_000, Duration::from_millis(500))];

/// A tour of ours.
#[derive(Clone, Debug)]
pub struct OurTour {
    /// Building and cells.
    pub input: String,
    /// Units of the path search.
    pub length: f64,
    /// What it took.
    pub took: Took,
}

impl From<OurTour> for OurTime {
    fn from(tour: OurTour) -> Self {
        let unit_mm = distances_unit_mm();
        let note = format!("closed tour of {:.0} units of {unit_mm:.1} mm", tour.length);
        Self::once("tour", tour.input, tour.took, note)
    }
}

/// Distances in units of the path search.
struct Matrix {
    count: usize,
    values: Vec<i32>,
}

impl Distances for Matrix {
    fn between(&self, from: u16, to: u16) -> i32 {
        self.values[usize::from(from) * self.count + usize::from(to)]
    }
}

/// Cells drawn from those that the robot reaches, and the path between each two of them.
fn matrix(floor: &Floor, count: usize) -> Option<Matrix> {
    let mut reachable: Vec<usize> = (0..floor.cells.cell_count()).filter(|&i| floor.reachable[i]).collect();
    let mut random = Pcg32::new(7, count as u64);
    let cells: Vec<usize> = (0..count.min(reachable.len()))
        .map(|_| reachable.swap_remove(random.below(reachable.len() as u32) as usize))
        .collect();
    let mut search = PathSearch::new(floor.cells, vec![SearchCell::EMPTY; floor.cells.cell_count()]);
    let mut values = Vec::with_capacity(count * count);
    for &from in &cells {
        search.run(from, |cell| floor.passable[cell]);
        for &to in &cells {
            values.push(i32::try_from(search.distance(to)?).ok()?);
        }
    }
    (cells.len() == count).then_some(Matrix { count, values })
}

/// Solves, and writes distances and the length of our closed tour beside each other for the peers.
///
/// # Errors
/// A file that cannot be written, or a map that cannot be read.
pub fn tours(folder: &Path) -> anyhow::Result<Vec<OurTour>> {
    let mut tours = Vec::new();
    for (name, file) in MAPS {
        let Some(path) = recording(file) else { continue };
        let floor = Floor::new(name, ros_map::load(&path)?, Robot::PUBLISHED.radius_m)?;
        for (count, limit) in SIZES {
            let Some(distances) = matrix(&floor, count) else { continue };
            let mut solver = Box::new(TourSolver::<NODES>::new(Pcg32::new(1, 1)));
            let (started, begin) = (Instant::now(), Stopwatch::begin());
            solver
                .start_closed(count, &distances)
                .map_err(|error| anyhow::anyhow!("{name}, {count} cells: {error:?}"))?;
            while begin.elapsed() < limit {
                solver.improve(50, &distances);
            }
            let cpu_ns = begin.elapsed().as_nanos() as f64;
            let took = Took { wall_ns: started.elapsed().as_nanos() as f64, cpu_ns };
            let order: Vec<u16> = solver.order().collect();
            let ends = order.iter().zip(order.iter().cycle().skip(1));
            let length: i64 = ends.map(|(&a, &b)| i64::from(distances.between(a, b))).sum();
            let bytes: Vec<u8> = distances.values.iter().flat_map(|value| value.to_le_bytes()).collect();
            std::fs::write(folder.join(format!("tour-{name}_{count}.i32")), bytes)?;
            std::fs::write(folder.join(format!("tour-{name}_{count}.length")), length.to_string())?;
            let input = format!("{name}, {count} cells");
            tours.push(OurTour { input, length: length as f64, took });
        }
    }
    Ok(tours)
}

/// A straight step over a cell of 0.1 m counts so many units.
fn distances_unit_mm() -> f32 {
    100.0 / floorguard_navigation::STRAIGHT as f32
}
