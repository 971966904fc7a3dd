//! From tracks to advice: the nearest people in the robot's frame.

use floorguard_guard::{ADVISED_PEOPLE_MAX, Advice, AdvisedPerson};
use floorguard_perception::people::{Explanation, Track, TrackStatus};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

use super::moved_along::moves_along;

/// A confirmed track counts as a person from this probability on.
pub const PERSON_PROBABILITY_MIN: f32 = 0.5;

/// What more probably moves than not is taken for a person too, whatever its shape: motion only ever adds to the advice.
pub const MOVING_PROBABILITY_MIN: f32 = 0.5;

/// The advice of one sweep. Tracks beyond the capacity are the farthest ones; the guard's own sensors see those near.
///
/// `learned` is what the robot has learned itself about a track: it can add a person to those that the shipped
/// classifier and the motion tell of, and takes none away. So does what moves along with one of these (FG-REQ-087). An added person
/// replaces no other one, even if that one is farther away.
pub fn advice(
    stamp: Stamp,
    tracks: &[Track],
    base_in_odom: Pose2,
    learned: impl Fn(&Track) -> Option<f32>,
) -> Advice {
    let mut advice = Advice { stamp, ..Advice::default() };
    let to_robot = base_in_odom.inverse();
    let confirmed = || tracks.iter().filter(|track| track.status == TrackStatus::Confirmed);
    for track in confirmed().filter(|track| is_reported(track)) {
        insert_by_distance(&mut advice.people, advised(track, to_robot));
    }
    let is_learned = |track: &Track| learned(track).is_some_and(|known| known >= PERSON_PROBABILITY_MIN);
    let is_moved_along = |track: &Track| {
        let people = || confirmed().filter(|person| is_reported(person));
        people().any(|person| moves_along(track, person, stamp))
    };
    for track in
        confirmed().filter(|track| !is_reported(track) && (is_learned(track) || is_moved_along(track)))
    {
        if !advice.people.is_full() {
            insert_by_distance(&mut advice.people, advised(track, to_robot));
        }
    }
    advice
}

/// Without anything learned. Only a positive explanation takes a person away: standing still, or an unlikely
/// shape, does not.
fn is_reported(track: &Track) -> bool {
    let is_object = track.explanation.is_some_and(Explanation::is_positive);
    track.person_probability >= PERSON_PROBABILITY_MIN && !is_object
        || track.moving_probability >= MOVING_PROBABILITY_MIN
}

fn advised(track: &Track, to_robot: Pose2) -> AdvisedPerson {
    AdvisedPerson {
        id: track.id,
        position: to_robot.transform(track.state.position),
        velocity_mps: turned(to_robot, track.state.velocity),
        position_sigma_m: libm::sqrtf(track.state.position_variance.max(0.0)),
        velocity_sigma_mps: libm::sqrtf(track.state.velocity_variance.max(0.0)),
    }
}

fn turned(frame: Pose2, vector: Point2) -> Point2 {
    Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: frame.heading_rad }.transform(vector)
}

/// Keeps the list sorted, nearest first; the farthest falls off the end.
fn insert_by_distance(people: &mut heapless::Vec<AdvisedPerson, ADVISED_PEOPLE_MAX>, person: AdvisedPerson) {
    let distance_m = person.position.norm();
    let place = people.iter().position(|other| other.position.norm() > distance_m).unwrap_or(people.len());
    if people.is_full() {
        if place == people.len() {
            return;
        }
        people.pop();
    }
    // The list is not full now, and the place is within it.
    let _ = people.insert(place, person);
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_perception::people::{Detection, Tracker, TrackerParameters};

    #[test]
    fn the_farthest_fall_off_the_end() {
        let mut people = heapless::Vec::new();
        for index in 0..100_u32 {
            let x_m = ((index * 37) % 100) as f32;
            let person =
                AdvisedPerson { id: index, position: Point2::new(x_m, 0.0), ..AdvisedPerson::default() };
            insert_by_distance(&mut people, person);
        }
        let distances: std::vec::Vec<f32> = people.iter().map(|person| person.position.x_m).collect();
        let expected: std::vec::Vec<f32> = (0..ADVISED_PEOPLE_MAX).map(|index| index as f32).collect();
        assert_eq!(distances, expected);
    }

    /// Sixty objects that stand, of which the shipped classifier calls about half people.
    fn crowd() -> std::boxed::Box<Tracker> {
        let mut tracker = std::boxed::Box::new(Tracker::new(TrackerParameters::DEFAULT));
        for sweep in 1..=12_u64 {
            let sightings: std::vec::Vec<Detection> = (0..60_u16)
                .map(|index| {
                    let place = Point2::new(1.5 * f32::from(index % 10), 1.5 * f32::from(index / 10));
                    let likeness = if index * 7 % 13 < 6 { 0.9 } else { 0.1 };
                    Detection {
                        position: place,
                        distance_m: place.norm(),
                        sigma_m: 0.1,
                        likeness,
                        points: 50,
                        moving: None,
                        surroundings: floorguard_perception::people::Surroundings::OPEN,
                        appearance: floorguard_perception::people::Appearance::UNKNOWN,
                    }
                })
                .collect();
            tracker.update(Stamp::from_micros(sweep * 100_000), &sightings, |_| true);
        }
        tracker
    }

    /// Whatever was learned: everybody of whom the guard would hear without it, it hears of with it, and the same.
    #[test]
    fn learning_adds_people_and_removes_none() {
        let tracker = crowd();
        let of = |learned: &dyn Fn(&Track) -> Option<f32>| {
            advice(Stamp::from_micros(1_200_000), tracker.tracks(), Pose2::default(), learned).people
        };
        let without = of(&|_| None);
        assert!((5..ADVISED_PEOPLE_MAX).contains(&without.len()), "{}", without.len());
        let wrong = of(&|_| Some(0.0));
        assert_eq!(wrong, without, "called nobody by what was learned");
        let mut random = floorguard_types::random::Pcg32::new(5, 5);
        for _ in 0..50 {
            let seed = random.below(1_000);
            let learned = |track: &Track| {
                (!track.id.wrapping_mul(seed).is_multiple_of(3))
                    .then_some(((track.id ^ seed) % 10) as f32 * 0.1)
            };
            let with = of(&learned);
            assert!(without.iter().all(|person| with.contains(person)), "{with:?}");
        }
        let everybody = of(&|_| Some(1.0));
        assert!(everybody.len() > without.len() && without.iter().all(|person| everybody.contains(person)));
    }

    /// A pillar is no person for the guard; who stands still in an unlikely shape is one, and so is what moves.
    #[test]
    fn only_a_positive_explanation_takes_a_person_away() {
        let tracker = crowd();
        let people = |explanation: Option<Explanation>, moving_probability: f32| {
            let mut tracks = tracker.tracks().to_vec();
            for track in &mut tracks {
                (track.explanation, track.moving_probability) = (explanation, moving_probability);
            }
            advice(Stamp::from_micros(1_200_000), &tracks, Pose2::default(), |_| None).people.len()
        };
        let all = people(None, 0.0);
        assert!(all > 5, "{all}");
        assert_eq!(people(Some(Explanation::UnlikelyShape), 0.0), all);
        assert_eq!(people(Some(Explanation::RigidPart), 0.0), all);
        assert_eq!(people(Some(Explanation::GoesOnAbove), 0.0), 0);
        assert!(people(Some(Explanation::GoesOnAbove), 0.9) >= all, "what moves is no pillar");
    }

    #[test]
    fn velocities_rotate_but_do_not_translate() {
        let to_robot = Pose2::new(3.0, 4.0, core::f32::consts::FRAC_PI_2).inverse();
        let velocity = turned(to_robot, Point2::new(0.0, 1.0));
        assert!((velocity.x_m - 1.0).abs() < 1e-6 && velocity.y_m.abs() < 1e-6);
    }
}
