//! What is explained, and what stays a person.

use super::*;
use crate::tracking::{Explanation, Surroundings};
use floorguard_types::random::Pcg32;

/// Sweeps of twenty minutes.
const TWENTY_MINUTES: u64 = 12_000;
/// Likeness of some log-odds.
fn likeness(log_odds: f32) -> f32 {
    crate::shapes::person_model::probability(log_odds)
}

fn stamp(sweep: u64) -> Stamp {
    Stamp::from_micros(sweep * 100_000)
}

/// Somebody at (3, 1) in a sweep.
fn stander(log_odds: f32) -> Detection {
    Detection { likeness: likeness(log_odds), ..sighting(3.0, 1.0) }
}

fn explanation(tracker: &Tracker) -> Option<Explanation> {
    tracker.tracks().first().expect("a track").explanation
}

/// A recorded person who waits at a table has a mean of 0.95 and a deviation of 0.39; the middle of the body wanders by a
/// centimetre, and the lidar misses it now and then.
#[test]
fn people_stand_twenty_minutes_and_stay_people() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    let mut random = Pcg32::new(1, 9);
    for sweep in 0..TWENTY_MINUTES {
        let mut noise = |sigma: f32| sigma * (random.uniform_between(-1.7, 1.7));
        let mut seen = Detection { surroundings: Surroundings::PART, ..stander(0.95 + noise(0.39)) };
        seen.position = Point2::new(3.0 + noise(0.01), 1.0 + noise(0.01));
        let found = if sweep % 20 == 7 { &[][..] } else { core::slice::from_ref(&seen) };
        tracker.update(stamp(sweep), found, |_| true);
        let is_person = tracker.tracks().first().is_some_and(crate::tracking::TrackOf::is_taken_for_person);
        assert!(sweep < 2 || is_person, "sweep {sweep}: {:?}", tracker.tracks());
    }
}

/// Free in the room and of the shape of a person, however still: only what stands out of something larger can be rigid.
#[test]
fn motionless_whole_body_stays_person_part_is_explained() {
    for (surroundings, expected) in
        [(Surroundings::OPEN, None), (Surroundings::PART, Some(Explanation::RigidPart))]
    {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        for sweep in 0..120 {
            if sweep == 99 {
                assert_eq!(explanation(&tracker), None, "not before ten seconds");
            }
            let seen = Detection { surroundings, ..stander(2.0) };
            tracker.update(stamp(sweep), &[seen], |_| true);
        }
        assert_eq!(explanation(&tracker), expected);
        assert!(tracker.tracks()[0].person_probability > 0.9, "the probability stays what it is");
    }
}

/// Narrower than a neck between broad parts in sweep after sweep; one odd sweep in four says nothing.
#[test]
fn standing_waist_is_explained_by_most_sweeps() {
    for (every, expected) in [(1, Some(Explanation::NarrowWaist)), (4, None)] {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        for sweep in 0..40 {
            let waist = if sweep % every == 0 { Surroundings::WAIST } else { Surroundings::OPEN };
            let seen = Detection { surroundings: waist, ..stander(2.0) };
            tracker.update(stamp(sweep), &[seen], |_| true);
        }
        assert_eq!(explanation(&tracker), expected, "one of {every} sweeps");
    }
    assert!(!Explanation::NarrowWaist.is_positive(), "the guard goes on taking it for a person");
}

/// What flickers at an open place is no person until it moves; from then on it is one, however its shape looks.
#[test]
fn unlikely_shape_that_moves_is_a_person_again() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    for sweep in 0..40 {
        let seen = stander(0.4);
        let found = if sweep % 3 == 2 { &[][..] } else { core::slice::from_ref(&seen) };
        tracker.update(stamp(sweep), found, |_| true);
    }
    assert_eq!(explanation(&tracker), Some(Explanation::UnlikelyShape));
    for sweep in 40..46 {
        let seen = Detection { moving: Some(true), ..stander(0.4) };
        tracker.update(stamp(sweep), &[seen], |_| true);
    }
    assert!(tracker.tracks()[0].is_taken_for_person(), "{:?}", tracker.tracks());
    for sweep in 46..200 {
        tracker.update(stamp(sweep), &[stander(0.1)], |_| true);
    }
    assert_eq!(explanation(&tracker), None, "it came here by itself");
}

#[test]
fn legs_or_camera_keep_an_unlikely_shape() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    for sweep in 0..40 {
        tracker.update(stamp(sweep), &[stander(0.1)], |_| true);
        let legs = [Detection { sigma_m: 0.3, ..stander(1.0) }];
        let scan = Sightings { sensor: PeopleSensor::Scanner, stamp: stamp(sweep), detections: &legs };
        tracker.take(&scan, |_| true);
        assert_eq!(explanation(&tracker), None, "sweep {sweep}");
    }
    for sweep in 40..60 {
        tracker.update(stamp(sweep), &[stander(0.1)], |_| true);
    }
    assert_eq!(explanation(&tracker), Some(Explanation::UnlikelyShape), "without them it is one");
}

#[test]
fn one_wrong_sweep_above_explains_no_person() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    for sweep in 0..60 {
        let surroundings = if sweep % 3 == 0 { Surroundings::ABOVE } else { Surroundings::OPEN };
        tracker.update(stamp(sweep), &[Detection { surroundings, ..stander(2.0) }], |_| true);
        assert_eq!(explanation(&tracker), None, "sweep {sweep}");
    }
    for sweep in 60..64 {
        let seen = Detection { surroundings: Surroundings::ABOVE, ..stander(2.0) };
        tracker.update(stamp(sweep), &[seen], |_| true);
    }
    let found = explanation(&tracker).expect("a pillar");
    assert!(found == Explanation::GoesOnAbove && found.is_positive());
    assert!(!Explanation::UnlikelyShape.is_positive() && !Explanation::RigidPart.is_positive());
}

/// Legs of a chair come in pairs, too: what the scanner alone ever saw is explained until it walks. What the lidar sees as
/// well needs no walk.
#[test]
fn legs_that_never_walked_are_explained() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    for number in 0..100 {
        let legs = [Detection { sigma_m: 0.32, ..sighting(2.0, 0.0) }];
        let at = Stamp::from_micros(number * 40_000);
        tracker.take(&Sightings { sensor: PeopleSensor::Scanner, stamp: at, detections: &legs }, |_| true);
        assert_eq!(explanation(&tracker), Some(Explanation::LegsThatNeverWalked), "scan {number}");
        assert!(!tracker.tracks()[0].is_taken_for_person());
    }
    assert!(!Explanation::LegsThatNeverWalked.is_positive());
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    let legs = [Detection { sigma_m: 0.32, ..stander(1.0) }];
    for number in 0..10 {
        let scan = Sightings { sensor: PeopleSensor::Scanner, stamp: stamp(number), detections: &legs };
        tracker.take(&scan, |_| true);
        tracker.update(stamp(number), &[stander(1.0)], |_| true);
        assert_eq!(explanation(&tracker), None, "sweep {number}");
    }
}
