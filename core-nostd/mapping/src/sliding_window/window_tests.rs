use super::super::cell::CellContent;
use super::super::{
    BoxError, CellPolicy, ColumnScan, MotorSample, MotorTrack, PersonBox, PersonBoxes, ScanError,
    SlidingWindow, WindowCell, WindowGeometry, WindowOptions,
};
use floorguard_types::geometry::{Point3, Pose2};
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;
use proptest::prelude::*;
use std::vec;
use std::vec::Vec;

type Window = SlidingWindow<Vec<WindowCell>>;

fn window(policy: CellPolicy) -> Window {
    let geometry = WindowGeometry::of_resolution(0.05).unwrap();
    let buffers = [0, 1].map(|_| vec![WindowCell::EMPTY; geometry.cells()]);
    SlidingWindow::new(geometry, WindowOptions::published(policy), buffers).unwrap()
}

/// The motor turns at 0.3 rad/s, right through the direction ahead at one second.
fn motor(until_ms: u64) -> MotorTrack {
    let mut motor = MotorTrack::new();
    for millis in (0..=until_ms).step_by(10) {
        let angle_rad = 0.3e-3 * (millis as f32 - 1_000.0);
        let stamp = Stamp::from_micros(1_000 * millis);
        motor.push(MotorSample { stamp, angle_rad, commanded_radps: 0.3 }).unwrap();
    }
    motor
}

fn scan(beams: &[BeamReturn], millis: u64) -> ColumnScan<'_> {
    ColumnScan {
        first_beam: Stamp::from_micros(1_000 * millis),
        beam_period_us: 97.656_25,
        first_elevation_rad: -0.3,
        step_rad: 0.006_136,
        beams,
    }
}

/// A wall at a distance ahead, or nothing measured.
fn wall(range_mm: Option<u16>) -> [BeamReturn; 100] {
    [range_mm.map_or(BeamReturn::Unknown, BeamReturn::Hit); 100]
}

fn surfaces(window: &Window) -> Vec<(usize, WindowCell)> {
    let cells = super::super::Face::ALL.into_iter().flat_map(|face| window.cells(face).iter().copied());
    cells.enumerate().filter(|(_, cell)| cell.content() != CellContent::Empty).collect()
}

#[test]
fn refused_scans_change_nothing() {
    let mut window = window(CellPolicy::Nearest);
    let beams = wall(Some(2_000));
    window.insert(&scan(&beams, 1_000), &motor(1_200), Pose2::default()).unwrap();
    let before = surfaces(&window);
    assert!(before.len() > 5);
    let moved = Pose2::new(0.3, 0.0, 0.2);
    let mut stalled = motor(1_200);
    for millis in (1_210..=1_600).step_by(10) {
        let stamp = Stamp::from_micros(1_000 * millis);
        stalled.push(MotorSample { stamp, angle_rad: 0.06, commanded_radps: 0.3 }).unwrap();
    }
    let far = ColumnScan { beam_period_us: f32::NAN, ..scan(&beams, 1_100) };
    let not_finite = Pose2 { x_m: f32::NAN, ..Pose2::default() };
    let refused = [
        (scan(&beams, 1_000), motor(1_200), moved, ScanError::OutOfOrder { behind_us: 0 }),
        (scan(&beams, 950), motor(1_200), moved, ScanError::OutOfOrder { behind_us: 50_000 }),
        (scan(&beams, 1_550), stalled, moved, ScanError::MotorStalled { standing_us: 400_000 }),
        (scan(&beams, 1_220), motor(1_200), moved, ScanError::AngleMissing { gap_us: 20_000 }),
        (scan(&beams[..1], 1_100), motor(1_200), moved, ScanError::BeamCount { beams: 1 }),
        (far, motor(1_200), moved, ScanError::NotFinite),
        (scan(&beams, 1_100), motor(1_200), not_finite, ScanError::NotFinite),
    ];
    for (scan, motor, pose, error) in refused {
        assert_eq!(window.insert(&scan, &motor, pose), Err(error));
        assert_eq!(surfaces(&window), before, "{error}");
        assert_eq!(window.frame_in_odometry(), Pose2::default());
    }
    // And the next good one goes on.
    assert!(window.insert(&scan(&beams, 1_100), &motor(1_200), Pose2::default()).is_ok());
}

#[test]
fn refused_boxes_change_nothing() {
    let mut window = window(CellPolicy::Nearest);
    let beams = wall(Some(2_000));
    window.insert(&scan(&beams, 1_000), &motor(1_200), Pose2::default()).unwrap();
    let before = surfaces(&window);
    let now = Stamp::from_micros(1_100_000);
    let ahead = PersonBox {
        azimuth_min_rad: -0.2,
        azimuth_max_rad: 0.2,
        elevation_min_rad: -1.0,
        elevation_max_rad: 1.0,
    };
    let take = |window: &mut Window, boxes: &[PersonBox], millis: u64, base_in_odometry: Pose2| {
        let stamp = Stamp::from_micros(1_000 * millis);
        window.take_people(&PersonBoxes { stamp, base_in_odometry, boxes }, now)
    };
    let origin = Pose2::default();
    assert_eq!(take(&mut window, &[], 1_050, origin), Ok(0));
    let upside_down = PersonBox { elevation_max_rad: -1.1, ..ahead };
    let endless = PersonBox { azimuth_min_rad: f32::NAN, ..ahead };
    let nowhere = Pose2 { heading_rad: f32::INFINITY, ..origin };
    let refused = [
        (vec![ahead], 1_050, origin, BoxError::OutOfOrder { behind_us: 0 }),
        (vec![ahead], 1_040, origin, BoxError::OutOfOrder { behind_us: 10_000 }),
        (vec![ahead], 1_121, origin, BoxError::Future { ahead_us: 21_000 }),
        (vec![ahead; 17], 1_090, origin, BoxError::TooMany { boxes: 17 }),
        (vec![ahead, upside_down], 1_090, origin, BoxError::Bounds { index: 1 }),
        (vec![endless], 1_090, origin, BoxError::Bounds { index: 0 }),
        (vec![ahead], 1_090, nowhere, BoxError::NotFinite),
    ];
    for (boxes, millis, pose, error) in refused {
        assert_eq!(take(&mut window, &boxes, millis, pose), Err(error));
        assert_eq!(surfaces(&window), before, "{error}");
    }
    let late = Stamp::from_micros(1_700_000);
    let boxes = PersonBoxes { stamp: now, base_in_odometry: origin, boxes: &[ahead] };
    assert_eq!(window.take_people(&boxes, late), Err(BoxError::Stale { age_us: 600_000 }));
    assert_eq!(surfaces(&window), before);
    assert_eq!(take(&mut window, &[ahead], 1_100, origin).unwrap() as usize, before.len());
    assert!(surfaces(&window).iter().all(|(_, cell)| cell.content() == CellContent::Person));
    window.expire(Stamp::from_micros(3_200_000));
    assert!(surfaces(&window).is_empty());
}

#[test]
fn boxes_reach_across_the_back() {
    let mut window = window(CellPolicy::Nearest);
    // The robot faces backwards in odometry: ahead of it is ±180°.
    let pose = Pose2::new(0.0, 0.0, core::f32::consts::PI);
    let beams = wall(Some(2_000));
    window.insert(&scan(&beams, 1_000), &motor(1_200), pose).unwrap();
    let boxes = [PersonBox {
        azimuth_min_rad: 3.0,
        azimuth_max_rad: -3.0,
        elevation_min_rad: -1.0,
        elevation_max_rad: 1.0,
    }];
    let stamp = Stamp::from_micros(1_100_000);
    let behind = PersonBoxes { stamp, base_in_odometry: pose, boxes: &boxes };
    assert_eq!(window.take_people(&behind, stamp), Ok(0), "behind the robot is no person");
    let stamp = stamp.plus_micros(1);
    let ahead = PersonBoxes { stamp, base_in_odometry: Pose2::default(), boxes: &boxes };
    assert!(window.take_people(&ahead, stamp).unwrap() > 5);
}

/// Sweeps over a wall at 2 m, then over the same directions with other returns.
fn swept(second: &[BeamReturn]) -> Window {
    let mut window = window(CellPolicy::Nearest);
    let beams = wall(Some(2_000));
    for step in 0..5 {
        window.insert(&scan(&beams, 1_000 + 100 * step), &motor(1_600), Pose2::default()).unwrap();
    }
    // Back to where the first column was, and over the columns again.
    let mut motor = MotorTrack::new();
    for millis in (2_900..=3_600_u64).step_by(10) {
        let angle_rad = 0.3e-3 * (millis as f32 - 3_000.0);
        let stamp = Stamp::from_micros(1_000 * millis);
        motor.push(MotorSample { stamp, angle_rad, commanded_radps: 0.3 }).unwrap();
    }
    for step in 0..5 {
        window.insert(&scan(second, 3_000 + 100 * step), &motor, Pose2::default()).unwrap();
    }
    window
}

#[test]
fn only_evidence_empties_cells() {
    let unchanged = swept(&wall(Some(2_000)));
    let walls = surfaces(&unchanged).len();
    assert_eq!(unchanged.counters().cells_cleared, 0);
    // Nothing was measured: the wall stays.
    assert_eq!(surfaces(&swept(&wall(None))).len(), walls);
    // Something stands before it: it stays.
    assert_eq!(swept(&wall(Some(1_000))).counters().cells_cleared, 0);
    // Seen through, to another wall or to nothing within the range: it is gone but for its ends.
    for behind in [wall(Some(3_000)), [BeamReturn::Free(4_000); 100]] {
        let window = swept(&behind);
        let cleared = window.counters().cells_cleared as usize;
        assert!(cleared * 10 > walls * 6, "{cleared} of {walls}");
    }
}

#[test]
fn policies_differ_behind_an_edge() {
    // Two points of one cell, the farther one later.
    let near = Point3::new(1.0, 0.02, 0.41);
    let far = Point3::new(1.3, 0.02, 0.44);
    let value = |policy, points: &[Point3]| {
        let mut window = window(policy);
        window.insert_points(points, Pose2::default(), Stamp::ZERO).unwrap();
        let point = window.points().next().unwrap().point;
        (window.points().count(), (1_000.0 * point.x_m).round())
    };
    assert_eq!(value(CellPolicy::Compat, &[near, far]), (1, 1_300.0));
    assert_eq!(value(CellPolicy::Nearest, &[near, far]), (1, 1_000.0));
    // A newer scan: the same surface is measured anew, and one behind it does not hide it.
    let mut window = window(CellPolicy::Nearest);
    for (scan, (x_m, expected_m)) in
        [(1.0, 1.0), (1.04, 1.04), (1.3, 1.04), (0.8, 0.8)].into_iter().enumerate()
    {
        let stamp = Stamp::from_micros(100_000 * scan as u64);
        window.insert_points(&[Point3 { x_m, ..near }], Pose2::default(), stamp).unwrap();
        assert!((window.points().next().unwrap().point.x_m - expected_m).abs() < 1e-4, "scan {scan}");
    }
}

proptest! {
    /// Whatever comes, cells stay within their invariants, and nothing panics.
    #[test]
    fn hostile_input_is_survived(
        ranges in prop::collection::vec(prop::num::u16::ANY, 0..800),
        angles in prop::collection::vec(prop::num::f32::ANY, 1..20),
        values in prop::array::uniform8(prop::num::f32::ANY),
        millis in prop::num::u64::ANY,
    ) {
        let mut window = window(CellPolicy::Nearest);
        let mut motor = MotorTrack::new();
        let begin = Stamp::from_micros(millis);
        for (step, angle_rad) in angles.into_iter().enumerate() {
            let stamp = begin.plus_micros(10_000 * step as u64);
            let _ = motor.push(MotorSample { stamp, angle_rad, commanded_radps: values[0] });
        }
        let beams: Vec<BeamReturn> = ranges.into_iter().map(BeamReturn::Hit).collect();
        let [_, first, step, period, x_m, y_m, heading_rad, limit] = values;
        for offset in [0.0, 0.5] {
            let scan = ColumnScan {
                first_beam: begin.plus_micros(if offset > 0.0 { 50_000 } else { 0 }),
                beam_period_us: if period.abs() < 1.0e4 { period } else { 10.0 },
                first_elevation_rad: first,
                step_rad: step,
                beams: &beams,
            };
            let _ = window.insert(&scan, &motor, Pose2 { x_m, y_m, heading_rad });
            let boxes = [PersonBox {
                azimuth_min_rad: limit, azimuth_max_rad: limit + 0.5, elevation_min_rad: -0.5, elevation_max_rad: 0.5,
            }];
            let stamp = scan.first_beam;
            let _ = window.take_people(&PersonBoxes { stamp, base_in_odometry: Pose2::default(), boxes: &boxes }, stamp);
            window.follow(Pose2 { x_m: x_m + offset, y_m, heading_rad });
        }
        for one in window.points() {
            prop_assert!(one.point.x_m.is_finite() && one.point.y_m.is_finite());
            prop_assert!((0.0..=2.4).contains(&one.point.z_m));
        }
    }
}
