//! From tracks to advice: the nearest people in the robot's frame.

use floorguard_core::geometry::{Point2, Pose2};
use floorguard_core::guard::{ADVISED_PEOPLE_MAX, Advice, AdvisedPerson};
use floorguard_core::people::{Track, TrackStatus};
use floorguard_core::time::Stamp;

/// A confirmed track counts as a person from this probability on.
pub const PERSON_PROBABILITY_MIN: f32 = 0.5;

/// What more probably moves than not is taken for a person too, whatever its shape: motion only ever adds to the advice.
pub const MOVING_PROBABILITY_MIN: f32 = 0.5;

/// The advice of one sweep. Tracks beyond the capacity are the farthest ones; the guard's own sensors see those near.
pub fn advice(stamp: Stamp, tracks: &[Track], base_in_odom: Pose2) -> Advice {
    let mut advice = Advice { stamp, ..Advice::default() };
    let to_robot = base_in_odom.inverse();
    let people = tracks.iter().filter(|track| track.status == TrackStatus::Confirmed).filter(|track| {
        track.person_probability >= PERSON_PROBABILITY_MIN
            || track.moving_probability >= MOVING_PROBABILITY_MIN
    });
    for track in people {
        let person = AdvisedPerson {
            id: track.id,
            position: to_robot.transform(track.state.position),
            velocity_mps: turned(to_robot, track.state.velocity),
            position_sigma_m: libm::sqrtf(track.state.position_variance.max(0.0)),
            velocity_sigma_mps: libm::sqrtf(track.state.velocity_variance.max(0.0)),
        };
        insert_by_distance(&mut advice.people, person);
    }
    advice
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
    // There is room now and the place is within the list.
    let _ = people.insert(place, person);
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn velocities_turn_with_the_robot_and_do_not_move_with_it() {
        let to_robot = Pose2::new(3.0, 4.0, core::f32::consts::FRAC_PI_2).inverse();
        let velocity = turned(to_robot, Point2::new(0.0, 1.0));
        assert!((velocity.x_m - 1.0).abs() < 1e-6 && velocity.y_m.abs() < 1e-6);
    }
}
