//! Global localisation in random buildings of which a third of each scan has changed since they were mapped. The world is a raster
//! of its own, and its rays are stepped through it: nothing of the code under test makes the scans.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use floorguard_mapping::Occupancy;

use super::*;
use crate::grid_map::GridMap;
use crate::input::ScanRecord;
use crate::se2::{Se2, wrap};

#[path = "oracle_tests.rs"]
mod oracle;

/// A linear congruential generator (Knuth 1998, section 3.3.4).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        (0..4).for_each(|_| _ = random.within(0.0, 1.0));
        random
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.within(0.0, 1.0)).sum::<f64>() - 6.0
    }
}

const CELL_M: f64 = 0.05;
const RANGE_M: f64 = 30.0;
const BEAMS: usize = 541;
pub(crate) const STEP_S: f64 = 0.1;
const SPEED_MPS: f64 = 0.8;
const TURN_RADPS: f64 = 0.9;
/// A drive: within ten seconds of driving it should be found, within thirty it must.
const DRIVE_S: f64 = 30.0;
const SOON_S: f64 = 10.0;
/// A place that was found is watched for so long.
const WATCHED_S: f64 = 8.0;
/// A place is wrong beyond this.
pub(crate) const WRONG: (f64, f64) = (0.5, 0.2);

/// Lower and upper corner of something that stands on the floor.
type Cuboid = [[f64; 2]; 2];

#[derive(Clone)]
pub(crate) struct World {
    columns: usize,
    rows: usize,
    solid: Vec<bool>,
    /// Squares of eight cells that are solid somewhere, or beside such a one.
    near: Vec<bool>,
}

impl World {
    pub(crate) fn new(width_m: f64, height_m: f64) -> Self {
        let (columns, rows) = ((width_m / CELL_M) as usize, (height_m / CELL_M) as usize);
        Self {
            columns,
            rows,
            solid: vec![false; columns * rows],
            near: vec![false; (columns / 8 + 3) * (rows / 8 + 3)],
        }
    }

    pub(crate) fn draw(&mut self, [low, high]: Cuboid) {
        let cell = |value: f64, count: usize| ((value / CELL_M) as usize).min(count - 1);
        for row in cell(low[1], self.rows)..=cell(high[1], self.rows) {
            for column in cell(low[0], self.columns)..=cell(high[0], self.columns) {
                self.solid[row * self.columns + column] = true;
                for (down, left) in [0, 1, 2].into_iter().flat_map(|y| [0, 1, 2].map(|x| (y, x))) {
                    self.near[(row / 8 + down) * (self.columns / 8 + 3) + column / 8 + left] = true;
                }
            }
        }
    }

    fn is_solid(&self, x: f64, y: f64) -> bool {
        let (column, row) = ((x / CELL_M).floor(), (y / CELL_M).floor());
        let inside = column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        !inside || self.solid[row as usize * self.columns + column as usize]
    }

    pub(crate) fn range_m(&self, from: [f64; 2], angle: f64) -> f64 {
        let (sin, cos) = angle.sin_cos();
        let mut step = 0_u32;
        while f64::from(step) * 0.025 < RANGE_M {
            let along = 0.025 * f64::from(step);
            let (x, y) = (from[0] + along * cos, from[1] + along * sin);
            if self.is_solid(x, y) {
                return along;
            }
            let (column, row) = ((x / CELL_M) as usize / 8 + 1, (y / CELL_M) as usize / 8 + 1);
            // Where a square and those around it are empty, 0.4 m are.
            step += if self.near[row * (self.columns / 8 + 3) + column] { 1 } else { 16 };
        }
        f64::INFINITY
    }

    fn clearance_m(&self, place: [f64; 2]) -> f64 {
        (0..24).map(|step| self.range_m(place, f64::from(step) * PI / 12.0)).fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn map(&self) -> GridMap {
        let state = |solid: &bool| if *solid { Occupancy::Occupied } else { Occupancy::Free };
        GridMap {
            columns: self.columns,
            rows: self.rows,
            cell_m: CELL_M,
            corner_m: [0.0, 0.0],
            cells: self.solid.iter().map(state).collect(),
        }
    }
}

/// Walls, and furniture that may be moved.
pub(crate) struct Building {
    pub(crate) walls: World,
    pub(crate) furniture: Vec<Cuboid>,
}

impl Building {
    /// A corridor with rooms to both sides, each with a door and furniture.
    pub(crate) fn random(random: &mut Random) -> Self {
        let (width, height) = (random.within(22.0, 38.0), random.within(15.0, 24.0));
        let mut walls = World::new(width, height);
        let middle = 0.5 * height;
        let mut furniture = Vec::new();
        for wall in [[[0.0, 0.0], [width, 0.1]], [[0.0, height - 0.1], [width, height]]] {
            walls.draw(wall);
        }
        for wall in [[[0.0, 0.0], [0.1, height]], [[width - 0.1, 0.0], [width, height]]] {
            walls.draw(wall);
        }
        for (low, high, corridor) in [(0.0, middle - 1.2, middle - 1.2), (middle + 1.2, height, middle + 1.2)]
        {
            let mut left = 0.0;
            while left < width - 2.0 {
                let right = if width - left < 9.0 { width } else { left + random.within(4.0, 8.0) };
                let door = random.within(left + 0.5, right - 1.7);
                walls.draw([[left, corridor], [door, corridor + 0.1]]);
                walls.draw([[door + 1.1, corridor], [right, corridor + 0.1]]);
                walls.draw([[right - 0.1, low], [right, high]]);
                for _ in 0..random.within(2.0, 6.0) as usize {
                    let size = [random.within(0.3, 1.6), random.within(0.3, 1.0)];
                    let at = [random.within(left + 0.2, right - 1.9), random.within(low + 0.2, high - 1.2)];
                    let is_at_door = (at[1] - corridor).abs() < 2.0;
                    if !is_at_door {
                        furniture.push([at, [at[0] + size[0], at[1] + size[1]]]);
                    }
                }
                left = right;
            }
        }
        Self { walls, furniture }
    }

    pub(crate) fn with(&self, furniture: &[Cuboid]) -> World {
        let mut world = self.walls.clone();
        furniture.iter().for_each(|each| world.draw(*each));
        world
    }
}

/// Ahead until something is near, then towards where there is most room.
pub(crate) fn drive(world: &World, random: &mut Random) -> Option<Vec<Se2>> {
    let start = (0..400).find_map(|_| {
        let place = [
            random.within(0.5, world.columns as f64 * CELL_M - 0.5),
            random.within(0.5, world.rows as f64 * CELL_M - 0.5),
        ];
        (world.clearance_m(place) > 0.7).then_some(place)
    })?;
    let mut pose = Se2::new(start[0], start[1], random.within(-PI, PI));
    let mut wanted: Option<f64> = None;
    let mut path = vec![pose];
    for _ in 0..(DRIVE_S / STEP_S) as usize {
        let place = [pose.x_m, pose.y_m];
        let free = |angle: f64| {
            let sides = [-0.35, -0.15, 0.0, 0.15, 0.35].map(|side| world.range_m(place, angle + side));
            sides.into_iter().fold(f64::INFINITY, f64::min)
        };
        if wanted.is_none() && free(pose.heading_rad) < 0.8 {
            let turns = (0..16).map(|step| pose.heading_rad + PI / 8.0 * f64::from(step));
            let scored = turns.map(|angle| (free(angle).min(6.0) * random.within(0.5, 1.0), angle));
            wanted = scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, angle)| angle);
        }
        pose = match wanted {
            Some(angle) => {
                let left = wrap(angle - pose.heading_rad);
                let turn = left.clamp(-TURN_RADPS * STEP_S, TURN_RADPS * STEP_S);
                wanted = (left.abs() > TURN_RADPS * STEP_S).then_some(angle);
                Se2::new(pose.x_m, pose.y_m, pose.heading_rad + turn)
            }
            None => pose.compose(Se2::new(SPEED_MPS * STEP_S, 0.0, 0.0)),
        };
        path.push(pose);
    }
    Some(path)
}

/// Angles of the beams in the scanner's frame.
pub(crate) fn beam_rad(beam: usize) -> f64 {
    (0.5 * beam as f64 - 135.0).to_radians()
}

/// Every so manyth beam.
pub(crate) fn scan(world: &World, pose: &Se2, each: usize) -> Vec<f64> {
    (0..BEAMS)
        .step_by(each)
        .map(|beam| world.range_m([pose.x_m, pose.y_m], pose.heading_rad + beam_rad(beam)))
        .collect()
}

/// Moves and adds furniture, away from the path, until a third of the returns of the drive have changed.
fn changed(building: &Building, mapped: &World, path: &[Se2], random: &mut Random) -> (World, f64) {
    let kept: Vec<Cuboid> =
        building.furniture.iter().enumerate().filter(|(i, _)| i % 3 != 0).map(|(_, f)| *f).collect();
    let mut world = building.with(&kept);
    let before: Vec<_> = path.iter().step_by(25).map(|pose| (*pose, scan(mapped, pose, 6))).collect();
    let mut share = 0.0;
    for _ in 0..80 {
        let (mut all, mut other) = (0, 0);
        for (pose, then) in &before {
            for (now, then) in scan(&world, pose, 6).iter().zip(then) {
                all += 1;
                other += usize::from((now - then).abs() > 0.15);
            }
        }
        share = f64::from(other as u32) / f64::from(all as u32);
        if share >= 1.0 / 3.0 {
            break;
        }
        let pose = path[random.within(0.0, path.len() as f64 - 1.0) as usize];
        let angle = pose.heading_rad + random.within(-2.3, 2.3);
        let range = world.range_m([pose.x_m, pose.y_m], angle) * random.within(0.3, 0.9);
        let (sin, cos) = angle.sin_cos();
        let (x, y, half) = (pose.x_m + range * cos, pose.y_m + range * sin, random.within(0.1, 0.4));
        if path.iter().all(|pose| (pose.x_m - x).abs().max((pose.y_m - y).abs()) > half + 0.4) {
            world.draw([[(x - half).max(0.0), (y - half).max(0.0)], [x + half, y + half]]);
        }
    }
    (world, share)
}

/// How a drive ended.
#[derive(Clone, Copy, Debug, Default)]
struct Ended {
    found_s: Option<f64>,
    wrong: bool,
    changed: f64,
    statistics: LocaliserStatistics,
    ambiguity: Option<oracle::Ambiguity>,
}

fn located(building: &Building, random: &mut Random) -> Option<Ended> {
    let mapped = building.with(&building.furniture);
    let path = drive(&mapped, random)?;
    let (world, changed) = changed(building, &mapped, &path, random);
    let config = LocaliseConfig::default();
    let mut localiser = Localiser::new(KnownMap::new(mapped.map(), &config)?, config);
    let mut odometry = Se2::default();
    let mut ended = Ended { changed, ..Ended::default() };
    for (index, pose) in path.iter().enumerate() {
        if let Some(before) = index.checked_sub(1) {
            let step = path[before].between(*pose);
            let slip = 1.0 + 0.02 * random.normal();
            let turn = step.heading_rad * (1.02 + 0.02 * random.normal());
            odometry = odometry.compose(Se2::new(step.x_m * slip, step.y_m, turn));
        }
        let ranges = scan(&world, pose, 1).into_iter().map(|range| (range + 0.01 * random.normal()) as f32);
        let record = ScanRecord {
            time_s: STEP_S * index as f64,
            odometry: Some(odometry),
            first_angle_rad: beam_rad(0) as f32,
            step_rad: 0.5_f32.to_radians(),
            ranges_m: ranges.collect(),
            ..ScanRecord::default()
        };
        if ended.found_s.is_some_and(|found_s| record.time_s > found_s + WATCHED_S) {
            break;
        }
        let answer = localiser.push(&record);
        let Some(found) = answer.pose.filter(|_| answer.belief == Belief::Found) else { continue };
        let off = pose.between(found);
        let is_wrong = off.length_m() > WRONG.0 || off.heading_rad.abs() > WRONG.1;
        ended.wrong |= is_wrong;
        if !is_wrong && ended.found_s.is_none() {
            ended.found_s = Some(record.time_s);
        }
    }
    ended.statistics = localiser.statistics;
    ended.ambiguity = oracle::asked(&ended, building, [&mapped, &world], &path);
    Some(ended)
}

/// A start in a map.
fn one(map: u64, start: u64) -> Option<Ended> {
    let building = Building::random(&mut Random::new(map + 1));
    located(&building, &mut Random::new(1_000 * (map + 1) + start + 1))
}

/// The drives that an order names, by map and start: `20x100` for 100 starts in each of 20 maps, `20x100@20` for those in the next
/// twenty, `3/71,5/13` for single ones.
fn drives_of(order: &str) -> Option<Vec<(u64, u64)>> {
    if order.contains('/') {
        let single = |drive: &str| {
            let (map, start) = drive.split_once('/')?;
            Some((map.parse().ok()?, start.parse().ok()?))
        };
        return order.split(',').map(single).collect();
    }
    let (counts, first) = order.split_once('@').unwrap_or((order, "0"));
    let (maps, starts) = counts.split_once('x')?;
    let (first, maps, starts): (u64, u64, u64) =
        (first.parse().ok()?, maps.parse().ok()?, starts.parse().ok()?);
    Some((first..first + maps).flat_map(|map| (0..starts).map(move |start| (map, start))).collect())
}

/// Every drive with its number, on as many cores as there are.
fn on_all_cores(drives: &[(u64, u64)]) -> Vec<((u64, u64), Ended)> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut ended = Vec::new();
        while let Some(&(map, start)) = drives.get(next.fetch_add(1, Ordering::Relaxed)) {
            ended.extend(one(map, start).map(|one| ((map, start), one)));
        }
        ended
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut all: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a drive ends")).collect()
    });
    all.sort_by_key(|(number, _)| *number);
    all
}

/// `FLOORGUARD_LOCALISATION` names the drives (see `drives_of`): with `20x100` the whole campaign is run and printed, without it a single
/// drive is.
#[test]
fn places_are_found_in_changed_buildings() {
    let order = std::env::var("FLOORGUARD_LOCALISATION").unwrap_or_else(|_| "1x1".to_owned());
    let drives = drives_of(&order).expect("20x100, 20x100@20 or 3/71,5/13");
    let ended = on_all_cores(&drives);
    let count = |holds: &dyn Fn(&Ended) -> bool| ended.iter().filter(|(_, one)| holds(one)).count() as u32;
    let (all, wrong) = (ended.len() as u32, count(&|one| one.wrong));
    let (found, soon) = (
        count(&|one| one.found_s.is_some()),
        count(&|one| one.found_s.is_some_and(|found_s: f64| found_s <= SOON_S)),
    );
    let share: f64 = ended.iter().map(|(_, one)| one.changed).sum();
    let is_shown = |one: &Ended| one.wrong || one.found_s.is_none() || one.ambiguity.is_some();
    for ((map, start), one) in ended.iter().filter(|(_, one)| is_shown(one)) {
        let is_ambiguous = one.ambiguity.is_some_and(|found| found.is_there());
        println!("map {map} start {start}: {one:?}{}", if is_ambiguous { " ambiguous" } else { "" });
    }
    println!(
        "{all} drives, {:.2} of the returns changed: {found} found, {soon} within 10 s, {wrong} wrongly certain",
        share / f64::from(all.max(1))
    );
    assert_eq!(wrong, 0, "of {all}");
    assert!(all > 0 && 2 * found >= all, "{found} of {all}");
}

/// Drives of the campaign, by map and start: five in which an emptier room was once taken for the right one, three in which a moved
/// cupboard was followed, three in which a row of cupboards that was gone counted as a wall, and two in which the place turned by half a circle led.
const ONCE_WRONG: [(u64, u64); 13] = [
    (2, 19),
    (4, 48),
    (7, 34),
    (5, 13),
    (4, 42),
    (16, 64),
    (11, 8),
    (13, 82),
    (8, 18),
    (8, 36),
    (8, 42),
    (10, 61),
    (15, 34),
];

#[test]
fn drives_once_wrong_are_right() {
    let ended = on_all_cores(&ONCE_WRONG);
    assert_eq!(ended.len(), ONCE_WRONG.len());
    for ((map, start), ended) in ended {
        assert!(!ended.wrong && ended.found_s.is_some(), "map {map} start {start}: {ended:?}");
    }
}
