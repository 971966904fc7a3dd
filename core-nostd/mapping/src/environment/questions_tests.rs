//! A corridor that is busy by day, and answers that are plain to see.

use super::super::place::SLICE_S;
use super::*;
use std::{vec, vec::Vec};

type Corridor = Place<168, 84>;

/// A Monday, 00:00 UTC.
const MONDAY_S: i64 = 1_775_433_600;

/// Three weeks: twice in ten minutes from 07:00 to 21:59, except at 14:00 to 14:59; otherwise nobody.
fn corridor() -> Corridor {
    let mut place = Corridor::default();
    for slice in 0..3 * 1_008 {
        let at = WallTime::from_seconds(MONDAY_S + slice * SLICE_S + 300);
        place.watch((at, 0), 60_000);
        let hour = at.local(0).hour();
        if (7..22).contains(&hour) && hour != 14 {
            place.note((at, 0), true, 30);
            place.note((at, 0), true, 30);
        }
    }
    place.turn_to(WallTime::from_seconds(MONDAY_S + 3 * 604_800 + SLICE_S), 0);
    place
}

fn profile(places: &[Corridor], hour: i64) -> Profile {
    Profile::new(places.iter(), WallTime::from_seconds(MONDAY_S + 3 * 604_800 + hour * 3_600), 0)
}

#[test]
fn best_time_is_quiet_and_earlier_with_haste() {
    let places = vec![corridor(); 3];
    let profile = profile(&places, 9);
    let calm = best_time(&profile, 96, 2, 0.0).unwrap();
    let hour = calm.start.local(0).hour();
    assert!(!(6..22).contains(&hour), "{hour}");
    assert!(calm.encounters.per_hour < 0.4 && calm.encounters_now.per_hour > 4.0, "{calm:?}");
    let hasty = best_time(&profile, 96, 2, 0.35).unwrap();
    assert_eq!(hasty.start.local(0).hour(), 14, "{hasty:?}");
    let at_once = best_time(&profile, 96, 2, 100.0).unwrap();
    assert_eq!(at_once.step, 0);
}

#[test]
fn wet_only_where_it_dries_in_peace() {
    let places = vec![corridor()];
    let by_night = profile(&places, 26);
    assert_eq!(wetness(&by_night.steps[0], 0.2), Wetness::Wet, "{:?}", by_night.steps[0]);
    let by_day = profile(&places, 10);
    assert_eq!(wetness(&by_day.steps[0], 0.2), Wetness::Dry);
    assert!(presence(&by_day, 0, 4) > 0.8 && presence(&by_night, 0, 4) < 0.1);
    let nothing = profile(&[Corridor::default()], 10);
    assert_eq!(wetness(&nothing.steps[0], 0.2), Wetness::DryUnknown);
    assert_eq!((nothing.places, nothing.known_places), (1, 0));
}

#[test]
fn nothing_known_is_no_answer() {
    let none: Vec<Corridor> = Vec::new();
    assert_eq!(best_time(&profile(&none, 0), 672, 4, 0.0), None);
    assert_eq!(best_time(&profile(&[Corridor::default()], 0), usize::MAX, usize::MAX, f32::NAN), None);
}

#[test]
fn zones_and_paths_are_weighed() {
    assert!(removal_per_encounter(5.0, 0.0) > removal_per_encounter(5.0, 1.0));
    assert_eq!((cost_multiplier(0.0), cost_multiplier(1.0), cost_multiplier(7.0)), (1.0, 4.0, 4.0));
}
