//! Halls in which people walk up to 20 m from the robot, among objects of their size.

use std::fmt::Write as _;

use anyhow::Context as _;
use floorguard_sim::Scenario;
use floorguard_types::random::Pcg32;

/// Half the hall, metres.
const HALF_M: [f32; 2] = [21.0, 14.0];
/// Nobody and nothing is nearer to the walls than this, metres.
const MARGIN_M: f32 = 0.8;
/// Nobody begins and nothing stands nearer to the robot than this, metres.
const CLEAR_M: f32 = 1.8;
const PEOPLE: u32 = 24;
const OBJECTS: u32 = 24;

/// The hall of a seed: bins, posts and pillars, plants, trolleys, tables, and people. One in five of them stands.
///
/// # Errors
/// None in practice: the text is written here.
pub fn hall(seed: u64) -> anyhow::Result<Scenario> {
    let mut random = Pcg32::new(seed, 77);
    let [x, y] = HALF_M;
    let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
    let walls: Vec<String> = (0..4)
        .map(|side| {
            let (from, to): ([f32; 2], [f32; 2]) = (corners[side], corners[(side + 1) % 4]);
            format!("{{ from_m = {from:?}, to_m = {to:?}, height_m = 4.0 }}")
        })
        .collect();
    let objects: Vec<String> = (0..OBJECTS).flat_map(|_| object(&mut random)).collect();
    let mut text = format!(
        "title = \"a hall\"\nstart = {{ at_m = [0.0, 0.0] }}\n[scene]\nwall = [{}]\nfurniture = [{}]\n",
        walls.join(", "),
        objects.join(",\n")
    );
    for _ in 0..PEOPLE {
        text.push_str(&person(&mut random));
    }
    Scenario::from_toml(&text).context("a hall")
}

fn place(random: &mut Pcg32) -> [f32; 2] {
    let mut at = HALF_M;
    for _ in 0..50 {
        at = HALF_M.map(|half| random.uniform_between(MARGIN_M - half, half - MARGIN_M));
        if libm::hypotf(at[0], at[1]) > CLEAR_M {
            break;
        }
    }
    at
}

/// One object, of one block or two.
fn object(random: &mut Pcg32) -> Vec<String> {
    let (at, yaw_deg) = (place(random), random.uniform_between(0.0, 180.0));
    let mut between = |low, high| random.uniform_between(low, high);
    let block = |yaw_deg: f32, size_m: [f32; 2], height_m: f32| {
        format!(
            "{{ kind = \"box\", at_m = {at:?}, yaw_deg = {yaw_deg}, size_m = {size_m:?}, height_m = {height_m} }}"
        )
    };
    match between(0.0, 6.0) as u32 {
        0 | 1 => vec![block(yaw_deg, [between(0.2, 0.9), between(0.2, 0.9)], between(0.6, 2.0))],
        2 => {
            let (side_m, is_pillar, height_m) =
                (between(0.1, 0.7), between(0.0, 1.0) < 0.4, between(0.8, 2.0));
            vec![block(yaw_deg, [side_m, side_m], if is_pillar { 3.0 } else { height_m })]
        }
        3 => vec![
            block(yaw_deg, [between(0.3, 0.7), between(0.3, 0.7)], between(0.3, 1.0)),
            block(yaw_deg + 30.0, [between(0.08, 0.4), between(0.08, 0.4)], between(1.0, 2.0)),
        ],
        4 => vec![format!("{{ kind = \"trolley\", at_m = {at:?}, yaw_deg = {yaw_deg} }}")],
        _ => {
            let (size_m, height_m) = ([between(0.6, 2.0), between(0.5, 1.0)], between(0.5, 1.1));
            vec![format!(
                "{{ kind = \"table\", at_m = {at:?}, yaw_deg = {yaw_deg}, size_m = {size_m:?}, height_m = {height_m} }}"
            )]
        }
    }
}

fn person(random: &mut Pcg32) -> String {
    let at = place(random);
    let goals: Vec<[f32; 2]> = (0..12).map(|_| place(random)).collect();
    let speed_mps = if random.bernoulli(0.2) { 0.0 } else { random.uniform_between(0.6, 1.5) };
    let kind = if random.bernoulli(0.12) { "child" } else { "adult" };
    let mut text = String::new();
    let _infallible = write!(
        text,
        "[[person]]\nkind = \"{kind}\"\nbodies = \"varied\"\nat_m = {at:?}\nspeed_mps = {speed_mps}\ngoals_m = {goals:?}\n"
    );
    text
}
