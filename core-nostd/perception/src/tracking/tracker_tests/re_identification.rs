//! Who was out of sight is known again, by place, way of walking and looks.

use super::*;

/// Somebody who vanished behind a column and comes out on its other side is the same person; somebody who appears
/// too far away is not.
#[test]
fn long_hidden_person_is_re_identified() {
    for (returns_at_m, expected) in [(3.5, 1), (12.0, 2)] {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        let stamp = |step: u64| Stamp::from_micros(step * 100_000);
        for step in 0..20 {
            tracker.update(stamp(step), &[sighting(0.1 * step as f32, 3.0)], |_| true);
        }
        for step in 20..50 {
            tracker.update(stamp(step), &[], |_| false);
        }
        assert!(tracker.tracks().iter().all(|track| track.status == TrackStatus::Hidden));
        for step in 50..54 {
            let along_m = returns_at_m + 0.1 * (step - 50) as f32;
            tracker.update(stamp(step), &[sighting(along_m, 3.0)], |_| true);
        }
        assert_eq!(reported_ids(&tracker), [expected], "{returns_at_m}");
    }
}

/// One walks, one stands, and both vanish: who appears three seconds later between them, nearer to where the other one
/// stood, is the one whose path led there.
#[test]
fn hidden_walker_is_expected_farther_along() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    let stamp = |step: u64| Stamp::from_micros(step * 100_000);
    for step in 0..30 {
        let walker = sighting(0.1 * step as f32 - 3.0, 3.0);
        tracker.update(stamp(step), &[walker, sighting(4.2, 3.0)], |_| true);
    }
    for step in 30..60 {
        tracker.update(stamp(step), &[], |_| false);
    }
    assert!(reported_ids(&tracker).is_empty());
    for step in 60..64 {
        tracker.update(stamp(step), &[sighting(2.4 + 0.1 * (step - 60) as f32, 3.0)], |_| false);
    }
    assert_eq!(reported_ids(&tracker), [1]);
}

/// Nobody out of sight is matched with a new person before its re-identification.
const ONLY_RECALL: TrackerParameters = TrackerParameters { hidden_gate_m: 0.0, ..TrackerParameters::DEFAULT };

/// Two people, each from a place along x with a speed, are seen for two seconds, nobody for three, then one for half a
/// second, who moves by `mps` along x from `from`: the number of that one. The remainder of a walk at 1 m/s leads 1.9 m
/// ahead.
fn who_returns(two: [[f32; 3]; 2], (from, mps): ([f32; 2], f32)) -> u32 {
    let mut tracker = Tracker::new(ONLY_RECALL);
    let stamp = |step: u64| Stamp::from_micros(step * 100_000);
    for step in 0..20 {
        let seen = two.map(|[x_m, y_m, mps]| sighting(x_m + 0.1 * mps * step as f32, y_m));
        tracker.update(stamp(step), &seen, |_| true);
    }
    for step in 20..50 {
        tracker.update(stamp(step), &[], |_| false);
    }
    for step in 50..55 {
        let along_m = 0.1 * mps * (step - 50) as f32;
        tracker.update(stamp(step), &[sighting(from[0] + along_m, from[1])], |_| false);
    }
    let mut back = tracker.tracks().iter().filter(|track| track.last_seen == stamp(54));
    back.next().expect("somebody is back").id
}

/// Two who walk towards each other vanish; who comes out where both are expected, a little nearer to the one, is the one who
/// walked that way.
#[test]
fn reappearing_person_is_the_one_walking_there() {
    let two = [[-3.8, 4.4, 1.0], [3.8, 3.6, -1.0]];
    assert_eq!(who_returns(two, ([0.0, 3.9], 1.0)), 1);
    assert_eq!(who_returns(two, ([0.0, 4.1], -1.0)), 2);
}

/// One walks 2 m behind the other: where the first one vanished, three seconds later, it is the one behind.
#[test]
fn hidden_walker_is_found_farther_along() {
    let two = [[-4.0, 4.0, 1.0], [-2.0, 4.0, 1.0]];
    assert_eq!(who_returns(two, ([-0.1, 4.0], 1.0)), 1);
    assert_eq!(who_returns(two, ([1.9, 4.0], 1.0)), 2);
}

/// Two who were hidden come back in the same sweep: both have their numbers at once.
#[test]
fn two_are_known_again_at_the_same_time() {
    let mut tracker = Tracker::new(ONLY_RECALL);
    let stamp = |step: u64| Stamp::from_micros(step * 100_000);
    let people = [sighting(4.0, 2.0), sighting(4.0, -2.0)];
    for step in 0..20 {
        tracker.update(stamp(step), &people, |_| true);
    }
    for step in 50..53 {
        tracker.update(stamp(step), &[sighting(4.1, 2.0), sighting(4.1, -2.0)], |_| true);
    }
    let mut back = reported_ids(&tracker);
    back.sort_unstable();
    assert_eq!(back, [1, 2]);
}

/// Somebody who reappears half hidden resembles an object at first: re-identification runs when the track is
/// reported as a person.
#[test]
fn initially_object_like_person_is_re_identified() {
    let mut tracker = Tracker::new(ONLY_RECALL);
    let stamp = |step: u64| Stamp::from_micros(step * 100_000);
    for step in 0..20 {
        tracker.update(stamp(step), &[sighting(4.0, 2.0)], |_| true);
    }
    for step in 20..50 {
        tracker.update(stamp(step), &[], |_| false);
    }
    let mut other = tracker.clone();
    for step in 50..60 {
        let likeness = if step < 54 { 0.3 } else { 1.0 };
        tracker.update(stamp(step), &[Detection { likeness, ..sighting(4.1, 2.0) }], |_| true);
        other.update(stamp(step), &[Detection { likeness: 0.3, ..sighting(4.1, 2.0) }], |_| true);
        let people = tracker.tracks().iter().filter(|track| track.status != TrackStatus::Hidden);
        let numbers: std::vec::Vec<_> =
            people.filter(|track| track.person_probability > 0.5).map(|track| track.id).collect();
        assert!(numbers.is_empty() || numbers == [1], "{step}: {numbers:?}");
    }
    assert_eq!(reported_ids(&tracker), [1]);
    assert_eq!(reported_ids(&other), [2], "an object is no person");
}

/// Re-identification runs once, when a track is reported as a person: a stranger who turns round later and then goes as
/// the lost one went stays a stranger.
#[test]
fn new_person_is_not_re_identified_later() {
    let mut tracker = Tracker::new(ONLY_RECALL);
    let stamp = |step: u64| Stamp::from_micros(step * 100_000);
    for step in 0..20 {
        tracker.update(stamp(step), &[sighting(0.1 * step as f32, 2.0)], |_| true);
    }
    for step in 20..50 {
        tracker.update(stamp(step), &[], |_| false);
    }
    let mut x_m = 6.0;
    let mut numbers = std::vec::Vec::new();
    for step in 50..90 {
        // Against the lost one's heading, slower, and then as it went.
        x_m += (0.01 * (step - 50) as f32 - 0.15).min(0.1);
        tracker.update(stamp(step), &[sighting(x_m, 2.0)], |_| false);
        numbers.extend(reported_ids(&tracker));
    }
    numbers.dedup();
    assert_eq!(numbers, [2]);
}

/// Who has been out of sight for a while is no reason to take somebody 2 m away for that person.
#[test]
fn a_doubtful_track_does_not_take_in_strangers() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    let stamp = |step: u64| Stamp::from_micros(step * 100_000);
    for step in 0..20 {
        tracker.update(stamp(step), &[sighting(3.0, 0.0)], |_| true);
    }
    for step in 20..32 {
        tracker.update(stamp(step), &[], |_| false);
    }
    tracker.update(stamp(32), &[sighting(3.0, 1.7)], |_| false);
    assert_eq!(tracker.tracks().len(), 2);
    assert!(tracker.tracks()[0].state.position.y_m.abs() < 0.2);
}

/// Two people stand 2 m apart, out of sight for a second; then one of them stands between, nearer to the place of the
/// other: clothes tell who it is.
#[test]
fn clothes_identify_who_comes_back() {
    let dressed = |y_m: f32, reflectivity: u8| {
        let mut shades = crate::tracking::appearance::Shades::NEW;
        for _ in 0..40 {
            shades.add(0.4, Some(&reflectivity));
            shades.add(1.2, Some(&reflectivity));
        }
        Detection { appearance: shades.appearance((1.7, false), (0.8, 4.0)), ..sighting(4.0, y_m) }
    };
    let who_is_back = |parameters: TrackerParameters| {
        let mut tracker = Tracker::new(parameters);
        for sweep in 1..=10_u64 {
            tracker.update(
                Stamp::from_micros(100_000 * sweep),
                &[dressed(1.0, 6), dressed(-1.0, 60)],
                |_| true,
            );
        }
        for sweep in 11..=19_u64 {
            tracker.update(Stamp::from_micros(100_000 * sweep), &[], |_| false);
        }
        let back = Stamp::from_micros(2_000_000);
        tracker.update(back, &[dressed(0.1, 60)], |_| false);
        let seen = tracker.tracks().iter().find(|track| track.last_seen == back).expect("somebody is back");
        seen.first_position.y_m
    };
    assert!(who_is_back(TrackerParameters::WITHOUT_APPEARANCE) > 0.0, "the nearer one");
    assert!(who_is_back(TrackerParameters::DEFAULT) < 0.0, "the brighter one");
}
