//! What a mission does at a moment, without a world around it: where its time goes, what it saves, how it goes round somebody.

use super::*;
use floorguard_configuration::{EXAMPLE, parse};
use floorguard_guard::AdvisedPerson;
use floorguard_types::motion::{Gear, Waypoint};

/// A mission in a supermarket.
fn begun() -> (MissionPlan, Cleaner) {
    begun_with(Store::Memory(Arc::default()))
}

fn begun_with(store: Store) -> (MissionPlan, Cleaner) {
    let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
    let plan = MissionPlan::supermarket();
    let cleaner = Cleaner::new(&plan, &robot, (SharedWatch::default(), store)).unwrap();
    (plan, cleaner)
}

fn paused_at(ms: u64) -> MissionMoment<'static> {
    let now = Stamp::from_micros(ms * 1_000);
    MissionMoment {
        now,
        pose: StampedPose { stamp: now, ..StampedPose::default() },
        scan: None,
        dirt: None,
        decision: None,
        people: None,
        floor: None,
        is_paused: true,
    }
}

/// From the moment to the verdict: every second has a reason, and what people cost is computed from the same
/// seconds.
#[test]
fn time_use_is_reported_to_the_end() {
    let (_, mut cleaner) = begun();
    for ms in [0, 500, 1_000] {
        cleaner.step(&paused_at(ms));
    }
    assert_eq!(cleaner.times.of(TimeUse::Paused), 1.0);
    cleaner.times.add(TimeUse::HeldPersonApproaches, (Twist2::ZERO, Twist2::ZERO), 3.0);
    cleaner.detours = 2;
    let progress = cleaner.progress(Stamp::ZERO);
    assert_eq!((progress.waited_s, progress.times, progress.detours), (3.0, cleaner.times, 2));
    let reported: Vec<_> = progress.times.iter().collect();
    assert!(
        reported.contains(&(TimeUse::HeldPersonApproaches, 3.0))
            && reported.contains(&(TimeUse::Paused, 1.0)),
        "{reported:?}"
    );
}

/// A power cut finds the newest save; after the end there is nothing to go on with.
#[test]
fn save_is_removed_when_mission_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::File(folder.path().join("mission.fgm"));
    let (plan, mut cleaner) = begun_with(store.clone());
    let cells = cleaner.ground.raster().cell_count();
    cleaner.step(&paused_at(0));
    assert!(store.load(&plan, cells).is_some());
    cleaner.phase = MissionPhase::Done;
    cleaner.step(&paused_at(2_000));
    assert!(store.load(&plan, cells).is_none());
}

/// Held at a place it takes another path to the same dirt; held there for long it leaves the dirt for later.
#[test]
fn persistent_blocker_is_bypassed_then_postponed() {
    let (_, mut cleaner) = begun();
    let pose = cleaner.pose();
    cleaner.near.is_leaving = true;
    assert!(cleaner.choose(pose, 0.0) && !cleaner.near.is_leaving, "on a path to dirt it does not retreat");
    let target = cleaner.target.unwrap();
    let nowhere = Waypoint { pose_in_map: Pose2::new(99.0, 99.0, 0.0), gear: Gear::Ahead };
    cleaner.track = Track::new(vec![nowhere; 3]);
    cleaner.go_round(pose, 1.0);
    assert_eq!((cleaner.detours, cleaner.target), (1, Some(target)));
    assert!(cleaner.track.rest().last().is_some_and(|end| end.pose_in_map.x_m < 50.0), "another path");
    cleaner.go_round(pose, 7.0);
    assert_eq!((cleaner.detours, cleaner.target), (2, None));
    assert!(cleaner.postponed.iter().any(|(cell, _)| *cell == target));
}

/// Held by somebody who stands near, it backs off before it searches another path.
#[test]
fn robot_held_by_standing_person_retreats() {
    let (_, mut cleaner) = begun();
    let position = Point2::new(1.55, 0.3);
    let person = AdvisedPerson { position, position_sigma_m: 0.07, ..AdvisedPerson::default() };
    cleaner.near.people = vec![person];
    cleaner.obstacles.see_people(&[(cleaner.pose().transform(position), 0.33)], 0.0);
    cleaner.near.seen_s = 0.0;
    cleaner.held_s = 5.5;
    let requested = cleaner.decide(0.1);
    assert!(
        cleaner.near.is_leaving && requested.linear_mps < 0.0 && requested.angular_radps.abs() < 0.05,
        "{requested:?}"
    );
}

/// What stands there stays, and most people go on: they are waited for longer.
#[test]
fn people_are_waited_for_longer_than_objects() {
    let detours_after = |held_s: f32, cause: Cause, person_x_m: Option<f32>| {
        let (_, mut cleaner) = begun();
        let at = |x_m: f32| AdvisedPerson { position: Point2::new(x_m, 0.9), ..AdvisedPerson::default() };
        cleaner.near.people = person_x_m
            .map(|x_m| AdvisedPerson { velocity_mps: Point2::new(0.6, 0.0), ..at(x_m) })
            .into_iter()
            .collect();
        cleaner.near.seen_s = 0.0;
        (cleaner.held_s, cleaner.held_by) = (held_s, Some(cause));
        cleaner.decide(0.1);
        cleaner.detours
    };
    assert_eq!(detours_after(3.0, Cause::LidarProtective, None), 1);
    assert_eq!(detours_after(3.0, Cause::LidarProtective, Some(6.0)), 1, "far away");
    assert_eq!(detours_after(3.0, Cause::LidarProtective, Some(1.5)), 0, "it may be them");
    assert_eq!(detours_after(3.0, Cause::WayClosed, Some(1.5)), 1, "what the guard remembers is nobody");
    assert_eq!(detours_after(3.0, Cause::CollisionStop, None), 0);
    assert_eq!(detours_after(7.0, Cause::CollisionStop, None), 1);
}

/// A mission whose brush stands on the last cells of it.
fn on_the_last_cells() -> (Cleaner, Pose2) {
    let (_, mut cleaner) = begun();
    for step in 1..=14_u8 {
        let odometry = Pose2::new(0.1 * f32::from(step), 0.0, 0.0);
        cleaner.localiser.update(&cleaner.ground.floor, odometry, &[], false);
    }
    assert!(cleaner.localiser.active_cells() > 0);
    let pose = cleaner.localiser.pose(Pose2::new(1.4, 0.0, 0.0));
    (cleaner, pose)
}

/// People who block the robot on its last cells do not end the mission: these cells would never be claimed.
#[test]
fn interrupted_departures_do_not_end_it() {
    let (mut cleaner, pose) = on_the_last_cells();
    for second in 0..100_u8 {
        assert!(cleaner.end(pose, f32::from(second)));
        cleaner.track = Track::default();
    }
    assert_ne!(cleaner.phase, MissionPhase::Done);
    // Two minutes of attempts do.
    assert!(!cleaner.end(pose, 121.0));
    assert_eq!(cleaner.phase, MissionPhase::Done);
}

#[test]
fn six_completed_departures_end_it() {
    let (mut cleaner, pose) = on_the_last_cells();
    for _ in 0..6 {
        // Before, the robot retreated from a person.
        cleaner.near.is_leaving = true;
        assert!(cleaner.end(pose, 1.0));
        cleaner.arrive();
    }
    assert!(!cleaner.end(pose, 1.0));
    assert_eq!(cleaner.phase, MissionPhase::Done);
}
