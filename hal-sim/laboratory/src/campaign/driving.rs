//! Drives without people, among furniture of every kind or in an empty hall: how often the robot stops without need.
//!
//! What counts is what the judge of contacts says, which knows the true geometry and nothing of the robot's fields.

use floorguard_sim::scenario::{RouteFile, Scenario, StartFile};
use floorguard_sim::scene::{FurnitureFile, FurnitureKind, Material, SceneFile, WallFile};
use floorguard_types::random::Pcg32;

use super::summary::RunOutcome;
use super::watched;
use crate::world::{Observation, Plan, SeenStop};

/// Robot time of a drive, seconds.
pub const DRIVE_S: u64 = 120;
/// Every second firing of the lidar is cast, 0.4° apart, and the one after it repeats it.
const LIDAR_GRAIN: usize = 2;
/// Half the length of the hall, metres; the robot drives a rectangle in its middle.
const HALL_M: [f32; 2] = [12.0, 9.0];
/// Corners of that rectangle, metres.
const CORNERS_M: [f32; 2] = [6.0, 3.5];
/// Furniture leaves this free about the middle of the path, metres: the body is 0.8 m broad, and turns with its tail.
const FREE_M: f32 = 1.2;
const PIECES: u32 = 40;
/// Draws for a piece, of which one may fall on the path.
const DRAWS: u32 = 20;
const STREAM: u64 = 71;

/// What stands in the hall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrivingPlace {
    /// Furniture of every kind.
    Furniture,
    /// Nothing but walls.
    EmptyHall,
}

impl DrivingPlace {
    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Furniture => "furniture",
            Self::EmptyHall => "empty-halls",
        }
    }

    /// The world of a drive.
    #[must_use]
    pub fn scenario(self, seed: u64) -> Scenario {
        let mut random = Pcg32::new(seed, STREAM);
        let [x_m, y_m] = CORNERS_M;
        let mut waypoints_m = vec![[x_m, -y_m], [x_m, y_m], [-x_m, y_m], [-x_m, -y_m]];
        if random.bernoulli(0.5) {
            // The other way round, from the same start.
            waypoints_m = vec![[-x_m, y_m], [x_m, y_m], [x_m, -y_m], [-x_m, -y_m]];
        }
        let yaw_deg = if waypoints_m[0][0] > 0.0 { 0.0 } else { 90.0 };
        Scenario {
            title: format!("a drive without people: {}", self.name()),
            start: StartFile { at_m: [-x_m, -y_m], yaw_deg },
            route: RouteFile { speed_mps: random.uniform_between(0.5, 0.8), repeat: true, waypoints_m },
            scene: SceneFile {
                wall: walls(),
                furniture: match self {
                    Self::Furniture => furniture(&mut random),
                    Self::EmptyHall => Vec::new(),
                },
                ..SceneFile::default()
            },
            ..Scenario::default()
        }
    }
}

/// One drive. It fails by a contact or a missed stop; stops without need are counted.
#[must_use]
pub fn drive(place: DrivingPlace, seed: u64) -> RunOutcome {
    let command = format!("floorguard campaign {} --seed {seed} --trials 1", place.name());
    let plan = Plan::of("drive", place.scenario(seed), seed, DRIVE_S * 1_000_000);
    let played = plan.map_err(anyhow::Error::from).and_then(|mut plan| {
        plan.lidar_grain = LIDAR_GRAIN;
        watched(&plan)
    });
    match played {
        Ok(observation) => {
            let without_need = without_need(&observation);
            let verdict = observation.verdict;
            let failure = (!verdict.passed).then(|| verdict.why_not());
            RunOutcome { command, failure, verdict: Some(verdict), without_need, ..RunOutcome::default() }
        }
        Err(error) => RunOutcome { command, failure: Some(format!("{error:#}")), ..RunOutcome::default() },
    }
}

/// The stops that the judge calls without need: when, where, and why the robot says that it stopped.
pub(super) fn without_need(observation: &Observation) -> Vec<String> {
    let of = |at_s: &f64| {
        let apart_s = |stop: &&SeenStop| (stop.at_s - at_s).abs();
        let stop = observation.stops.iter().min_by(|a, b| apart_s(a).total_cmp(&apart_s(b)));
        let why = |stop: &SeenStop| {
            let SeenStop { position, cause, .. } = stop;
            format!("{at_s:.1} s, at {:.2}, {:.2} m: {cause}", position.x_m, position.y_m)
        };
        stop.map_or_else(|| format!("{at_s:.1} s"), why)
    };
    observation.verdict.bodies.nuisance_stops_at_s.iter().map(of).collect()
}

/// Exact 95 % interval of a rate by counted events: events an hour. Garwood, *Biometrika* 28 (1936).
#[must_use]
pub fn rate95(events: u32, hours: f64) -> (f64, f64) {
    let lower = match events {
        0 => 0.0,
        some => solve(|mean| 1.0 - at_most(some - 1, mean) - 0.025, some),
    };
    let upper = solve(|mean| 0.025 - at_most(events, mean), events);
    (lower / hours, upper / hours)
}

/// Probability of so many events or fewer where that many are expected.
fn at_most(events: u32, mean: f64) -> f64 {
    let (mut term, mut sum) = ((-mean).exp(), 0.0);
    for count in 0..=events {
        sum += term;
        term *= mean / f64::from(count + 1);
    }
    sum
}

/// Where a rising function passes zero.
fn solve(rising: impl Fn(f64) -> f64, events: u32) -> f64 {
    let (mut low, mut high) = (0.0, 10.0 + 4.0 * f64::from(events));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if rising(middle) < 0.0 { low = middle } else { high = middle }
    }
    low
}

fn walls() -> Vec<WallFile> {
    let [x_m, y_m] = HALL_M;
    let corners = [[-x_m, -y_m], [x_m, -y_m], [x_m, y_m], [-x_m, y_m]];
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    let wall = |(from, to): (&[f32; 2], &[f32; 2])| WallFile {
        from_m: *from,
        to_m: *to,
        height_m: 3.0,
        material: Material::default(),
    };
    ends.map(wall).collect()
}

/// Kinds, sizes, heights, turns and places at random, beside the path on both sides of it.
fn furniture(random: &mut Pcg32) -> Vec<FurnitureFile> {
    let mut all = Vec::new();
    for number in 0..PIECES {
        let mut piece = piece(number, random);
        let reach_m = 0.5 * piece.size_m[0].hypot(piece.size_m[1]);
        for _ in 0..DRAWS {
            let [x_m, y_m] = HALL_M;
            piece.at_m = [random.uniform_between(-x_m, x_m), random.uniform_between(-y_m, y_m)];
            if from_path_m(piece.at_m) > FREE_M + reach_m {
                all.push(piece);
                break;
            }
        }
    }
    all
}

/// How far a place is from the path, metres.
fn from_path_m([x_m, y_m]: [f32; 2]) -> f32 {
    let [corner_x_m, corner_y_m] = CORNERS_M;
    let beside = [(x_m.abs() - corner_x_m), (y_m.abs() - corner_y_m)];
    match beside {
        [x_m, y_m] if x_m > 0.0 && y_m > 0.0 => x_m.hypot(y_m),
        [x_m, y_m] if x_m > 0.0 || y_m > 0.0 => x_m.max(y_m),
        [x_m, y_m] => x_m.abs().min(y_m.abs()),
    }
}

fn piece(number: u32, random: &mut Pcg32) -> FurnitureFile {
    let yaw_deg = random.uniform_between(0.0, 360.0);
    let between = |random: &mut Pcg32, low: f32, high: f32| random.uniform_between(low, high);
    let of = |kind, size_m, height_m| FurnitureFile {
        yaw_deg,
        ..FurnitureFile::new(kind, [0.0, 0.0], (size_m, height_m))
    };
    match number % 10 {
        // Columns, cupboards, cartons, bins.
        0 => of(FurnitureKind::Box, [between(random, 0.3, 0.6); 2], between(random, 1.4, 3.0)),
        1 => of(FurnitureKind::Box, [between(random, 0.4, 1.2), 0.4], between(random, 0.4, 1.9)),
        2 => of(FurnitureKind::Shelf, [between(random, 0.8, 2.0), 0.45], between(random, 1.2, 2.2)),
        3 => of(FurnitureKind::Table, [between(random, 0.7, 1.6), 0.8], between(random, 0.5, 1.1)),
        4 => of(FurnitureKind::Trolley, [0.9, 0.55], 1.0),
        // Poles, plants and signs of the breadth of a person.
        5 => of(FurnitureKind::Post, [between(random, 0.05, 0.15); 2], between(random, 1.0, 2.2)),
        6 => of(FurnitureKind::Post, [between(random, 0.3, 0.5); 2], between(random, 1.3, 1.9)),
        7 => FurnitureFile {
            from_m: between(random, 0.5, 1.0),
            ..of(FurnitureKind::Box, [between(random, 0.8, 2.0), 0.05], between(random, 1.2, 1.8))
        },
        // A stool and a chair: tables of their size.
        8 => of(FurnitureKind::Table, [0.4, 0.4], between(random, 0.45, 0.75)),
        _ => of(FurnitureKind::Box, [between(random, 0.4, 0.55), between(random, 0.25, 0.35)], 1.7),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Point2;

    /// Tabulated exact limits of a Poisson mean: 0 to 3.689, 0.025 to 5.572, 4.795 to 18.39.
    #[test]
    fn intervals_of_rates_equal_the_tables() {
        for (events, low, high) in [(0, 0.0, 3.689), (1, 0.0253, 5.572), (10, 4.795, 18.39)] {
            let (lower, upper) = rate95(events, 1.0);
            assert!((lower - low).abs() < 0.01 && (upper - high).abs() < 0.01, "{events}: {lower} {upper}");
        }
        let (_, upper) = rate95(0, 10.0);
        assert!((upper - 0.3689).abs() < 0.001);
    }

    #[test]
    fn stop_without_need_has_its_own_reason() {
        let seen = |(at_s, cause): (f64, &str)| SeenStop {
            at_s,
            position: Point2::new(1.0, -2.5),
            cause: cause.to_owned(),
            kind: String::new(),
            speed_mps: 0.5,
        };
        let stops = [(12.0, "a box"), (30.0, "a person")].map(seen).to_vec();
        let mut observation = Observation { stops, ..Observation::default() };
        observation.verdict.bodies.nuisance_stops_at_s = vec![30.0];
        assert_eq!(without_need(&observation), ["30.0 s, at 1.00, -2.50 m: a person"]);
    }

    #[test]
    fn furniture_of_every_kind_leaves_the_path_free() {
        for seed in 0..20 {
            let scenario = DrivingPlace::Furniture.scenario(seed);
            let furniture = &scenario.scene.furniture;
            for kind in [
                FurnitureKind::Box,
                FurnitureKind::Shelf,
                FurnitureKind::Table,
                FurnitureKind::Trolley,
                FurnitureKind::Post,
            ] {
                assert!(furniture.iter().any(|piece| piece.kind == kind), "seed {seed}: no {}", kind.name());
            }
            for piece in furniture {
                let reach_m = 0.5 * piece.size_m[0].hypot(piece.size_m[1]);
                assert!(from_path_m(piece.at_m) - reach_m >= FREE_M, "seed {seed}: {piece:?}");
            }
        }
        assert!(DrivingPlace::EmptyHall.scenario(1).scene.furniture.is_empty());
    }
}
