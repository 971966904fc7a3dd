//! Objects of a drawn sweep: what moved goes down to the floor, what stands stays, memory may end.

use std::vec;
use std::vec::Vec;

use floorguard_types::geometry::Point3;

use super::{
    Block, Column, ColumnGrid, FixedVoxels, FreeSpace, JudgeRule, JudgedSweep, PointVerdict, SweepJudge,
    SweepOutcome,
};

type Space = FreeSpace<FixedVoxels<Vec<Block>>>;

/// Returns of a body of 0.4 m at x = 3, from the floor up; of a wall at x = 4; of the floor.
fn sweep() -> [Vec<Point3>; 3] {
    let mut parts = [Vec::new(), Vec::new(), Vec::new()];
    for up in 0..35_u8 {
        for across in 0..8_u8 {
            let (y, z) = (0.05 * f32::from(across) - 0.18, 0.05 * f32::from(up) + 0.01);
            parts[0].push(Point3::new(3.02, y, z));
            parts[1].push(Point3::new(4.02, 4.0 * y, z));
            parts[2].push(Point3::new(1.0 + 0.05 * f32::from(up), 4.0 * y, 0.005));
        }
    }
    parts
}

/// Five sweeps with the body, and five that see the wall through its place.
fn evidence(parts: &[Vec<Point3>; 3], passes_to_z_m: f32) -> Space {
    let mut space = FreeSpace::new(0.1, FixedVoxels::new(vec![Block::FREE; 512])).unwrap();
    for number in 0..10 {
        space.begin_sweep();
        let [body, wall, floor] = parts;
        wall.iter().chain(floor).for_each(|point| space.hit(*point));
        if number < 2 {
            body.iter().for_each(|point| space.hit(*point));
            continue;
        }
        for point in body.iter().filter(|point| (0.12..passes_to_z_m).contains(&point.z_m)) {
            space.pass(Point3::new(0.0, point.y_m, point.z_m), Point3::new(3.8, point.y_m, point.z_m));
        }
    }
    space
}

fn judged(space: &Space, points: &[Point3]) -> (SweepOutcome, Vec<PointVerdict>) {
    let grid = ColumnGrid::new(100, vec![Column::default(); 10_000]).unwrap();
    let mut judge = SweepJudge::new(JudgeRule::default(), grid);
    let mut verdicts = vec![PointVerdict::Moved; points.len()];
    let sensor_in_map = Point3::new(0.0, 0.0, 0.8);
    let sweep = JudgedSweep { points_in_map: points, sensor_in_map, floor_m: 0.0, verdicts: &mut verdicts };
    (judge.judge(space, sweep), verdicts)
}

#[test]
fn a_person_goes_whole() {
    let parts = sweep();
    let points = parts.concat();
    let (outcome, verdicts) = judged(&evidence(&parts, 2.0), &points);
    let body = parts[0].len();
    assert_eq!((outcome.objects, outcome.moved as usize), (1, body));
    assert!(verdicts[..body].iter().all(|verdict| *verdict == PointVerdict::Moved));
    assert!(verdicts[body..].iter().all(|verdict| *verdict != PointVerdict::Moved));
}

#[test]
fn an_object_that_mostly_stands_stays_whole() {
    // Rays pass only through the lowest third: it is no free place.
    let parts = sweep();
    let (outcome, _) = judged(&evidence(&parts, 0.6), &parts.concat());
    assert_eq!((outcome.objects, outcome.moved), (0, 0));
}

#[test]
fn without_evidence_nothing_is_removed() {
    let parts = sweep();
    let empty = FreeSpace::new(0.1, FixedVoxels::new(vec![Block::FREE; 1])).unwrap();
    assert_eq!(judged(&empty, &parts.concat()).0, SweepOutcome::default());
    assert!(ColumnGrid::new(100, vec![Column::default(); 9_999]).is_err());
}
