//! FG-REQ-087: what is pushed slowly is advised, what stands or moves otherwise is not.

use super::advise::advice;
use floorguard_perception::people::{Appearance, Detection, Surroundings, Track, Tracker, TrackerParameters};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::time::Stamp;

/// Sweeps before the list of people is asked for.
const SWEEPS: u16 = 30;

fn now() -> Stamp {
    Stamp::from_micros(u64::from(SWEEPS) * 100_000)
}

/// A person who walks along x with 0.15 m/s, and an object 0.8 m ahead with another velocity, seen by the lidar for three seconds.
fn person_and_object(velocity_mps: (f32, f32)) -> std::boxed::Box<Tracker> {
    let mut tracker = std::boxed::Box::new(Tracker::new(TrackerParameters::DEFAULT));
    for sweep in 1..=SWEEPS {
        let time_s = 0.1 * f32::from(sweep);
        let seen = |position: Point2, likeness: f32| Detection {
            position,
            distance_m: position.norm(),
            sigma_m: 0.1,
            likeness,
            points: 50,
            moving: None,
            surroundings: Surroundings::OPEN,
            appearance: Appearance::UNKNOWN,
        };
        let (x_mps, y_mps) = velocity_mps;
        let sightings = [
            seen(Point2::new(1.0 + 0.15 * time_s, 0.5), 0.95),
            seen(Point2::new(1.8 + x_mps * time_s, 0.5 + y_mps * time_s), 0.02),
        ];
        tracker.update(Stamp::from_micros(u64::from(sweep) * 100_000), &sightings, |_| true);
    }
    tracker
}

/// Identities in the advice.
fn advised(tracks: &[Track]) -> std::vec::Vec<u32> {
    let people = advice(now(), tracks, Pose2::default(), |_| None).people;
    people.iter().map(|person| person.id).collect()
}

/// Of a tracker's list: the identities of person and object.
fn identities(tracks: &[Track]) -> [u32; 2] {
    let of = |is_person: bool| {
        let mut found = tracks.iter().filter(|track| (track.person_probability > 0.5) == is_person);
        found.next().expect("both are tracked").id
    };
    [of(true), of(false)]
}

#[test]
fn fg_req_087_slowly_pushed_trolley_is_advised() {
    let tracker = person_and_object((0.15, 0.0));
    let [person, trolley] = identities(tracker.tracks());
    let people = advised(tracker.tracks());
    assert!(people.len() == 2 && people.contains(&person) && people.contains(&trolley), "{people:?}");
}

#[test]
fn fg_req_087_what_moves_otherwise_is_not() {
    for velocity_mps in [(0.0, 0.0), (-0.15, 0.0), (0.0, 0.15), (0.06, 0.0)] {
        let tracker = person_and_object(velocity_mps);
        let [person, _] = identities(tracker.tracks());
        assert_eq!(advised(tracker.tracks()), [person], "{velocity_mps:?}");
    }
}

/// Far from its person, or not seen at this moment: nothing moves along.
#[test]
fn fg_req_087_near_and_fresh_alone_count() {
    let tracker = person_and_object((0.15, 0.0));
    let [person, trolley] = identities(tracker.tracks());
    let changed = |change: &dyn Fn(&mut Track)| {
        let mut tracks = tracker.tracks().to_vec();
        tracks.iter_mut().filter(|track| track.id == trolley).for_each(change);
        advised(&tracks)
    };
    assert_eq!(changed(&|_| ()).len(), 2);
    assert_eq!(changed(&|track| track.state.position.y_m += 1.5), [person], "somebody else's");
    let before = Stamp::from_micros(now().as_micros() - 400_000);
    assert_eq!(changed(&|track| track.last_seen = before), [person], "out of sight");
}
