//! What must end in a stated doubt and never in a confident wrong place: a kidnapped robot, a lift ride, the map of another
//! building, a glass corridor, an empty hall, a corridor without features, scans that freeze or come out of order, no odometry.

use super::campaign::{Building, Random, STEP_S, WRONG, World, beam_rad, drive, scan};
use super::*;
use crate::input::ScanRecord;
use crate::se2::Se2;

/// A scan of a drive with the true place.
#[derive(Clone)]
struct Moment {
    truth: Se2,
    /// Whether the truth is a place of the localiser's map.
    is_in_map: bool,
    record: ScanRecord,
}

/// How a drive went, from a moment on.
#[derive(Debug, Default)]
struct Outcome {
    found_s: Option<f64>,
    doubt_s: Option<f64>,
    help_s: Option<f64>,
    wrong_s: f64,
    most_sigmas: f64,
    deviation_most_m: f64,
}

/// Scans of a path with 1 cm of noise and wheels that slip by 2 %; time and odometry go on from `from`.
fn moments(world: &World, path: &[Se2], (from_s, from): (f64, Se2), random: &mut Random) -> Vec<Moment> {
    let mut odometry = from;
    let mut all = Vec::new();
    for (index, pose) in path.iter().enumerate() {
        if let Some(before) = index.checked_sub(1) {
            let step = path[before].between(*pose);
            let slip = 1.0 + 0.02 * random.normal();
            odometry = odometry.compose(Se2::new(step.x_m * slip, step.y_m, step.heading_rad * slip));
        }
        let ranges = scan(world, pose, 2).into_iter().map(|range| (range + 0.01 * random.normal()) as f32);
        let record = ScanRecord {
            time_s: from_s + STEP_S * index as f64,
            odometry: Some(odometry),
            first_angle_rad: beam_rad(0) as f32,
            step_rad: 1.0_f32.to_radians(),
            ranges_m: ranges.collect(),
            ..ScanRecord::default()
        };
        all.push(Moment { truth: *pose, is_in_map: true, record });
    }
    all
}

/// Continues a drive elsewhere: nothing tells the wheels.
fn followed_by(first: Vec<Moment>, world: &World, path: &[Se2], random: &mut Random) -> Vec<Moment> {
    let last = first.last().map(|moment| moment.record.clone()).unwrap();
    let from = (last.time_s + STEP_S, last.odometry.unwrap_or_default());
    let next = moments(world, path, from, random);
    first.into_iter().chain(next).collect()
}

fn localiser(map: &World) -> Localiser {
    let config = LocaliseConfig::default();
    Localiser::new(KnownMap::new(map.map(), &config).unwrap(), config)
}

/// Runs a drive; the outcome counts from `from_s` on, and a wrong place from two seconds later on.
fn outcome(localiser: &mut Localiser, drive: &[Moment], from_s: f64) -> Outcome {
    let mut outcome = Outcome::default();
    // An answer is the place of the latest scan, also where an older one comes after it.
    let mut latest = (f64::NEG_INFINITY, Se2::default());
    for Moment { truth, is_in_map, record } in drive {
        let located = localiser.push(record);
        if record.time_s > latest.0 {
            latest = (record.time_s, *truth);
        }
        let truth = latest.1;
        let since_s = record.time_s - from_s;
        if since_s < 0.0 {
            continue;
        }
        if located.belief != Belief::Found {
            outcome.doubt_s = outcome.doubt_s.or(Some(since_s));
        }
        if located.asks_for_help {
            outcome.help_s = outcome.help_s.or(Some(since_s));
        }
        outcome.deviation_most_m = outcome.deviation_most_m.max(located.deviation_m);
        let Some(pose) = located.pose else { continue };
        let off = truth.between(pose);
        if *is_in_map && located.deviation_m > 0.0 {
            outcome.most_sigmas = outcome.most_sigmas.max(off.length_m() / located.deviation_m);
        }
        if located.belief == Belief::Found {
            let is_wrong = !is_in_map || off.length_m() > WRONG.0 || off.heading_rad.abs() > WRONG.1;
            if is_wrong && since_s > 2.0 {
                outcome.wrong_s += STEP_S;
            } else if !is_wrong && outcome.doubt_s.is_some() {
                outcome.found_s = outcome.found_s.or(Some(since_s));
            }
        }
    }
    outcome
}

fn building(seed: u64) -> World {
    let building = Building::random(&mut Random::new(seed));
    building.with(&building.furniture)
}

/// A path of some seconds in a world.
fn path(world: &World, seed: u64, seconds: f64) -> Vec<Se2> {
    let path = drive(world, &mut Random::new(seed)).unwrap();
    path.into_iter().take((seconds / STEP_S) as usize).collect()
}

#[test]
fn kidnapped_robot_notices_and_recovers() {
    let world = building(3);
    let seed = 11;
    let mut random = Random::new(seed);
    let before = moments(&world, &path(&world, seed, 14.0), (0.0, Se2::default()), &mut random);
    let drive = followed_by(before, &world, &path(&world, 40 + seed, 14.0), &mut random);
    let outcome = outcome(&mut localiser(&world), &drive, 14.0);
    assert!(outcome.doubt_s.is_some_and(|at_s| at_s <= 2.0), "{outcome:?}");
    let again_s = outcome.found_s.into_iter().chain(outcome.help_s).fold(f64::INFINITY, f64::min);
    assert!(again_s <= 12.5 && outcome.wrong_s == 0.0, "{outcome:?}");
}

#[test]
fn other_floors_and_buildings_stay_unknown() {
    let (here, there) = (building(4), building(5));
    let mut random = Random::new(21);
    let mut ride = moments(&here, &path(&here, 22, 12.0), (0.0, Se2::default()), &mut random);
    ride = followed_by(ride, &there, &path(&there, 23, 16.0), &mut random);
    ride.iter_mut().filter(|moment| moment.record.time_s >= 12.0).for_each(|moment| moment.is_in_map = false);
    let lift = outcome(&mut localiser(&here), &ride, 12.0);
    assert!(lift.doubt_s.is_some_and(|at_s| at_s <= 2.0) && lift.wrong_s == 0.0, "{lift:?}");
    assert!(lift.help_s.is_some(), "{lift:?}");
}

#[test]
fn corrupted_scans_raise_doubt() {
    let world = building(6);
    let mut random = Random::new(31);
    let whole = moments(&world, &path(&world, 32, 20.0), (0.0, Se2::default()), &mut random);
    let mut frozen = whole.clone();
    let still = frozen[140].record.ranges_m.clone();
    frozen[140..].iter_mut().for_each(|moment| moment.record.ranges_m.clone_from(&still));
    let outcome_frozen = outcome(&mut localiser(&world), &frozen, 14.0);
    assert!(outcome_frozen.doubt_s.is_some_and(|at_s| at_s < 1.0), "{outcome_frozen:?}");
    assert_eq!(outcome_frozen.wrong_s, 0.0, "{outcome_frozen:?}");

    let mut shuffled = whole.clone();
    shuffled.chunks_exact_mut(10).for_each(|ten| ten.swap(3, 6));
    let mut robot = localiser(&world);
    let outcome_shuffled = outcome(&mut robot, &shuffled, 0.0);
    assert!(robot.statistics.not_later >= 40, "{:?}", robot.statistics);
    assert!(outcome_shuffled.wrong_s == 0.0 && outcome_shuffled.found_s.is_some(), "{outcome_shuffled:?}");

    let mut alone = whole;
    alone[100..].iter_mut().for_each(|moment| moment.record.odometry = None);
    let outcome_alone = outcome(&mut localiser(&world), &alone, 0.0);
    assert!(outcome_alone.wrong_s == 0.0 && outcome_alone.found_s.is_some(), "{outcome_alone:?}");
}

/// From the left end to the right one, 0.8 m/s.
fn along(length_m: f64, y_m: f64) -> Vec<Se2> {
    (0..((length_m - 4.0) / 0.08) as usize).map(|step| Se2::new(2.0 + 0.08 * step as f64, y_m, 0.0)).collect()
}

fn room(width_m: f64, height_m: f64) -> World {
    let mut world = World::new(width_m, height_m);
    world.draw([[0.0, 0.0], [width_m, 0.1]]);
    world.draw([[0.0, height_m - 0.1], [width_m, height_m]]);
    world.draw([[0.0, 0.0], [0.1, height_m]]);
    world.draw([[width_m - 0.1, 0.0], [width_m, height_m]]);
    world
}

#[test]
fn places_without_features_are_never_certain_and_wrong() {
    // A scanner that sees 12 m, as many do on dark walls.
    let short = |mut drive: Vec<Moment>| {
        let far = |range: &mut f32| *range = if *range > 12.0 { f32::INFINITY } else { *range };
        drive.iter_mut().for_each(|moment| moment.record.ranges_m.iter_mut().for_each(far));
        drive
    };
    let mut random = Random::new(51);
    let corridor = room(60.0, 2.4);
    let drive = short(moments(&corridor, &along(60.0, 1.2), (0.0, Se2::default()), &mut random));
    let unknown = outcome(&mut localiser(&corridor), &drive, 0.0);
    assert_eq!(unknown.wrong_s, 0.0, "corridor: {unknown:?}");

    let hall = room(60.0, 60.0);
    let drive = short(moments(&hall, &along(60.0, 30.0), (0.0, Se2::default()), &mut random));
    let unknown = outcome(&mut localiser(&hall), &drive, 0.0);
    assert_eq!(unknown.wrong_s, 0.0, "hall: {unknown:?}");
    assert!(unknown.help_s.is_some(), "hall: {unknown:?}");

    // Glass: the map knows the walls, the scanner sees every twelfth return on them.
    let world = building(7);
    let mut drive = moments(&world, &path(&world, 53, 20.0), (0.0, Se2::default()), &mut random);
    for moment in drive.iter_mut().filter(|moment| moment.record.time_s > 12.0) {
        let seen = |(index, range): (usize, &mut f32)| {
            *range = if index % 12 == 0 { *range } else { (*range + 3.0).min(30.0) };
        };
        moment.record.ranges_m.iter_mut().enumerate().for_each(seen);
    }
    let glass = outcome(&mut localiser(&world), &drive, 12.0);
    assert!(glass.wrong_s == 0.0 && glass.doubt_s.is_some_and(|at_s| at_s <= 2.0), "glass: {glass:?}");
}

#[test]
fn doubt_grows_along_a_corridor() {
    // An alcove at the left end shows where the drive begins; the rest of the 60 m is smooth.
    let mut corridor = room(64.0, 12.0);
    corridor.draw([[6.0, 0.0], [64.0, 4.0]]);
    corridor.draw([[6.0, 6.4], [64.0, 12.0]]);
    corridor.draw([[2.0, 2.0], [2.8, 2.6]]);
    corridor.draw([[1.0, 8.0], [2.2, 8.4]]);
    let turn = (0..63).map(|step| Se2::new(3.5, 5.2, 0.1 * f64::from(step)));
    let out = (0..=20).map(|step| Se2::new(3.5 + 0.08 * f64::from(step), 5.2, 0.0));
    let back = (0..=20).map(|step| Se2::new(5.1 - 0.08 * f64::from(step), 5.2, 0.0));
    let way = (0..560).map(|step| Se2::new(3.5 + 0.08 * f64::from(step), 5.2, 0.0));
    let path: Vec<Se2> = turn.chain(out).chain(back).chain(way).collect();
    let mut drive = moments(&corridor, &path, (0.0, Se2::default()), &mut Random::new(61));
    let far = |range: &mut f32| *range = if *range > 8.0 { f32::INFINITY } else { *range };
    drive.iter_mut().for_each(|moment| moment.record.ranges_m.iter_mut().for_each(far));
    let course = outcome(&mut localiser(&corridor), &drive, 11.0);
    assert!(course.deviation_most_m > 1.0 && course.doubt_s.is_some(), "{course:?}");
    assert!(course.most_sigmas < 3.0 && course.wrong_s == 0.0, "{course:?}");
}
