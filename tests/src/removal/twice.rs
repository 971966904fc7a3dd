//! Buildings that are surveyed twice: people who move, and one who stands through the first survey and is gone in the second.

use floorguard_mapping_host::clean::Track;

use super::building::Building;
use super::chance::Chance;
use super::remove::Surveys;
use super::render::{Drive, Survey};
use super::sim3d::LabelledSweep;
use super::walkers::{Walker, people};

/// A building that is surveyed, and surveyed again on the way back.
pub struct Twice {
    building: Building,
    people: Vec<Walker>,
    drives: [Drive; 2],
    tracks: [Track; 2],
}

impl Twice {
    /// A random building of so many rooms with so many people; half of them walk, the others stand or queue and leave.
    #[must_use]
    pub fn new(seed: u64, rooms: usize, count: usize) -> Self {
        let mut chance = Chance(seed);
        let building = Building::random(&mut chance, rooms);
        let mut route = building.route();
        let first = Drive::new(&route, 0.0);
        route.reverse();
        let second = Drive::new(&route, first.end_s() + 0.5);
        let people = people(&building, count, second.end_s(), &mut chance);
        Self::of(building, people, [first, second])
    }

    /// A short stretch of corridor, driven twice; a person stands in it all through the first survey only.
    #[must_use]
    pub fn left_between() -> Self {
        let building = Building::random(&mut Chance(1), 1);
        let first = Drive::new(&[[1.0, 0.0], [2.0, 0.0]], 0.0);
        let second = Drive::new(&[[1.0, 0.0], [2.0, 0.0]], first.end_s() + 60.0);
        let stands_s = first.end_s() + 1.0;
        let person = Walker { course: vec![[-1.0, 4.2, 0.5], [stands_s, 4.2, 0.5]], height_m: 1.75 };
        Self::of(building, vec![person], [first, second])
    }

    fn of(building: Building, people: Vec<Walker>, drives: [Drive; 2]) -> Self {
        let tracks = [drives[0].track(), drives[1].track()];
        Self { building, people, drives, tracks }
    }
}

impl Surveys for Twice {
    fn for_each(&self, each: &mut dyn FnMut(&LabelledSweep, &Track)) -> anyhow::Result<()> {
        for (number, (drive, track)) in self.drives.iter().zip(&self.tracks).enumerate() {
            let survey = Survey { building: &self.building, people: &self.people, drive };
            survey.for_each(number as u64 + 1, |labelled| each(labelled, track));
        }
        Ok(())
    }
}
