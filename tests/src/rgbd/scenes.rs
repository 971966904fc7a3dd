//! Rooms before a forward depth camera: people of every kind at every distance, and objects.

use floorguard_sim::people::{Build, Person, PersonKind};
use floorguard_sim::scene::{Material, Scene, SceneBuilder};
use floorguard_sim::sensors::DepthCamera;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

/// Nearest and farthest place of a person, metres from the camera.
const RANGES_M: [f32; 2] = [1.0, 6.8];
/// Half of the angle in which people stand, radians: a little more than the camera sees.
const HALF_VIEW_RAD: f32 = 0.5;
/// People do not stand nearer to each other, to objects, metres.
const APART_M: [f32; 2] = [0.6, 0.35];
const KINDS: [(PersonKind, u32); 5] = [
    (PersonKind::Adult, 70),
    (PersonKind::Child, 8),
    (PersonKind::Trolley, 8),
    (PersonKind::Luggage, 8),
    (PersonKind::Wheelchair, 6),
];

/// A room, who is in it, and where the robot stands.
pub struct RgbdScene {
    /// What stands still.
    pub scene: Scene,
    /// Everybody.
    pub people: Vec<Person>,
    /// World frame.
    pub robot: Pose2,
    /// With its scale: people of 1.55 to 1.95 m.
    pub camera: DepthCamera,
    /// For the noise.
    pub seed: u64,
}

/// The room of a seed, seen by a camera of this kind.
#[must_use]
pub fn room(seed: u64, camera: DepthCamera) -> RgbdScene {
    let mut random = Pcg32::new(seed, 40);
    let mut builder = SceneBuilder::default();
    let ahead = random.uniform_between(4.0, 12.0);
    let aside = random.uniform_between(2.0, 8.0);
    let high = random.uniform_between(2.3, 4.0);
    let corners = [[-2.0, -aside], [ahead, -aside], [ahead, aside], [-2.0, aside]];
    for side in 0..4 {
        builder.wall(corners[side], corners[(side + 1) % 4], high, Material::Matte);
    }
    for _ in 0..3 + random.below(9) {
        furniture(&mut builder, (ahead, aside), &mut random);
    }
    let scene = builder.build();
    let robot = Pose2::new(-camera.forward_m / camera.scale, 0.0, random.uniform_between(-0.3, 0.3));
    let camera = DepthCamera { scale: random.uniform_between(0.89, 1.11), ..camera };
    let mut people: Vec<Person> = Vec::new();
    let wanted = random.below(6);
    for _ in 0..40 {
        if people.len() as u32 >= wanted {
            break;
        }
        let person = person(people.len() as u32 + 1, robot, &mut random);
        let alone = people.iter().all(|other| other.position.distance(person.position) > APART_M[0]);
        let clear = scene.nearest_obstacle(person.position).is_none_or(|(_, gap_m)| gap_m > APART_M[1]);
        let inside = person.position.x_m < ahead - 0.3 && person.position.y_m.abs() < aside - 0.3;
        if alone && clear && inside {
            people.push(person);
        }
    }
    RgbdScene { scene, people, robot, camera, seed }
}

fn person(id: u32, robot: Pose2, random: &mut Pcg32) -> Person {
    let range_m = random.uniform_between(RANGES_M[0], RANGES_M[1]);
    let bearing = random.uniform_between(-HALF_VIEW_RAD, HALF_VIEW_RAD);
    // The camera is at the world's origin, whatever the robot's heading.
    let (sin, cos) = libm::sincosf(robot.heading_rad + bearing);
    let mut draw = random.below(KINDS.iter().map(|(_, weight)| weight).sum());
    let kind = KINDS.iter().find(|(_, weight)| {
        let here = draw < *weight;
        draw = draw.saturating_sub(*weight);
        here
    });
    let heading_rad = random.uniform_between(0.0, core::f32::consts::TAU);
    let speed_mps = if random.bernoulli(0.6) { random.uniform_between(0.3, 1.6) } else { 0.0 };
    let (heading_sin, heading_cos) = libm::sincosf(heading_rad);
    Person {
        id,
        kind: kind.map_or(PersonKind::Adult, |(kind, _)| *kind),
        build: Build::SAME,
        position: Point2::new(range_m * cos, range_m * sin),
        velocity: Point2::new(speed_mps * heading_cos, speed_mps * heading_sin),
        heading_rad,
        gait_rad: random.uniform_between(0.0, core::f32::consts::TAU),
        goals: Vec::new(),
        goal: 0,
        speed_mps,
        starts_us: 0,
        sees_robot: false,
        walk: None,
    }
}

/// One piece that is nobody: shelves, chairs, tables, pillars, signs, plants, trolleys, cartons.
fn furniture(builder: &mut SceneBuilder, (ahead, aside): (f32, f32), random: &mut Pcg32) {
    let mut between = |low, high| random.uniform_between(low, high);
    let place = (between(1.3, ahead - 0.3), between(-aside, aside) * 0.9, between(0.0, 3.1));
    let (x, y, yaw) = place;
    match between(0.0, 9.0) as u32 {
        0 => builder.shelf(place, (between(0.6, 3.0), between(0.3, 0.6)), between(1.0, 2.4)),
        1 => builder.table(place, (between(0.6, 1.8), between(0.5, 0.9)), between(0.5, 1.1)),
        2 => builder.trolley(place),
        // A chair with something over its back.
        3 | 4 => {
            builder.table(place, (0.45, 0.45), 0.45);
            let (sin, cos) = libm::sincosf(yaw);
            let back = (x - 0.2 * cos, y - 0.2 * sin, yaw);
            builder.cuboid(back, (0.1, between(0.38, 0.5)), (0.45, between(0.85, 1.3)), Material::Matte);
        }
        // A pillar, or a post with a head.
        5 => {
            let side = between(0.1, 0.5);
            builder.cuboid(place, (side, side), (0.0, between(1.0, 2.3)), Material::Matte);
        }
        // A sign on a foot.
        6 => {
            builder.cuboid(place, (0.08, 0.08), (0.0, 1.0), Material::Matte);
            builder.cuboid(place, (0.05, between(0.3, 0.6)), (1.0, between(1.3, 1.9)), Material::Matte);
        }
        // A plant: a pot, a stem, a crown.
        7 => {
            let (pot, crown) = (between(0.3, 0.5), between(0.3, 0.7));
            builder.cuboid(place, (pot, pot), (0.0, 0.45), Material::Matte);
            builder.cuboid((x, y, yaw + 0.5), (crown, crown), (0.7, between(1.2, 2.0)), Material::Matte);
        }
        // Cartons on each other.
        _ => {
            let (low, wide) = (between(0.3, 0.9), between(0.3, 0.8));
            builder.cuboid(place, (wide, wide), (0.0, low), Material::Matte);
            let upper = (x + between(-0.1, 0.1), y + between(-0.1, 0.1), yaw + between(-0.4, 0.4));
            builder.cuboid(upper, (wide * 0.7, wide * 0.7), (low, low + between(0.2, 0.9)), Material::Matte);
        }
    }
}
