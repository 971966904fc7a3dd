//! People of a simulated building: walkers, standing groups that leave, and queues. Where each is at every time is fixed.

use super::building::Building;
use super::chance::Chance;

/// A person: places at times, straight lines between; not there before the first and after the last.
#[derive(Clone, Debug, Default)]
pub struct Walker {
    /// Time in seconds, x and y in metres, ordered by time.
    pub course: Vec<[f32; 3]>,
    /// Height, metres.
    pub height_m: f32,
}

impl Walker {
    /// Where the person is.
    #[must_use]
    pub fn at(&self, time_s: f32) -> Option<[f32; 2]> {
        let pair = self.course.windows(2).find(|pair| (pair[0][0]..=pair[1][0]).contains(&time_s))?;
        let share = (time_s - pair[0][0]) / (pair[1][0] - pair[0][0]).max(1.0e-6);
        Some([1, 2].map(|axis| pair[0][axis] + share * (pair[1][axis] - pair[0][axis])))
    }

    fn new(chance: &mut Chance, start: [f32; 3]) -> Self {
        Self { course: vec![start], height_m: chance.between(1.5, 1.9) }
    }

    fn stay(&mut self, seconds: f32) {
        let [time_s, x, y] = self.course[self.course.len() - 1];
        self.course.push([time_s + seconds, x, y]);
    }

    fn walk(&mut self, [x, y]: [f32; 2], speed_mps: f32) {
        let [time_s, from_x, from_y] = self.course[self.course.len() - 1];
        let distance_m = ((x - from_x).powi(2) + (y - from_y).powi(2)).sqrt();
        self.course.push([time_s + distance_m / speed_mps, x, y]);
    }

    /// To the end of the corridor, by the door of the room if it stands in one, and away.
    fn leave(&mut self, building: &Building) {
        let [_, x, y] = self.course[self.course.len() - 1];
        let door_m =
            building.rooms.iter().map(|room| room[0]).min_by(|a, b| (a - x).abs().total_cmp(&(b - x).abs()));
        if y.abs() > 1.0 {
            self.walk([door_m.unwrap_or(x), y], 1.1);
            self.walk([door_m.unwrap_or(x), 0.0], 1.1);
        }
        self.walk([building.length_m - 0.5, 0.3], 1.1);
    }
}

/// As many people as given: about half walk all the time, the others stand in groups or queue and leave before the last third.
#[must_use]
pub fn people(building: &Building, count: usize, duration_s: f32, chance: &mut Chance) -> Vec<Walker> {
    let walkers = count.div_ceil(2);
    let mut all: Vec<Walker> = (0..walkers).map(|_| walker(building, duration_s, chance)).collect();
    let standing = count - walkers;
    if chance.below(2) == 0 {
        all.extend((0..standing).map(|place| queued(building, place, chance)));
    } else {
        let room = building.rooms[chance.below(building.rooms.len())];
        let leaves_s = duration_s * chance.between(0.3, 0.6);
        all.extend((0..standing).map(|place| grouped(building, room, place, leaves_s, chance)));
    }
    all
}

fn walker(building: &Building, duration_s: f32, chance: &mut Chance) -> Walker {
    let mut person = Walker::new(chance, [0.0, chance.clone().between(1.0, building.length_m - 1.0), 0.4]);
    let speed_mps = chance.between(0.7, 1.4);
    while person.course[person.course.len() - 1][0] < duration_s {
        let across = chance.between(-0.7, 0.7);
        if chance.below(2) == 0 {
            person.walk([chance.between(0.6, building.length_m - 0.6), across], speed_mps);
            continue;
        }
        let [x, y] = building.rooms[chance.below(building.rooms.len())];
        person.walk([x, 0.0], speed_mps);
        person.walk([x, y], speed_mps);
        person.stay(chance.between(0.0, 6.0));
        person.walk([x, 0.0], speed_mps);
    }
    person
}

/// Stands somewhere in a room or in the corridor until a time, and leaves by the corridor.
#[must_use]
pub fn standing(building: &Building, leaves_s: f32, chance: &mut Chance) -> Walker {
    let [x, y] = building.rooms[chance.below(building.rooms.len())];
    let place = if chance.below(3) == 0 {
        [chance.between(1.5, building.length_m - 1.5), 0.7]
    } else {
        [x + chance.between(-1.2, 1.2), y + chance.between(0.3, 1.0) * y.signum()]
    };
    let mut person = Walker::new(chance, [-1.0, place[0], place[1]]);
    person.stay(leaves_s + 1.0);
    person.leave(building);
    person
}

/// A place in a ring of people who talk.
fn grouped(building: &Building, room: [f32; 2], place: usize, leaves_s: f32, chance: &mut Chance) -> Walker {
    let (sin, cos) = (1.3 * place as f32).sin_cos();
    let mut person = Walker::new(chance, [0.0, room[0] + 0.8 * cos, room[1] + 0.8 * sin]);
    person.stay(leaves_s + 2.0 * place as f32);
    person.leave(building);
    person
}

/// A place in a line along the corridor, which moves up every eight seconds.
fn queued(building: &Building, place: usize, chance: &mut Chance) -> Walker {
    let head_m = 0.5 * building.length_m;
    let mut person = Walker::new(chance, [0.0, head_m - 0.7 * place as f32, 0.75]);
    for step in (0..place).rev() {
        person.stay(8.0);
        person.walk([head_m - 0.7 * step as f32, 0.75], 0.7);
    }
    person.stay(8.0);
    person.leave(building);
    person
}
