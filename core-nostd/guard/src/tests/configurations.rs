//! Each rule of the configuration, broken by itself and just not broken.

use super::fixtures::{config, rectangle};
use crate::*;
use floorguard_types::capacities::SCAN_BEAMS_MAX;
use floorguard_types::geometry::Point2;

/// What the check says to a configuration with one value changed.
fn with(change: impl FnOnce(&mut GuardConfig)) -> Result<(), GuardConfigError> {
    let mut config = config();
    change(&mut config);
    config.validate()
}

#[test]
fn fg_req_012_every_number_must_be_positive() {
    type Place = fn(&mut GuardConfig) -> &mut f32;
    let places: [(&str, Place); 13] = [
        ("greatest speed", |config| &mut config.drive.speed_mps),
        ("greatest turning rate", |config| &mut config.drive.turn_radps),
        ("acceleration", |config| &mut config.drive.acceleration_mps2),
        ("braking", |config| &mut config.drive.braking_mps2),
        ("response time", |config| &mut config.drive.response_s),
        ("wheelbase", |config| &mut config.drive.wheelbase_m),
        ("speed in the warning field", |config| &mut config.thresholds.warning_speed_mps),
        ("speed near people", |config| &mut config.thresholds.person_speed_mps),
        ("distance to people", |config| &mut config.thresholds.person_near_m),
        ("reach of the memory", |config| &mut config.thresholds.memory_reach_m),
        ("escape speed", |config| &mut config.thresholds.escape_speed_mps),
        ("tolerated difference of speeds", |config| &mut config.thresholds.speed_disagreement_mps),
        ("tolerated difference of turning rates", |config| &mut config.thresholds.turn_disagreement_radps),
    ];
    assert_eq!(with(|_| {}), Ok(()));
    for (name, place) in places {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(
                with(|config| *place(config) = bad),
                Err(GuardConfigError::NotPositive(name)),
                "{bad}"
            );
        }
    }
    let counts: [fn(&mut GuardConfig) -> &mut u8; 3] = [
        |config| &mut config.thresholds.scan_adjacent_beams,
        |config| &mut config.thresholds.scan_consecutive,
        |config| &mut config.thresholds.packet_returns,
    ];
    for place in counts {
        assert!(matches!(with(|config| *place(config) = 0), Err(GuardConfigError::NotPositive(_))));
    }
    for bad in [0.0, -0.3, f32::NAN, f32::INFINITY] {
        let found = with(|config| config.fields[1].speed_max_mps = bad);
        assert_eq!(found, Err(GuardConfigError::NotPositive("speed of a field set")), "{bad}");
    }
}

#[test]
fn fg_req_012_the_footprint_is_a_polygon_around_the_origin() {
    let corners = |list: &[(f32, f32)]| list.iter().map(|(x_m, y_m)| Point2::new(*x_m, *y_m)).collect();
    for bad in [corners(&[]), corners(&[(-0.4, -0.4), (0.9, 0.4)]), rectangle([0.1, 0.9], 0.4)] {
        assert_eq!(with(|config| config.footprint = bad), Err(GuardConfigError::Footprint));
    }
    let triangle = corners(&[(-0.4, -0.3), (0.9, 0.0), (-0.4, 0.3)]);
    assert_eq!(with(|config| config.footprint = triangle), Ok(()));
}

#[test]
fn fg_req_012_sensors_have_beams_rings_and_a_step() {
    for (beams, good) in [(0, false), (1, true), (SCAN_BEAMS_MAX, true), (SCAN_BEAMS_MAX + 1, false)] {
        let found = with(|config| config.scanner.beams = beams);
        assert_eq!(found, if good { Ok(()) } else { Err(GuardConfigError::Scanner) }, "{beams}");
    }
    for step_rad in [0.0, -0.1, f32::NAN, f32::INFINITY] {
        assert_eq!(with(|config| config.scanner.step_rad = step_rad), Err(GuardConfigError::Scanner));
    }
    assert_eq!(with(|config| config.lidar.elevations_rad.clear()), Err(GuardConfigError::Lidar));
    for (body_height_m, good) in [(0.1, false), (0.05, false), (0.1_f32.next_up(), true)] {
        let found = with(|config| config.lidar.body_height_m = body_height_m);
        assert_eq!(found, if good { Ok(()) } else { Err(GuardConfigError::Lidar) }, "{body_height_m}");
    }
}

#[test]
fn fg_req_013_deadlines_are_in_order() {
    for source in Source::ALL {
        let deadlines = |limit_us: u64, stop_us: Option<u64>| {
            with(|config| {
                let rules = &mut config.sources[source.index()];
                (rules.limit_after_us, rules.stop_after_us) = (limit_us, stop_us);
            })
        };
        assert_eq!(deadlines(0, Some(100)), Err(GuardConfigError::Deadline(source)));
        assert_eq!(deadlines(101, Some(100)), Err(GuardConfigError::Deadline(source)));
        assert_eq!((deadlines(100, Some(100)), deadlines(1, None)), (Ok(()), Ok(())));
        let mut config = config();
        config.sources[source.index()].limit_after_us = 77;
        assert_eq!(config.rules(source).limit_after_us, 77);
    }
}

#[test]
fn fg_req_020_fields_have_corners_and_contain_the_footprint() {
    let outcome = with(|config| config.fields.retain(|set| set.travel != Travel::Straight));
    assert_eq!(outcome, Err(GuardConfigError::NoForwardField));
    for corners in [0, 2] {
        assert_eq!(
            with(|config| config.fields[1].protective.truncate(corners)),
            Err(GuardConfigError::FieldCorners(1))
        );
        assert_eq!(
            with(|config| config.fields[2].warning.truncate(corners)),
            Err(GuardConfigError::FieldCorners(2))
        );
    }
    assert_eq!(with(|config| config.fields[0].warning.truncate(3)), Ok(()));
    let triangle = [(-3.0, -3.0), (6.0, 0.0), (-3.0, 3.0)].map(|(x_m, y_m)| Point2::new(x_m, y_m));
    assert_eq!(with(|config| config.fields[0].protective = triangle.into_iter().collect()), Ok(()));
    let narrow = |y_m: f32| with(|config| config.fields[0].protective = rectangle([-0.45, 1.25], y_m));
    assert_eq!((narrow(0.47), narrow(0.39)), (Ok(()), Err(GuardConfigError::FieldInsideFootprint(0))));
}

/// Least length before the body: way of the whole chain of 220 ms and of the response, braking with wear, supplement of the
/// scanner.
fn needed_m(speed_mps: f64) -> f64 {
    let braking_m = speed_mps * speed_mps / 1.6;
    speed_mps * (0.15 + 0.22) + braking_m + 0.1 * braking_m + 0.1
}

#[test]
fn fg_req_020_fields_are_as_long_as_stopping_distance() {
    for (travel, set) in [(Travel::Straight, 1), (Travel::Reverse, 3)] {
        for speed_mps in [0.1_f32, 0.3, 0.6, 1.0] {
            let needed = needed_m(f64::from(speed_mps)) as f32;
            let with_length = |length_m: f32| {
                with(|config| {
                    let backward = travel == Travel::Reverse;
                    let x_m = if backward { [-0.45 - length_m, 0.95] } else { [-0.45, 0.95 + length_m] };
                    config.fields[set].protective = rectangle(x_m, 0.5);
                    (config.fields[set].travel, config.fields[set].speed_max_mps) = (travel, speed_mps);
                })
            };
            assert_eq!(with_length(needed + 1.0e-4), Ok(()), "{travel:?} {speed_mps}");
            let Err(GuardConfigError::FieldTooShort { set: found, needed_m, given_m }) =
                with_length(needed - 5.0e-3)
            else {
                panic!("{travel:?} {speed_mps}: a field that is too short is accepted");
            };
            assert_eq!(found, set);
            assert!((needed_m - needed).abs() < 1.0e-5 && (given_m - needed + 5.0e-3).abs() < 1.0e-5);
        }
    }
}

/// Needles, notches, and fields for turning that end where the body begins.
#[test]
fn fg_req_061_a_field_contains_all_that_the_body_sweeps() {
    let set = |index: usize, travel: Travel, protective: Polygon| {
        with(|config| {
            config.fields[index].travel = travel;
            config.fields[index].protective = protective;
        })
    };
    let corners = |list: &[(f32, f32)]| list.iter().map(|(x_m, y_m)| Point2::new(*x_m, *y_m)).collect();
    // As wide as the body behind, two centimetres wide ahead of it.
    let needle: Polygon = corners(&[
        (-0.46, -0.41),
        (0.96, -0.41),
        (0.96, -0.01),
        (3.0, -0.01),
        (3.0, 0.01),
        (0.96, 0.01),
        (0.96, 0.41),
        (-0.46, 0.41),
    ]);
    let notched: Polygon =
        corners(&[(-0.5, -0.6), (3.0, -0.6), (3.0, 0.6), (1.4, 0.6), (1.3, 0.0), (1.2, 0.6), (-0.5, 0.6)]);
    for bad in [needle, notched, rectangle([-0.46, 3.0], 0.41)] {
        let found = set(1, Travel::Straight, bad.clone());
        assert!(matches!(found, Err(GuardConfigError::FieldTooNarrow { set: 1, .. })), "{found:?} {bad:?}");
    }
    assert_eq!(set(1, Travel::Straight, rectangle([-0.46, 3.0], 0.49)), Ok(()));
    // Turning on the spot with 0.8 rad/s swings the front corners far out to both sides.
    for (half_m, good) in [(0.5, false), (0.8, false), (1.15, true)] {
        let found = set(3, Travel::Spin, rectangle([-0.9, 1.15], half_m));
        assert_eq!(found.is_ok(), good, "spin {half_m}: {found:?}");
    }
    for (travel, sign) in [(Travel::Left, 1.0_f32), (Travel::Right, -1.0)] {
        let bend = |inner_m: f32, outer_m: f32| {
            let mut bend = rectangle([-0.8, 1.7], 1.0);
            for corner in &mut bend {
                corner.y_m = if corner.y_m * sign > 0.0 { sign * outer_m } else { -sign * inner_m };
            }
            set(1, travel, bend)
        };
        assert!(bend(0.75, 1.4).is_ok(), "{travel:?}: {:?}", bend(0.75, 1.4));
        assert!(bend(0.75, 0.6).is_err() && bend(0.41, 1.4).is_err(), "{travel:?}");
    }
}

#[test]
fn fg_req_020_stopping_distances_are_those_of_a_simulated_stop() {
    for (speed, response, acceleration, braking) in
        [(1.0, 0.15, 0.0, 0.8), (0.6, 0.23, 0.5, 1.2), (0.0, 0.5, 1.0, 1.5), (1.3, 0.0, 0.7, 0.6)]
    {
        let (mut travel, mut now, mut time) = (0.0_f64, speed, 0.0_f64);
        while now > 0.0 || time < response {
            let change = if time < response { acceleration } else { -braking };
            travel += (now + 0.5 * change * 1.0e-5) * 1.0e-5;
            now += change * 1.0e-5;
            time += 1.0e-5;
        }
        let found = stop_distance_m(speed as f32, response as f32, acceleration as f32, braking as f32);
        assert!((f64::from(found) - travel).abs() < 1.0e-3, "{found} {travel}");
    }
    assert!(stop_distance_m(0.0, 0.1, 0.0, 0.0).is_infinite());
    assert!(stop_distance_m(1.0, 0.1, 0.0, -1.0).is_infinite());
    assert_eq!(field_length_m(1.0, 0.5, 1.0, 0.25), stop_distance_m(1.0, 0.5, 0.0, 1.0) + 0.25);
}
