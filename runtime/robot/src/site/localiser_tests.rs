//! What a belief makes of floor that was cleaned without credit.

use floorguard_mapping::{Grid, poisson_tail};

use super::super::scrubber;
use super::*;
use crate::cleaner::MissionPlan;

const TOLERATED: u8 = 5;
const UNITS: f32 = 12.0;

/// A robot at the start of a supermarket, with a spill of 0.2 m before it.
fn before_a_spill() -> (Floor, Localiser, Vec<usize>) {
    let plan = MissionPlan::supermarket();
    let mut floor = Floor::new("a supermarket", plan.occupancy().unwrap(), 0.4).unwrap();
    floor.start = plan.start_pose();
    let spill = floor.start.transform(Point2::new(1.5, 0.0));
    let is_dirty = |cell: usize| floor.cells.centre(cell).distance(spill) <= 0.2;
    let dirty: Vec<usize> = (0..floor.cells.cell_count()).filter(|cell| is_dirty(*cell)).collect();
    let mut cells = vec![DirtCell::CLEAN; floor.cells.cell_count()];
    for cell in &dirty {
        cells[*cell] = DirtCell::poisson(UNITS, poisson_tail(TOLERATED.into(), f64::from(UNITS)) as f32);
    }
    let cells = Grid::new(floor.cells, cells).unwrap();
    let localiser = Localiser::new(&floor, scrubber::belief(TOLERATED), cells, Pcg32::new(1, 71));
    (floor, localiser, dirty)
}

/// Drives straight on; the dirt sensor counts nothing, or is not heard at all. Gives the farthest that the pose was off.
fn drive((floor, localiser): (&Floor, &mut Localiser), steps: u8, is_heard: bool) -> f32 {
    let off_m = (1..=steps).map(|step| {
        let odometry = Pose2::new(f32::from(step) * UPDATE_M, 0.0, 0.0);
        localiser.collect(0, !is_heard);
        localiser.update(floor, odometry, &[], true);
        let at = floor.start.compose(odometry);
        libm::hypotf(localiser.pose(odometry).x_m - at.x_m, localiser.pose(odometry).y_m - at.y_m)
    });
    off_m.fold(0.0, f32::max)
}

/// The brush has taken the dirt away, and its credit was given up. On the next pass the dirt sensor is silent: that is no
/// evidence against the pose, and the cells are claimed.
#[test]
fn silent_dirt_sensor_moves_no_pose_there() {
    let (floor, mut localiser, dirty) = before_a_spill();
    drive((&floor, &mut localiser), 14, false);
    assert!(localiser.active_cells() > 5, "the brush is on the spill");
    localiser.distrust(PoseDeviation::default());
    assert_eq!(localiser.active_cells(), 0);
    localiser.relocate(floor.start, Pose2::default());
    let off_m = drive((&floor, &mut localiser), 25, true);
    assert!(off_m < 0.05 && localiser.leaps == 0, "{off_m:.3} m off, {} leaps", localiser.leaps);
    let rule = CleanRule::per_cell(TOLERATED, 0.01);
    let left = dirty.iter().filter(|cell| rule.needs_cleaning(localiser.map.get(**cell).unwrap())).count();
    assert_eq!(left, 0, "of {}", dirty.len());
}

/// A robot that does not trust its pose cleans without credit, too.
#[test]
fn floor_of_an_untrusted_robot_is_uncredited() {
    let (floor, mut localiser, _) = before_a_spill();
    localiser.is_trusted = false;
    drive((&floor, &mut localiser), 25, true);
    localiser.is_trusted = true;
    localiser.relocate(floor.start, Pose2::default());
    let off_m = drive((&floor, &mut localiser), 25, true);
    assert!(off_m < 0.05 && localiser.leaps == 0, "{off_m:.3} m off, {} leaps", localiser.leaps);
    // A restored map says what lies there.
    let (cells, spill) = (localiser.remembered(), floor.start.transform(Point2::new(1.5, 0.0)));
    assert!(localiser.uncredited.is_around(localiser.map.geometry(), (spill, 1.0)));
    localiser.restore((&cells, floor.start), Pose2::default());
    assert!(!localiser.uncredited.is_around(localiser.map.geometry(), (spill, 1.0)));
}

/// Where nothing was given up, a silent dirt sensor says that the brush is beside the dirt.
#[test]
fn silent_dirt_sensor_speaks_on_other_floor() {
    let (floor, mut localiser, _) = before_a_spill();
    let off_m = drive((&floor, &mut localiser), 25, true);
    assert!(off_m > 0.05 && localiser.leaps > 0, "{off_m:.3} m off, {} leaps", localiser.leaps);
}
