//! The whole robot against the simulator: bytes in, people seen, motors stopped, in virtual time.

use floorguard_laboratory::campaign::{encounter, run_seeds, single_fault};
use floorguard_laboratory::world::{Observation, Observer, Plan, load_scenario, run_virtual};
use floorguard_sim::FaultSpec;

fn play(plan: &Plan) -> Observation {
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(plan, &mut show);
    run_virtual(plan, &mut observer).unwrap();
    observer.into_observation()
}

fn plan(name: &str, seed: u64, seconds: u64) -> Plan {
    Plan::named(name, seed, seconds * 1_000_000).unwrap()
}

#[test]
fn drives_route_in_empty_hall_without_stops() {
    let seen = play(&plan("empty", 1, 60));
    assert!(seen.verdict.passed, "{:?}", seen.verdict);
    assert_eq!((seen.verdict.stops, seen.verdict.faulty_sources.len()), (0, 0), "{:?}", seen.stops);
    assert!(seen.ready_s.is_some_and(|ready_s| ready_s < 2.0), "ready within 2 s: {:?}", seen.ready_s);
    assert!(seen.verdict.distance_m > 30.0, "{}", seen.verdict.distance_m);
    // The route is a rectangle of 6 m × 3 m: odometry that drifts would leave it.
    for pose in &seen.robot_path {
        assert!((-2.0..8.0).contains(&pose.x_m) && (-1.5..4.5).contains(&pose.y_m), "{pose:?}");
    }
}

#[test]
fn stops_for_people_in_a_supermarket() {
    let seen = play(&plan("supermarket", 1, 40));
    assert!(seen.verdict.passed, "{:?}", seen.verdict);
    assert!(seen.verdict.stops > 0 && seen.verdict.distance_m > 5.0, "{:?}", seen.verdict);
    assert!(seen.verdict.mota.is_some_and(|mota| mota > 0.5), "{:?}", seen.verdict.mota);
}

#[test]
fn only_the_same_seed_gives_same_bits() {
    let digest = |seed| play(&plan("crossing", seed, 15)).verdict.digest;
    assert_eq!(digest(5), digest(5));
    assert_ne!(digest(5), digest(6));
}

#[test]
fn the_emergency_stop_latches_until_the_operator_resets() {
    let mut plan = plan("empty", 3, 25);
    plan.emergency_stop_us = vec![(8_000_000, 11_000_000)];
    let seen = play(&plan);
    let causes: Vec<&str> = seen.stops.iter().map(|stop| stop.kind.as_str()).collect();
    assert!(causes.iter().any(|cause| cause.contains("emergency stop")), "{causes:?}");
    // Pressed at 8 s, released at 11 s, reset three seconds later at the earliest.
    assert!(seen.path_m(9.5, 13.5) < 0.01, "{}", seen.path_m(9.5, 13.5));
    assert!(seen.resets >= 1 && seen.path_m(18.0, 24.0) > 1.0, "{} {}", seen.resets, seen.path_m(18.0, 24.0));
    assert!(seen.verdict.passed);
}

#[test]
fn a_slice_of_random_encounters() {
    let summary = run_seeds(1_000..1_016, encounter).unwrap();
    assert!(summary.failures.is_empty(), "{:#?}", summary.failures);
    assert!(summary.stops > 0 && summary.distance_m > 50.0, "{summary:?}");
}

#[test]
fn a_slice_of_random_single_faults() {
    let summary = run_seeds(1_000..1_024, single_fault).unwrap();
    assert!(summary.failures.is_empty(), "{:#?}", summary.failures);
}

/// Each device in turn comes four seconds late, and later its line is cut for two seconds: the robot is ready within two
/// seconds after the last source, stands while the line is cut, and goes on afterwards.
#[test]
fn late_devices_and_cut_lines_are_survived() {
    for line in ["lidar", "scanner", "imu", "can"] {
        let mut plan = plan("empty", 3, 20);
        for text in [format!("{line}:silent,from=0s,to=4s"), format!("{line}:silent,from=8s,to=10s")] {
            plan.faults.push(FaultSpec::parse(&text).unwrap());
        }
        let seen = play(&plan);
        assert!(seen.verdict.passed, "{line}: {:?}", seen.verdict);
        assert!(
            seen.ready_s.is_some_and(|at_s| (4.0..6.0).contains(&at_s)),
            "{line}: ready {:?}",
            seen.ready_s
        );
        let (before_m, after_m) = (seen.path_m(5.0, 8.0), seen.path_m(16.0, 20.0));
        assert!(before_m > 0.5, "{line}: {before_m} m before");
        assert!(after_m > 0.5, "{line}: {after_m} m after; {:?}", seen.under_cause_s);
        println!(
            "{line}: ready {:?}, stops {:?}",
            seen.ready_s,
            seen.stops.iter().map(|stop| &stop.cause).collect::<Vec<_>>()
        );
    }
}

/// A scenario file with a map of walls and a recording of people beside it, as a user would write them.
#[test]
fn world_has_map_walls_and_recorded_people() {
    let folder = tempfile::tempdir().unwrap();
    // A room of 8 m × 4 m with walls of one cell; the robot drives along it, a person walks across its end.
    let mut picture = image::GrayImage::from_pixel(82, 42, image::Luma([254]));
    for (x, y, pixel) in picture.enumerate_pixels_mut() {
        if x == 0 || y == 0 || x == 81 || y == 41 {
            *pixel = image::Luma([0]);
        }
    }
    picture.save(folder.path().join("room.png")).unwrap();
    let map = "image: room.png\nresolution: 0.1\norigin: [-2.0, -2.1, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    std::fs::write(folder.path().join("room.yaml"), map).unwrap();
    let walk: String = (0..40)
        .map(|i| format!("{:.1},7,4.5,{:.2}\n", f64::from(i) * 0.5, 1.6 - f64::from(i) * 0.08))
        .collect();
    std::fs::write(folder.path().join("walk.csv"), format!("time_s,id,x_m,y_m\n{walk}")).unwrap();
    let scenario = "title = \"a room\"\n[route]\nspeed_mps = 0.5\nwaypoints_m = [[5.0, 0.0]]\n\
        [scene.map]\nfile = \"room.yaml\"\n[recorded]\nfile = \"walk.csv\"\n";
    std::fs::write(folder.path().join("room.toml"), scenario).unwrap();
    let scenario = load_scenario(&folder.path().join("room.toml")).unwrap();
    let seen = play(&Plan::of("room", scenario, 1, 19_000_000).unwrap());
    assert!(seen.verdict.passed, "{:?}", seen.verdict);
    let path = &seen.people_paths[&1];
    assert!(path.iter().all(|place| (place.x_m - 4.5).abs() < 1e-3) && path.len() > 70, "{}", path.len());
    assert!(seen.verdict.mota.is_some_and(|mota| mota > 0.5), "{:?}", seen.verdict);
    let farthest_m = seen.robot_path.iter().map(|pose| pose.x_m).fold(f32::MIN, f32::max);
    // The wall is at 6 m, the body reaches 0.95 m ahead.
    assert!((1.0..5.0).contains(&farthest_m), "{farthest_m}");
    let missing = load_scenario(&folder.path().join("none.toml")).unwrap_err();
    assert!(format!("{missing:#}").contains("none.toml"), "{missing:#}");
}
