//! Scenes to learn from: rooms full of objects, and people of every kind.
//!
//! Written as scenario text, so that any of them can be examined with `floorguard simulate`.

use std::fmt::Write as _;

use floorguard_sim::Scenario;
use floorguard_types::random::Pcg32;

use super::simulated::SceneRun;

/// Nothing stands nearer to the robot than this, metres.
const CLEAR_M: f32 = 1.8;
const KINDS: [(&str, u32); 6] =
    [("adult", 66), ("child", 8), ("wheelchair", 5), ("crouching", 3), ("trolley", 8), ("luggage", 10)];

/// Random rooms, one a seed.
#[must_use]
pub fn random_scenes(first_seed: u64, count: u64) -> Vec<SceneRun> {
    (first_seed..first_seed + count).filter_map(random_scene).collect()
}

/// The built-in scenarios, seen from random places on the robot's path.
#[must_use]
pub fn built_in_scenes(first_seed: u64, count: u64) -> Vec<SceneRun> {
    let names = ["supermarket", "airport", "warehouse", "corridor"];
    (first_seed..first_seed + count)
        .filter_map(|seed| {
            let mut random = Pcg32::new(seed, 31);
            let mut scenario = Scenario::named(names[seed as usize % names.len()]).ok()?;
            let path = &scenario.route.waypoints_m;
            let from = path[random.below(path.len() as u32) as usize];
            let to = path[random.below(path.len() as u32) as usize];
            let share = random.uniform();
            scenario.start.at_m = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            scenario.start.yaw_deg = random.uniform_between(0.0, 360.0);
            Some(run(scenario, seed, &mut random))
        })
        .collect()
}

/// The world is played a little larger or smaller than life: people of 1.5 to 1.95 m.
fn run(scenario: Scenario, seed: u64, random: &mut Pcg32) -> SceneRun {
    SceneRun {
        scenario,
        seed,
        scale: random.uniform_between(0.86, 1.12),
        sensor_height_m: random.uniform_between(0.5, 1.2),
        starts_us: 200_000 + 1_000 * u64::from(random.below(3_000)),
    }
}

fn random_scene(seed: u64) -> Option<SceneRun> {
    let mut random = Pcg32::new(seed, 30);
    let half = [random.uniform_between(4.0, 15.0), random.uniform_between(3.0, 13.0)];
    let mut text = String::from("title = \"a room\"\n[scene]\n");
    let high = random.uniform_between(2.2, 4.0);
    let corners = [[-half[0], -half[1]], [half[0], -half[1]], [half[0], half[1]], [-half[0], half[1]]];
    let walls = (0..4).map(|side| {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        format!("{{ from_m = {from:?}, to_m = {to:?}, height_m = {high} }}")
    });
    let _ = writeln!(text, "wall = [{}]", walls.collect::<Vec<_>>().join(", "));
    let count = 16 + random.below(22);
    let pieces: Vec<String> = (0..count).flat_map(|_| furniture(half, &mut random)).collect();
    let _ = writeln!(text, "furniture = [{}]", pieces.join(",\n"));
    for _ in 0..4 + random.below(9) {
        text.push_str(&person(half, &mut random));
    }
    let scenario = Scenario::from_toml(&text).ok()?;
    Some(run(scenario, seed, &mut random))
}

/// A place in the room that is not on top of the robot.
fn place(half: [f32; 2], random: &mut Pcg32) -> [f32; 2] {
    let mut at = [0.0; 2];
    for _ in 0..20 {
        at = [
            random.uniform_between(0.3 - half[0], half[0] - 0.3),
            random.uniform_between(0.3 - half[1], half[1] - 0.3),
        ];
        if libm::hypotf(at[0], at[1]) > CLEAR_M {
            return at;
        }
    }
    [half[0] - 0.5, at[1]]
}

/// One piece, or a few that make one object.
fn furniture(half: [f32; 2], random: &mut Pcg32) -> Vec<String> {
    let at = place(half, random);
    let yaw = random.uniform_between(0.0, 180.0);
    let mut between = |low, high| random.uniform_between(low, high);
    let block = |at: [f32; 2], yaw: f32, size: [f32; 2], height: f32| {
        format!(
            "{{ kind = \"box\", at_m = {at:?}, yaw_deg = {yaw}, size_m = {size:?}, height_m = {height} }}"
        )
    };
    let (a, b) = (between(0.0, 1.0), between(0.8, 2.0));
    match (between(0.0, 13.0)) as u32 {
        // A bin, a kiosk, a display, a parcel.
        0 | 1 => vec![block(at, yaw, [between(0.2, 0.9), between(0.2, 0.9)], between(0.6, 2.0))],
        // A post or half a pillar; two blocks across are nearly round.
        2 => {
            let side = between(0.1, 0.7);
            let height = if a < 0.4 { 3.0 } else { b };
            vec![block(at, yaw, [side, side], height), block(at, yaw + 45.0, [side, side], height)]
        }
        // A sign, a partition, a door leaf.
        3 => vec![block(at, yaw, [between(0.04, 0.15), between(0.3, 1.0)], between(0.9, 2.1))],
        // A chair: seat on legs with a back.
        4 | 5 => {
            let (sin, cos) = libm::sincosf(yaw.to_radians());
            let back = [at[0] - 0.2 * cos, at[1] - 0.2 * sin];
            let height = between(0.75, 1.25);
            vec![
                format!(
                    "{{ kind = \"table\", at_m = {at:?}, yaw_deg = {yaw}, size_m = [0.45, 0.45], height_m = 0.45 }}"
                ),
                block(back, yaw, [0.06, between(0.35, 0.5)], height),
            ]
        }
        // A plant, a lamp, a machine: a broad foot and a narrower body, or the other way round by the height.
        6 => vec![
            block(at, yaw, [between(0.3, 0.7), between(0.3, 0.7)], between(0.3, 1.0)),
            block(at, yaw + between(0.0, 90.0), [between(0.08, 0.4), between(0.08, 0.4)], between(1.0, 2.0)),
        ],
        // Objects left standing together.
        7..=9 => {
            let count = 2 + (3.9 * a) as usize;
            let mut some = || {
                let place = [at[0] + between(-0.3, 0.3), at[1] + between(-0.3, 0.3)];
                let size = [between(0.05, 0.5), between(0.05, 0.5)];
                block(place, between(0.0, 90.0), size, between(0.3, 1.3))
            };
            (0..count).map(|_| some()).collect()
        }
        10 => vec![format!(
            "{{ kind = \"shelf\", at_m = {at:?}, yaw_deg = {yaw}, size_m = [{}, {}], height_m = {b} }}",
            between(0.5, 3.0),
            between(0.3, 0.7)
        )],
        11 => vec![format!(
            "{{ kind = \"table\", at_m = {at:?}, yaw_deg = {yaw}, size_m = [{}, {}], height_m = {} }}",
            between(0.6, 2.0),
            between(0.5, 1.0),
            between(0.5, 1.1)
        )],
        _ => vec![format!("{{ kind = \"trolley\", at_m = {at:?}, yaw_deg = {yaw} }}")],
    }
}

fn person(half: [f32; 2], random: &mut Pcg32) -> String {
    let mut draw = random.below(KINDS.iter().map(|(_, weight)| weight).sum());
    let kind = KINDS.iter().find(|(_, weight)| {
        let here = draw < *weight;
        draw = draw.saturating_sub(*weight);
        here
    });
    let name = kind.map_or("adult", |(name, _)| name);
    let (at, goal) = (place(half, random), place(half, random));
    let walks = name != "crouching" && random.bernoulli(0.6);
    let speed = if walks { random.uniform_between(0.4, 1.7) } else { 0.0 };
    format!(
        "[[person]]\nkind = \"{name}\"\nat_m = {at:?}\nspeed_mps = {speed}\ngoals_m = [{goal:?}, {at:?}]\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_gives_a_repeatable_scene() {
        let (once, again) = (random_scenes(1, 50), random_scenes(1, 50));
        assert_eq!(once.len(), 50);
        for (a, b) in once.iter().zip(&again) {
            assert_eq!(format!("{:?}", a.scenario), format!("{:?}", b.scenario));
        }
        assert_eq!(built_in_scenes(1, 8).len(), 8);
    }
}
