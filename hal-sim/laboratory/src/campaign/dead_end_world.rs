//! Buildings in which a drive to a goal can get stuck: aisles that end at a wall, trolleys that are left in them, doors that shut
//! while the robot drives. What is left and what shuts is on no map.

use floorguard_sim::scenario::{PersonFile, Scenario, StartFile};
use floorguard_sim::scene::{FurnitureFile, FurnitureKind, Material, Scene, SceneFile, WallFile};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

/// Length and width of the building, metres; a wall with two doors stands across its middle.
const HALL_M: [f32; 2] = [20.0, 12.0];
const MIDDLE_M: f32 = 10.0;
/// So wide is a door, metres, from and to.
const DOOR_M: [f32; 2] = [1.5, 2.2];
/// So far from everything the body turns on the spot, metres: the robot begins with no more room than that, as one that was parked.
const PARKED_M: f32 = 1.2;
/// The goal has room for what a guard keeps clear before a robot that turns, metres.
const TURNS_M: f32 = 1.6;
/// At least so far from start to goal, metres.
const APART_M: f32 = 6.0;
/// Draws for a place before the world does without it.
const DRAWS: u32 = 200;
const STREAM: u64 = 83;

/// A building, and where the robot is sent in it.
#[derive(Clone, Debug)]
pub struct DeadEndWorld {
    /// Start, walls, what is left, doors that shut, and people.
    pub scenario: Scenario,
    /// Goal, world frame.
    pub goal: Pose2,
}

impl DeadEndWorld {
    /// The building of a seed.
    #[must_use]
    pub fn drawn(seed: u64) -> Self {
        let mut random = Pcg32::new(seed, STREAM);
        let doors = [2.0, 6.5].map(|low_m| {
            let width_m = random.uniform_between(DOOR_M[0], DOOR_M[1]);
            [random.uniform_between(low_m, low_m + 2.5), width_m]
        });
        let mut scene = SceneFile { wall: walls(&doors), ..SceneFile::default() };
        for half in [[0.0, MIDDLE_M], [MIDDLE_M, HALL_M[0]]] {
            scene.furniture.extend(shelves(half, &mut random));
        }
        let mapped = scene.build();
        let start = turning_place(&mapped, &mut random, (PARKED_M, |place: Point2| place.x_m < MIDDLE_M));
        let far = |place: Point2| place.distance(Point2::new(start.x_m, start.y_m)) > APART_M;
        let goal = turning_place(&mapped, &mut random, (TURNS_M, far));
        let ends = [(start, PARKED_M), (goal, TURNS_M)];
        let ends = ends.map(|(pose, room_m)| (Point2::new(pose.x_m, pose.y_m), room_m));
        for _ in 0..1 + random.below(4) {
            scene.furniture.extend(left_behind((&mapped, &ends), &mut random));
        }
        for door in doors {
            if random.bernoulli(0.35) {
                scene.furniture.push(shut(door, random.uniform_between(2.0, 45.0)));
            }
        }
        let person: Vec<PersonFile> = (0..random.below(3)).map(|_| walker(&mapped, &mut random)).collect();
        let scenario = Scenario {
            title: "a building with dead ends, and what is left in it".to_owned(),
            start: StartFile { at_m: [start.x_m, start.y_m], yaw_deg: start.heading_rad.to_degrees() },
            scene,
            person,
            attentive: true,
            ..Scenario::default()
        };
        Self { scenario, goal }
    }
}

fn walls(doors: &[[f32; 2]; 2]) -> Vec<WallFile> {
    let [x_m, y_m] = HALL_M;
    let wall = |from_m, to_m| WallFile { from_m, to_m, height_m: 3.0, material: Material::default() };
    let mut walls = vec![
        wall([0.0, 0.0], [x_m, 0.0]),
        wall([x_m, 0.0], [x_m, y_m]),
        wall([x_m, y_m], [0.0, y_m]),
        wall([0.0, y_m], [0.0, 0.0]),
    ];
    let mut from_m = 0.0;
    for [at_m, width_m] in doors {
        walls.push(wall([MIDDLE_M, from_m], [MIDDLE_M, at_m - width_m / 2.0]));
        from_m = at_m + width_m / 2.0;
    }
    walls.push(wall([MIDDLE_M, from_m], [MIDDLE_M, y_m]));
    walls
}

/// Two rows in a half of the building; in half of the cases a row ends at a wall, and the aisle beside it there.
fn shelves([from_m, to_m]: [f32; 2], random: &mut Pcg32) -> Vec<FurnitureFile> {
    let mut rows = Vec::new();
    for middle_m in [4.0, 8.0] {
        let mut ends = [from_m + random.uniform_between(2.4, 3.2), to_m - random.uniform_between(2.4, 3.2)];
        if random.bernoulli(0.5) {
            let at_wall = random.below(2) as usize;
            ends[at_wall] = [from_m, to_m][at_wall];
        }
        let at_m = [f32::midpoint(ends[0], ends[1]), middle_m + random.uniform_between(-0.3, 0.3)];
        let size_m = [ends[1] - ends[0], random.uniform_between(0.5, 0.9)];
        rows.push(FurnitureFile::new(FurnitureKind::Shelf, at_m, (size_m, random.uniform_between(1.2, 2.2))));
    }
    rows
}

/// A trolley, a carton, a table or a pallet somewhere on free floor, not where the robot begins or ends.
fn left_behind((mapped, ends): (&Scene, &[(Point2, f32); 2]), random: &mut Pcg32) -> Option<FurnitureFile> {
    let (kind, size_m, height_m) = match random.below(4) {
        0 => (FurnitureKind::Trolley, [0.9, 0.55], 1.0),
        1 => (FurnitureKind::Table, [random.uniform_between(0.8, 1.6), 0.8], 0.75),
        2 => (FurnitureKind::Box, [1.2, 0.8], random.uniform_between(0.3, 1.5)),
        _ => (FurnitureKind::Box, [random.uniform_between(0.4, 1.0); 2], random.uniform_between(0.4, 1.9)),
    };
    let mut piece = FurnitureFile {
        yaw_deg: random.uniform_between(0.0, 360.0),
        appears_s: Some(0.0),
        ..FurnitureFile::new(kind, [0.0, 0.0], (size_m, height_m))
    };
    let reach_m = piece.reach_m();
    let fits = |place: Point2| ends.iter().all(|(end, room_m)| end.distance(place) > room_m + reach_m);
    let place = free_place(mapped, random, (0.5 * reach_m, fits))?;
    piece.at_m = [place.x_m, place.y_m];
    Some(piece)
}

fn shut([at_m, width_m]: [f32; 2], appears_s: f32) -> FurnitureFile {
    let leaf = FurnitureFile::new(FurnitureKind::Box, [MIDDLE_M, at_m], ([0.08, width_m], 2.1));
    FurnitureFile { appears_s: Some(appears_s), ..leaf }
}

fn walker(mapped: &Scene, random: &mut Pcg32) -> PersonFile {
    let mut place = || free_place(mapped, random, (0.5, |_| true)).map_or([1.0, 1.0], |at| [at.x_m, at.y_m]);
    let (at_m, goals_m) = (place(), vec![place(), place(), place()]);
    PersonFile {
        at_m,
        goals_m,
        speed_mps: random.uniform_between(0.7, 1.3),
        sees_robot: true,
        ..PersonFile::default()
    }
}

/// Where the robot has room, in any of eight headings.
fn turning_place(
    mapped: &Scene,
    random: &mut Pcg32,
    (room_m, is_wanted): (f32, impl Fn(Point2) -> bool),
) -> Pose2 {
    let place = free_place(mapped, random, (room_m, is_wanted)).unwrap_or(Point2::new(1.7, 1.7));
    let heading_rad = random.below(8) as f32 * std::f32::consts::FRAC_PI_4;
    Pose2::new(place.x_m, place.y_m, floorguard_types::geometry::wrap_angle(heading_rad))
}

fn free_place(
    mapped: &Scene,
    random: &mut Pcg32,
    (clear_m, is_wanted): (f32, impl Fn(Point2) -> bool),
) -> Option<Point2> {
    let [x_m, y_m] = HALL_M;
    (0..DRAWS).map(|_| Point2::new(random.uniform_between(0.0, x_m), random.uniform_between(0.0, y_m))).find(
        |place| {
            is_wanted(*place) && mapped.nearest_obstacle(*place).is_none_or(|(_, gap_m)| gap_m >= clear_m)
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buildings_have_dead_ends_doors_and_left_things() {
        let worlds: Vec<DeadEndWorld> = (1..=40).map(DeadEndWorld::drawn).collect();
        let later = |world: &DeadEndWorld, late: bool| {
            let pieces = world.scenario.scene.furniture.iter();
            pieces.filter_map(|piece| piece.appears_s).filter(|from_s| (*from_s > 0.0) == late).count()
        };
        for (world, seed) in worlds.iter().zip(1..) {
            let mapped = world.scenario.scene.build();
            for (pose, room_m) in [(world.scenario.start_pose(), PARKED_M), (world.goal, TURNS_M)] {
                let (_, gap_m) = mapped.nearest_obstacle(Point2::new(pose.x_m, pose.y_m)).unwrap();
                assert!(gap_m >= room_m, "seed {seed}: {pose:?}, {gap_m} m");
            }
            assert!(later(world, false) > 0, "seed {seed}: nothing is left");
        }
        let shut = |count: usize| worlds.iter().filter(|world| later(world, true) == count).count();
        assert!(shut(0) > 5 && shut(1) > 5 && shut(2) > 0, "{} {} {}", shut(0), shut(1), shut(2));
    }
}
