//! The cleaning stages: a step of the belief, tours, re-planning; beside what others need for less.

use std::io::Read as _;
use std::time::{Duration, Instant};

use floorguard_cleaning::{
    ActiveCell, Belief, Distances, EuclideanCells, Evidence, PlanCells, Planner, PoseDeviation, TourSolver,
};
use floorguard_laboratory::mission::{MissionConfig, Robot, Strategy};
use floorguard_localisation::OdometryStep;
use floorguard_mapping::poisson_tail;
use floorguard_mapping::{DirtCell, DistanceField, Grid, GridGeometry, fill_distances};
use floorguard_navigation::{PathSearch, SearchCell};
use floorguard_robot::site::{CELL_M, Floor, ros_map};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

use super::cpu::Stopwatch;
use crate::data::{bench_input, recording};

/// A step of nav2's AMCL with 500 particles and 60 beams, without dirt, milliseconds (the README of the inputs).
const AMCL_MS: f64 = 2.4;
/// What a step with dirt may take, milliseconds, and how much longer it may take over a hundred times the floor.
const STEP_MAX_MS: f64 = 0.5;
const GROWTH_MAX: f64 = 1.3;
/// What a tour may be longer than the best known one, percent, after how long, for each size.
const TOUR_MAX: [(u16, f64, Duration); 3] = [
    (100, 1.0, Duration::from_millis(50)),
    (300, 1.0, Duration::from_millis(50)),
    (1_000, 3.0, Duration::from_millis(500)),
];
/// What a re-planning may take, milliseconds.
const REPLAN_MAX_MS: f64 = 50.0;
const PARTICLES: usize = 500;
const NODES: usize = 1_026;
/// Rounds over the recorded poses.
const ROUNDS: usize = 40;

/// One line of the section.
pub struct Line {
    /// What was measured.
    pub stage: String,
    /// Value with its unit.
    pub value: String,
    /// Beside what.
    pub beside: String,
    /// It is as the goals ask.
    pub holds: bool,
}

/// All measurements whose inputs are there.
#[must_use]
pub fn run() -> Vec<Line> {
    let mut lines = Vec::new();
    if let Some(map) = Map::load() {
        lines.extend(filter(&map));
    }
    for (size, most_percent, limit) in TOUR_MAX {
        let instance = |number| tour(&format!("tsp_{size}_{number}"), most_percent, limit);
        lines.extend((1..=3).filter_map(instance));
    }
    lines.extend(replanning());
    lines
}

/// The recorded poses with their scans of 360 beams, and the map.
struct Map {
    field: DistanceField<Vec<u8>>,
    poses: Vec<Pose2>,
    scans: Vec<Vec<Point2>>,
}

fn unpack(name: &str) -> Option<Vec<u8>> {
    let file = std::fs::File::open(bench_input(&format!("particles/{name}"))?).ok()?;
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(file).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

fn numbers(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(8).filter_map(|c| c.try_into().ok()).map(|c| f64::from_le_bytes(c) as f32).collect()
}

impl Map {
    fn load() -> Option<Self> {
        let cells = unpack("map_840x640_res0.05_origin-21_-16.i8.gz")?;
        let geometry = GridGeometry::new(840, 640, 0.05, Point2::new(-21.0, -16.0))?;
        let mut field = Grid::new(geometry, vec![0_u8; geometry.cell_count()]).ok()?;
        let mut scratch = Grid::new(geometry, vec![0_u8; geometry.cell_count()]).ok()?;
        fill_distances(&mut field, &mut scratch, |i| cells.get(i).is_some_and(|&c| c.cast_signed() > 50));
        let poses = numbers(&unpack("poses_50x3_f64.raw.gz")?);
        let poses = poses.chunks_exact(3).map(|p| Pose2::new(p[0], p[1], p[2])).collect();
        let ranges = numbers(&unpack("scans_50x360_f64.raw.gz")?);
        let scans = ranges.chunks_exact(360).map(scan_of).collect();
        Some(Self { field, poses, scans })
    }
}

/// Every sixth of 360 beams.
fn scan_of(ranges: &[f32]) -> Vec<Point2> {
    (0..ranges.len())
        .step_by(6)
        .filter(|&i| ranges[i].is_finite() && ranges[i] < 30.0)
        .map(|i| {
            let angle = (i as f32).to_radians() - std::f32::consts::PI;
            Point2::new(ranges[i] * angle.cos(), ranges[i] * angle.sin())
        })
        .collect()
}

/// Median time of a step over the recorded scans, over a dirt map of so many cells along an edge.
fn step_ms(map: &Map, (side, has_dirt): (u16, bool)) -> Option<f64> {
    let corner = Point2::new(-0.5 * f32::from(side) * CELL_M, -0.5 * f32::from(side) * CELL_M);
    let geometry = GridGeometry::new(side, side, CELL_M, corner)?;
    let units = if has_dirt { 12.0 } else { 0.0 };
    let cell = DirtCell::poisson(units, poisson_tail(5, f64::from(units)) as f32);
    let mut dirt = Grid::new(geometry, vec![cell; geometry.cell_count()]).ok()?;
    let config =
        MissionConfig { robot: Robot::WITH_SCANNER, ..MissionConfig::published(Strategy::Guarantee) };
    let storage = vec![ActiveCell::<PARTICLES>::EMPTY; 256];
    let mut belief = Box::new(Belief::new(config.belief(), storage, Pcg32::new(1, 1)));
    let step = OdometryStep { forward_m: 0.1, ..OdometryStep::default() };
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        for (&pose, scan) in map.poses.iter().zip(&map.scans) {
            belief.place(pose, PoseDeviation { position_m: 0.05, heading_rad: 0.05 });
            let evidence = Evidence { hits_in_base: scan, dirt_hits: Some(3), brush_is_cleaning: true };
            let begin = Instant::now();
            belief.update(step, &evidence, (&map.field, &mut dirt));
            times.push(begin.elapsed().as_secs_f64() * 1e3);
        }
    }
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied()
}

fn filter(map: &Map) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut small_ms = f64::INFINITY;
    for (stage, side, has_dirt) in [
        ("belief step, no dirt, 500 particles, 60 beams", 100, false),
        ("belief step, every cell dirty, 100 m²", 100, true),
        ("belief step, every cell dirty, 10,000 m²", 1_000, true),
    ] {
        let Some(ms) = step_ms(map, (side, has_dirt)) else { continue };
        small_ms = small_ms.min(if has_dirt { ms } else { f64::INFINITY });
        lines.push(Line {
            holds: ms <= STEP_MAX_MS && ms <= GROWTH_MAX * small_ms,
            stage: stage.to_owned(),
            value: format!("{ms:.3} ms, {:.2} % of a core at 10 Hz", ms),
            beside: format!("{:.1} times as fast as nav2's AMCL ({AMCL_MS} ms, without dirt)", AMCL_MS / ms),
        });
    }
    lines
}

struct Matrix {
    count: usize,
    values: Vec<i32>,
}

impl Distances for Matrix {
    fn between(&self, from: u16, to: u16) -> i32 {
        self.values[usize::from(from) * self.count + usize::from(to)]
    }
}

fn tour(name: &str, most_percent: f64, limit: Duration) -> Option<Line> {
    let text = std::fs::read_to_string(bench_input(&format!("tsp/{name}.csv"))?).ok()?;
    let points: Vec<(f32, f32)> = text
        .lines()
        .filter_map(|line| line.split_once(',').and_then(|(x, y)| Some((x.parse().ok()?, y.parse().ok()?))))
        .collect();
    let keys = std::fs::read_to_string(bench_input("tsp/best_known.json")?).ok()?;
    let keys: serde_json::Value = serde_json::from_str(&keys).ok()?;
    let best = keys[name]["length"].as_f64()?;
    let straight = EuclideanCells { points: &points, scale: 1_000.0 };
    let ids = || 0..points.len() as u16;
    let values =
        ids().flat_map(|a| ids().map(move |b| (a, b))).map(|(a, b)| straight.between(a, b)).collect();
    let distances = Matrix { count: points.len(), values };
    let mut solver = Box::new(TourSolver::<NODES>::new(Pcg32::new(1, 1)));
    let begin = Stopwatch::begin();
    solver.start_closed(points.len(), &distances).ok()?;
    while begin.elapsed() < limit {
        solver.improve(50, &distances);
    }
    let order: Vec<u16> = solver.order().collect();
    let at = |i: usize| points[usize::from(order[i % order.len()])];
    let length: f64 = (0..order.len())
        .map(|i| f64::from(at(i).0 - at(i + 1).0).hypot(f64::from(at(i).1 - at(i + 1).1)))
        .sum();
    let percent = 100.0 * (length / best - 1.0);
    Some(Line {
        holds: percent <= most_percent,
        stage: format!("tour {name} in {} ms", limit.as_millis()),
        value: format!("{percent:+.2} %"),
        beside: "over the best known tour (LKH)".to_owned(),
    })
}

/// 300 cells of a real building: the first plan, and a re-planning with three new cells.
fn replanning() -> Option<Line> {
    let map = ros_map::load(&recording("grid_maps/willow-full-0.05.yaml")?).ok()?;
    let floor = Floor::new("willow", map, Robot::PUBLISHED.radius_m).ok()?;
    let mut reachable: Vec<usize> = (0..floor.cells.cell_count()).filter(|&i| floor.reachable[i]).collect();
    let mut random = Pcg32::new(7, 7);
    let cells: Vec<usize> = (0..300 + 3 * 20)
        .map(|_| reachable.swap_remove(random.below(reachable.len() as u32) as usize))
        .collect();
    let search = PathSearch::new(floor.cells, vec![SearchCell::EMPTY; floor.cells.cell_count()]);
    let mut planner = Box::new(Planner::<_, _, NODES>::new(search, vec![0; NODES * NODES], Pcg32::new(1, 1)));
    let robot = floor.nearest_passable(Point2::new(floor.start.x_m, floor.start.y_m))?;
    let mut times = Vec::new();
    let mut first_ms = 0.0;
    for round in 0..20 {
        let mut wanted = vec![false; floor.cells.cell_count()];
        cells[3 * round..300 + 3 * round].iter().for_each(|&cell| wanted[cell] = true);
        let begin = Stopwatch::begin();
        let cells = PlanCells { wanted: |c: usize| wanted[c], passable: |c: usize| floor.passable[c] };
        planner.replan(robot, &cells, 500).ok()?;
        let ms = begin.elapsed().as_secs_f64() * 1e3;
        if round == 0 { first_ms = ms } else { times.push(ms) }
    }
    times.sort_by(f64::total_cmp);
    Some(Line {
        holds: times[times.len() / 2] <= REPLAN_MAX_MS,
        stage: "re-planning, 300 cells of willow, 3 new".to_owned(),
        value: format!("{:.1} ms median, {:.1} ms worst", times[times.len() / 2], times[times.len() - 1]),
        beside: format!("goal 50 ms; the first plan took {first_ms:.0} ms"),
    })
}
