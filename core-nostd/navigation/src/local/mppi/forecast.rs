//! Where the people near the robot will be at every step.

use floorguard_types::geometry::Point2;
use floorguard_types::motion::MovingPerson;
use floorguard_types::number::nearest_f32;

use super::config::MPPI_STEPS;

/// People that count; the nearest ones.
const PEOPLE_MAX: usize = 16;

/// A person's place at one step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    pub(super) middle: Point2,
    pub(super) deviation_m: f32,
}

/// Places by person and step.
pub(super) struct Forecast {
    people: heapless::Vec<[Place; MPPI_STEPS], PEOPLE_MAX>,
}

impl Forecast {
    /// The nearest people at every step. Those whose numbers are not legal count as standing where they were last, with a doubt
    /// of a metre, if even that is known.
    pub(super) fn new(
        people: &[MovingPerson],
        here: Point2,
        (step_s, acceleration_mps2): (f32, f32),
    ) -> Self {
        let mut nearest: heapless::Vec<(f32, MovingPerson), PEOPLE_MAX> = heapless::Vec::new();
        for person in people {
            let distance_m = person.position_in_map.distance(here);
            if !distance_m.is_finite() {
                continue;
            }
            let known = if person.is_legal() {
                *person
            } else {
                MovingPerson {
                    position_in_map: person.position_in_map,
                    position_deviation_m: 1.0,
                    ..MovingPerson::default()
                }
            };
            if nearest.is_full() {
                let farthest = nearest.iter_mut().max_by(|a, b| a.0.total_cmp(&b.0));
                if let Some(farthest) = farthest.filter(|farthest| farthest.0 > distance_m) {
                    *farthest = (distance_m, known);
                }
            } else {
                // It fits.
                let _ = nearest.push((distance_m, known));
            }
        }
        let places = nearest.iter().map(|(_, person)| {
            core::array::from_fn(|step| {
                let then = person.after((nearest_f32(step) + 1.0) * step_s, acceleration_mps2);
                Place { middle: then.position_in_map, deviation_m: then.position_deviation_m }
            })
        });
        Self { people: places.collect() }
    }

    /// Everybody's place at a step.
    #[inline]
    pub(super) fn at(&self, step: usize) -> impl Iterator<Item = Place> + '_ {
        self.people.iter().filter_map(move |places| places.get(step).copied())
    }
}
