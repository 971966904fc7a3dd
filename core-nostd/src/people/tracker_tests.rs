//! Lives of tracks: birth, hiding, return, crowds, time that runs backwards.

use super::*;

fn sighting(x_m: f32, y_m: f32) -> Detection {
    let position = Point2::new(x_m, y_m);
    Detection { position, distance_m: position.norm(), sigma_m: 0.1, likeness: 1.0, points: 50, moving: None }
}

/// Two people meet head on and pass 0.8 m apart.
#[test]
fn passing_people_keep_their_identity_with_both_associations() {
    for association in [Association::Nearest, Association::Joint] {
        let mut tracker = Tracker::new(TrackerParameters { association, ..TrackerParameters::DEFAULT });
        for step in 0..60_u64 {
            let along_m = 0.12 * step as f32 - 3.6;
            let stamp = Stamp::from_micros(step * 100_000);
            tracker.update(stamp, &[sighting(along_m, 0.4), sighting(-along_m, -0.4)], |_| true);
        }
        let ids: std::vec::Vec<_> = tracker.tracks().iter().map(|track| track.id).collect();
        assert_eq!(ids, [1, 2], "{association:?}");
        assert!(tracker.tracks().iter().all(|track| track.person_probability > 0.8));
        assert!((tracker.tracks()[0].state.velocity.x_m - 1.2).abs() < 0.05);
    }
}

#[test]
fn hidden_people_are_waited_for_and_absent_ones_are_not() {
    for (visible, expected) in [(false, 1), (true, 0)] {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        for step in 0..20_u64 {
            tracker.update(Stamp::from_micros(step * 100_000), &[sighting(3.0, 0.0)], |_| true);
        }
        for step in 20..30_u64 {
            tracker.update(Stamp::from_micros(step * 100_000), &[], |_| visible);
        }
        assert_eq!(tracker.tracks().len(), expected, "visible {visible}");
    }
}

#[test]
fn near_people_push_out_far_ones() {
    let mut tracker = std::boxed::Box::new(Tracker::new(TrackerParameters::DEFAULT));
    let crowd: std::vec::Vec<_> = (0..TRACKS_MAX).map(|index| sighting(3.0 + index as f32, 0.0)).collect();
    tracker.update(Stamp::from_micros(0), &crowd, |_| true);
    assert_eq!(tracker.tracks().len(), TRACKS_MAX);
    tracker.update(Stamp::from_micros(100_000), &[sighting(1.0, 0.0)], |_| true);
    assert!(tracker.tracks().iter().any(|track| track.state.position.x_m < 2.0));
    assert!(tracker.tracks().iter().all(|track| track.state.position.x_m < 2.5 + TRACKS_MAX as f32));
    assert_eq!((tracker.tracks().len(), tracker.dropped), (TRACKS_MAX, 1));
    tracker.update(Stamp::from_micros(200_000), &[sighting(500.0, 0.0)], |_| true);
    assert_eq!((tracker.tracks().len(), tracker.dropped), (TRACKS_MAX, 2));
}

#[test]
fn a_sweep_from_the_past_is_refused_and_counted() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    tracker.update(Stamp::from_micros(200_000), &[sighting(3.0, 0.0)], |_| true);
    tracker.update(Stamp::from_micros(100_000), &[sighting(6.0, 0.0)], |_| true);
    assert_eq!((tracker.tracks().len(), tracker.late), (1, 1));
}

/// Somebody who vanished behind a column and comes out on its other side is the same person; somebody who appears
/// too far away is not.
#[test]
fn who_returns_after_a_long_time_out_of_sight_is_known_again() {
    for (returns_at_m, expected) in [(3.5, 1), (12.0, 2)] {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        let stamp = |step: u64| Stamp::from_micros(step * 100_000);
        for step in 0..20 {
            tracker.update(stamp(step), &[sighting(0.1 * step as f32, 3.0)], |_| true);
        }
        for step in 20..50 {
            tracker.update(stamp(step), &[], |_| false);
        }
        assert!(tracker.tracks().is_empty());
        for step in 50..54 {
            let along_m = returns_at_m + 0.1 * (step - 50) as f32;
            tracker.update(stamp(step), &[sighting(along_m, 3.0)], |_| true);
        }
        let ids: std::vec::Vec<_> = tracker.tracks().iter().map(|track| track.id).collect();
        assert_eq!(ids, [expected], "{returns_at_m}");
    }
}
