//! Lives of tracks: birth, hiding, return, crowds, time that runs backwards.

mod explanations;
mod re_identification;

use super::*;
use crate::tracking::{AppearanceOf, Detection, SensorSet};
use floorguard_types::profile::Host;

const TRACKS_MAX: usize = <Native as Profile>::Tracks::N;
const TRACKS_ON_BOARD: usize = <Board as Profile>::Tracks::N;

fn sighting(x_m: f32, y_m: f32) -> Detection {
    sighting_of(x_m, y_m)
}

fn sighting_of<P: Profile>(x_m: f32, y_m: f32) -> DetectionOf<P> {
    let position = Point2::new(x_m, y_m);
    DetectionOf {
        position,
        distance_m: position.norm(),
        sigma_m: 0.1,
        likeness: 1.0,
        points: 50,
        moving: None,
        surroundings: crate::tracking::Surroundings::OPEN,
        appearance: AppearanceOf::UNKNOWN,
    }
}

/// Identifiers of the reported tracks, oldest first.
fn reported_ids(tracker: &Tracker) -> std::vec::Vec<u32> {
    let reported_ids = tracker.tracks().iter().filter(|track| track.status != TrackStatus::Hidden);
    reported_ids.map(|track| track.id).collect()
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
fn hidden_people_are_awaited_absent_ones_not() {
    for (visible, expected) in [(false, 1), (true, 0)] {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        for step in 0..20_u64 {
            tracker.update(Stamp::from_micros(step * 100_000), &[sighting(3.0, 0.0)], |_| true);
        }
        for step in 20..30_u64 {
            tracker.update(Stamp::from_micros(step * 100_000), &[], |_| visible);
        }
        assert_eq!(reported_ids(&tracker).len(), expected, "visible {visible}");
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

/// A crowd of more people than the board tracks, who come and go: what became of them after each sweep.
fn crowded_lives<P: Profile>(parameters: TrackerParameters) -> std::vec::Vec<(u32, Point2, f32)> {
    let mut random = floorguard_types::random::Pcg32::new(11, 7);
    let mut tracker = std::boxed::Box::new(TrackerOf::<P>::new(parameters));
    let mut lives = std::vec::Vec::new();
    for sweep in 0..60_u64 {
        let people: std::vec::Vec<_> = (0..70)
            .filter_map(|person| {
                let noise_m = random.uniform_between(-0.05, 0.05);
                let is_there = random.uniform() < 0.8;
                let turned = person as f32 * 0.9 + sweep as f32 * 0.02;
                let (sin, cos) = libm::sincosf(turned);
                let reach_m = 2.0 + 0.25 * person as f32;
                is_there.then(|| sighting_of(reach_m * cos + noise_m, reach_m * sin))
            })
            .collect();
        tracker.update(Stamp::from_micros(sweep * 100_000), &people, |_| true);
        lives.extend(tracker.tracks().iter().map(|track| (track.id, track.state.position, track.belief)));
        lives.push((tracker.dropped, Point2::default(), tracker.dropped_pairs() as f32));
    }
    lives
}

/// The board's own types, and a computer's with the board's limits, in one program: the same bits.
#[test]
fn board_and_limited_host_agree() {
    let board = crowded_lives::<Board>(TrackerParameters::DEFAULT);
    assert!(board.len() > 1_000 && board.last().is_some_and(|(dropped, ..)| *dropped > 100));
    assert_eq!(board, crowded_lives::<Host>(TrackerParameters::AS_ON_BOARD));
    assert_ne!(board, crowded_lives::<Host>(TrackerParameters::WITHOUT_APPEARANCE));
}

/// A computer that repeats what the microcontroller does has the same capacity, and drops the same people.
#[test]
fn board_profile_holds_fewer() {
    let mut tracker = std::boxed::Box::new(Tracker::new(TrackerParameters::AS_ON_BOARD));
    let at = |index: usize| sighting(3.0 + index as f32, 0.0);
    let crowd: std::vec::Vec<_> = (0..2 * TRACKS_ON_BOARD).rev().map(at).collect();
    tracker.update(Stamp::from_micros(0), &crowd, |_| true);
    assert_eq!((tracker.tracks().len(), tracker.dropped), (TRACKS_ON_BOARD, TRACKS_ON_BOARD as u32));
    assert!(tracker.tracks().iter().all(|track| track.state.position.x_m < 3.0 + TRACKS_ON_BOARD as f32));
    let mut tracker = std::boxed::Box::new(Tracker::new(TrackerParameters::AS_ON_BOARD));
    let more: std::vec::Vec<_> = crowd.iter().copied().chain([sighting(1.0, 0.0)]).collect();
    tracker.update(Stamp::from_micros(0), &more, |_| true);
    assert!(tracker.tracks().iter().all(|track| track.state.position.x_m > 2.0), "one sighting too many");
    assert_eq!((tracker.tracks().len(), tracker.dropped), (TRACKS_ON_BOARD, TRACKS_ON_BOARD as u32 + 1));
}

/// A slightly late view updates matching tracks with more doubt and starts none; a very late one is refused.
#[test]
fn late_data_moves_tracks_too_late_is_refused() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    tracker.update(Stamp::from_micros(400_000), &[sighting(3.0, 0.0)], |_| true);
    let before = tracker.tracks()[0].state;
    tracker.update(Stamp::from_micros(300_000), &[sighting(3.2, 0.0), sighting(8.0, 0.0)], |_| true);
    let after = tracker.tracks()[0].state;
    assert_eq!((tracker.tracks().len(), tracker.late), (1, 0));
    assert!(after.position.x_m > before.position.x_m && after.position.x_m < 3.15, "{after:?}");
    tracker.update(Stamp::from_micros(150_000), &[sighting(3.2, 0.0)], |_| true);
    assert_eq!((tracker.tracks()[0].state, tracker.late), (after, 1));
}

fn take(tracker: &mut Tracker, sensor: PeopleSensor, at_us: u64, detections: &[Detection], visible: bool) {
    tracker.take(&Sightings { sensor, stamp: Stamp::from_micros(at_us), detections }, |_| visible);
}

/// Legs five times are a person, too, and lidar and scanner share one track.
#[test]
fn sensors_share_their_tracks() {
    let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
    let legs = Detection { sigma_m: 0.3, likeness: 0.9, ..sighting(2.0, 0.1) };
    for scan in 0..5_u64 {
        let expected = if scan < 5 { TrackStatus::Tentative } else { TrackStatus::Confirmed };
        assert!(tracker.tracks().iter().all(|track| track.status == expected), "scan {scan}");
        take(&mut tracker, PeopleSensor::Scanner, scan * 40_000, &[legs], true);
    }
    assert_eq!(tracker.tracks()[0].status, TrackStatus::Confirmed);
    take(&mut tracker, PeopleSensor::Lidar, 200_000, &[sighting(2.0, 0.0)], true);
    assert_eq!(tracker.tracks().len(), 1);
    let set = tracker.tracks()[0].sensors(Stamp::from_micros(200_000));
    assert_eq!(set.bits(), 3);
    let later = tracker.tracks()[0].sensors(Stamp::from_micros(690_000));
    assert_eq!(later, SensorSet::NONE.with(PeopleSensor::Lidar));
}

/// Misses of the scanner end a track only where it saw that person before and could see the place.
#[test]
fn sensor_misses_only_known_visible_people() {
    for (legs_before, visible, expected) in [(true, true, 0), (true, false, 1), (false, true, 1)] {
        let mut tracker = Tracker::new(TrackerParameters {
            coast_max_us: 9_000_000,
            variance_max_m2: 99.0,
            ..TrackerParameters::DEFAULT
        });
        for step in 0..10_u64 {
            take(&mut tracker, PeopleSensor::Lidar, step * 100_000, &[sighting(2.0, 0.0)], true);
            if legs_before {
                let legs = Detection { sigma_m: 0.3, ..sighting(2.0, 0.0) };
                take(&mut tracker, PeopleSensor::Scanner, step * 100_000 + 1, &[legs], true);
            }
        }
        for scan in 0..40_u64 {
            take(&mut tracker, PeopleSensor::Scanner, 1_000_000 + scan * 40_000, &[], visible);
        }
        assert_eq!(reported_ids(&tracker).len(), expected, "legs {legs_before}, visible {visible}");
    }
}

/// What the scanner takes for legs and the lidar, which looks there, for nothing, is hardly a person; where the lidar
/// cannot look, the scanner's word stands.
#[test]
fn legs_without_a_body_are_doubted() {
    for (lidar_observes, is_person) in [(true, false), (false, true)] {
        let mut tracker = Tracker::new(TrackerParameters::DEFAULT);
        let legs = Detection { sigma_m: 0.3, likeness: 0.9, ..sighting(2.0, 0.0) };
        for scan in 0..50_u64 {
            take(&mut tracker, PeopleSensor::Scanner, scan * 40_000, &[legs], true);
            if scan % 5 == 4 {
                take(&mut tracker, PeopleSensor::Lidar, scan * 40_000 + 1, &[], lidar_observes);
                take(&mut tracker, PeopleSensor::Lidar, scan * 40_000 + 2, &[], lidar_observes);
            }
        }
        let probability = tracker.tracks()[0].person_probability;
        assert_eq!(probability > 0.5, is_person, "{probability}");
    }
}

/// Two tracks that grow together, each seen by one sensor only, are one person; those of one sensor are two.
#[test]
fn person_seen_by_two_sensors_is_one_track() {
    for (other, expected) in [(PeopleSensor::Scanner, 1), (PeopleSensor::Lidar, 2)] {
        let mut tracker = Tracker::new(TrackerParameters { gate: 0.5, ..TrackerParameters::DEFAULT });
        for step in 0..20_u64 {
            let aside_m = 0.7 - 0.02 * step as f32;
            let one = sighting(2.0, 0.0);
            let two = sighting(2.0, aside_m);
            if other == PeopleSensor::Lidar {
                take(&mut tracker, PeopleSensor::Lidar, step * 100_000, &[one, two], true);
            } else {
                take(&mut tracker, PeopleSensor::Lidar, step * 100_000, &[one], true);
                take(&mut tracker, other, step * 100_000 + 1, &[two], true);
            }
        }
        assert_eq!(tracker.tracks().len(), expected, "{other:?}");
        assert_eq!(tracker.tracks()[0].id, 1);
    }
}

#[test]
fn forgotten_people_free_their_slots_first() {
    let mut tracker = std::boxed::Box::new(Tracker::new(TrackerParameters::DEFAULT));
    let stamp = |step: u64| Stamp::from_micros(step * 100_000);
    for step in 0..10 {
        tracker.update(stamp(step), &[sighting(1.0, 0.0)], |_| true);
    }
    for step in 10..40 {
        tracker.update(stamp(step), &[], |_| false);
    }
    assert_eq!(tracker.tracks()[0].status, TrackStatus::Hidden);
    let mut other = tracker.clone();
    for step in 40..100 {
        other.update(stamp(step), &[], |_| false);
    }
    assert!(other.tracks().is_empty());
    let crowd: std::vec::Vec<_> = (0..TRACKS_MAX).map(|index| sighting(5.0 + index as f32, 0.0)).collect();
    tracker.update(stamp(40), &crowd, |_| true);
    assert_eq!((reported_ids(&tracker).len(), tracker.dropped), (TRACKS_MAX, 1));
}
