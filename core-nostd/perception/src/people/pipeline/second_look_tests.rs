//! Two looks at people made of geometry: who is seen by both, by one, near and far.

use std::boxed::Box;
use std::vec::Vec;

use super::super::state::PeoplePipeline;
use super::super::vlp16_tests::{SENSOR_M, standing, swept};
use super::*;
use crate::clusters::RingAngles;
use crate::tracking::{Detection, TrackStatus};
use floorguard_types::sensing::Sweep;

/// Rings of the second look lie a degree below those of the first.
const SECOND_DEG: f32 = -16.0;

/// People 0.45 m broad and 1.7 m tall at these distances, each on a bearing of its own, on an empty floor.
fn range_m(people_m: &[(f32, f32)], bearing: f32, elevation: f32) -> f32 {
    for (bearing_rad, distance_m) in people_m {
        let left_m = distance_m * libm::tanf(bearing - bearing_rad);
        let height_m = SENSOR_M + distance_m * libm::tanf(elevation);
        if left_m.abs() < 0.225 && (0.0..1.7).contains(&height_m) {
            return distance_m / libm::cosf(elevation);
        }
    }
    0.0
}

fn sweep(lowest_deg: f32, people_m: &[(f32, f32)]) -> Box<Sweep> {
    swept(lowest_deg, |bearing, elevation| range_m(people_m, bearing, elevation))
}

/// What the second look detects of people.
fn second(people_m: &[(f32, f32)]) -> Vec<Detection> {
    let mut pipeline = Box::new(PeoplePipeline::new(RingAngles::even(SECOND_DEG, 2.0)));
    let sweep = sweep(SECOND_DEG, people_m);
    pipeline.find_clusters(&sweep, &standing());
    pipeline.find_detections(&sweep, &standing());
    pipeline.detections().to_vec()
}

/// The pipeline after so many sweeps with the same second look.
fn followed(sweeps: u64, people_m: &[(f32, f32)], second: &[Detection]) -> Box<PeoplePipeline> {
    let mut pipeline = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
    let mut sweep = sweep(-15.0, people_m);
    for number in 0..sweeps {
        sweep.end_stamp = floorguard_types::time::Stamp::from_micros(100_000 * number);
        pipeline.find_clusters(&sweep, &standing());
        pipeline.find_people_with_second_look(&sweep, &standing(), second, |_| None);
    }
    pipeline
}

#[test]
fn person_seen_by_both_gives_one_track() {
    for distance_m in [3.0, 5.0, 8.0, 14.0] {
        let people = [(0.0, distance_m)];
        let second = second(&people);
        assert_eq!(second.len(), 1, "{distance_m} m");
        let pipeline = followed(4, &people, &second);
        assert_eq!((pipeline.detections().len(), pipeline.tracks().len()), (1, 1), "{distance_m} m");
        let track = &pipeline.tracks()[0];
        // Both looks at one moment are one sighting.
        assert_eq!((track.status, track.sightings), (TrackStatus::Confirmed, 4), "{distance_m} m");
    }
}

/// A person missed by the first look is tracked by the second. Confirmation takes as many sweeps as before.
#[test]
fn person_of_second_look_alone_is_tracked() {
    let second = second(&[(0.0, 8.0), (0.2, 14.0)]);
    assert_eq!(second.len(), 2);
    let pipeline = followed(3, &[(0.0, 8.0)], &second);
    assert_eq!(pipeline.tracks().len(), 2);
    assert!(pipeline.tracks().iter().all(|track| track.status == TrackStatus::Confirmed));
    assert_eq!(followed(3, &[(0.0, 8.0)], &[]).tracks().len(), 1);
    assert!(followed(2, &[], &second).tracks().iter().all(|track| track.status == TrackStatus::Tentative));
}

#[test]
fn second_look_counts_for_far_people_alone() {
    for (distance_m, is_joined) in [(4.0, false), (10.0, true)] {
        let people = [(0.0, distance_m)];
        let alone = followed(1, &people, &[]).detections()[0];
        let other = Detection {
            likeness: 0.9,
            points: 7,
            position: Point2::new(alone.position.x_m, alone.position.y_m + 0.2),
            ..alone
        };
        let found = followed(1, &people, &[other]).detections()[0];
        let wanted = if is_joined {
            let mean = 0.5 * (log_odds(alone.likeness) + log_odds(0.9));
            (probability(mean), alone.points + 7, alone.position.y_m + 0.1)
        } else {
            (alone.likeness, alone.points, alone.position.y_m)
        };
        assert!((found.likeness - wanted.0).abs() < 1.0e-5 && found.points == wanted.1, "{found:?}");
        assert!((found.position.y_m - wanted.2).abs() < 1.0e-5, "{found:?}");
    }
}

/// More than fit are dropped and counted.
#[test]
fn full_list_drops_the_second_look() {
    let one = second(&[(0.0, 8.0)])[0];
    let many: Vec<Detection> = (0..300_u16)
        .map(|number| Detection { position: Point2::new(20.0 + f32::from(number), 0.0), ..one })
        .collect();
    let pipeline = followed(1, &[(0.0, 8.0)], &many);
    assert_eq!(pipeline.detections().len(), pipeline.tracker().detections_max());
    assert!(pipeline.counters.dropped_candidates > 0);
}
