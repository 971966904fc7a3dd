//! A building with rooms, whose walls are met by rays that the test follows itself, and a robot whose wheels slip.

use std::boxed::Box;
use std::vec::Vec;

use floorguard_types::geometry::{Point2, Pose2};
use nalgebra::{Matrix3, SMatrix, SVector};

use super::edges::GraphEdge;
use super::gradient::{Gradient, Problem};
use super::kept::KeptScan;
use super::solve::solve;
use super::{FIELD_CELLS, GraphMapper, GraphMappingConfig, MappingStep, OfMicrocontroller};

/// Walls from and to, metres: two rings of rooms around a core, doors between them, and pillars that tell them apart.
const WALLS: [[f32; 4]; 18] = [
    [0.0, 0.0, 24.0, 0.0],
    [24.0, 0.0, 24.0, 16.0],
    [24.0, 16.0, 0.0, 16.0],
    [0.0, 16.0, 0.0, 0.0],
    [4.0, 4.0, 20.0, 4.0],
    [20.0, 4.0, 20.0, 12.0],
    [20.0, 12.0, 4.0, 12.0],
    [4.0, 12.0, 4.0, 4.0],
    [9.0, 0.0, 9.0, 1.2],
    [9.0, 2.9, 9.0, 4.0],
    [16.5, 12.0, 16.5, 13.2],
    [16.5, 15.0, 16.5, 16.0],
    [20.0, 7.0, 21.2, 7.0],
    [22.8, 7.4, 24.0, 7.4],
    [0.0, 9.0, 1.1, 9.0],
    [2.8, 9.2, 4.0, 9.2],
    [13.0, 0.0, 13.6, 0.9],
    [7.0, 15.1, 7.8, 16.0],
];

/// Uniform in −1 to 1.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }
}

/// Returns of 181 beams over 270 degrees in the building, with 1 cm of noise.
fn scan(pose: Pose2, chance: &mut Chance) -> Vec<Point2> {
    scan_of(&WALLS, pose, chance)
}

fn scan_of(walls: &[[f32; 4]], pose: Pose2, chance: &mut Chance) -> Vec<Point2> {
    let mut returns = Vec::new();
    for beam in 0..181 {
        let angle = (-135.0 + 1.5 * beam as f32).to_radians();
        let (sin, cos) = (pose.heading_rad + angle).sin_cos();
        let mut range = f32::INFINITY;
        for &[x1, y1, x2, y2] in walls {
            let (wall_x, wall_y) = (x2 - x1, y2 - y1);
            let cross = cos * wall_y - sin * wall_x;
            let (from_x, from_y) = (x1 - pose.x_m, y1 - pose.y_m);
            let away = (from_x * wall_y - from_y * wall_x) / cross;
            let along = (from_x * sin - from_y * cos) / cross;
            if away > 0.0 && (0.0..=1.0).contains(&along) {
                range = range.min(away);
            }
        }
        let range = range + 0.01 * chance.next();
        returns.push(Point2::new(range * angle.cos(), range * angle.sin()));
    }
    returns
}

/// True poses around the core, so many times: 2 m from the outer walls, with 5 cm between scans.
fn laps(count: usize) -> Vec<Pose2> {
    let corners = [[2.0, 2.0], [22.0, 2.0], [22.0, 14.0], [2.0, 14.0]];
    let mut poses = Vec::new();
    for side in 0..4 * count {
        let ([x, y], [to_x, to_y]): ([f32; 2], [f32; 2]) = (corners[side % 4], corners[(side + 1) % 4]);
        let heading = (to_y - y).atan2(to_x - x);
        let steps = ((to_x - x).hypot(to_y - y) / 0.05) as usize;
        for step in 0..steps {
            let share = step as f32 / steps as f32;
            poses.push(Pose2::new(x + share * (to_x - x), y + share * (to_y - y), heading));
        }
        for turn in 0..18 {
            poses.push(Pose2::new(to_x, to_y, heading + (5.0 * turn as f32).to_radians()));
        }
    }
    poses
}

/// What a drive came to: errors of the tracked poses and of odometry, metres, in the frame of the first pose.
struct Drive {
    errors_m: Vec<f32>,
    odometry_m: f32,
    steps: Vec<MappingStep>,
}

fn drive<const NODES: usize, const EDGES: usize>(
    mapper: &mut GraphMapper<NODES, 40, EDGES, FIELD_CELLS>,
    poses: &[Pose2],
) -> Drive {
    let mut chance = Chance(7);
    let (mut odometry, mut before) = (Pose2::default(), poses[0]);
    let (mut kept, mut steps) = (Vec::new(), Vec::new());
    for pose in poses {
        let moved = before.inverse().compose(*pose);
        // The wheels slip: 3 % of the way, 6 % of each turn, and half a degree a metre.
        let turn = 0.94 * moved.heading_rad + 0.009 * moved.x_m;
        odometry = odometry.compose(Pose2::new(0.97 * moved.x_m, moved.y_m, turn));
        before = *pose;
        let step = mapper.push(&scan(*pose, &mut chance), odometry);
        steps.push(step);
        kept.push(mapper.pose_in_scan());
    }
    let true_pose = |pose: &Pose2| poses[0].inverse().compose(*pose);
    let off = |a: Pose2, b: Pose2| (a.x_m - b.x_m).hypot(a.y_m - b.y_m);
    let errors_m = kept
        .iter()
        .zip(poses)
        .map(|((scan, pose), truth)| {
            off(mapper.scans()[usize::from(*scan)].pose.compose(*pose), true_pose(truth))
        })
        .collect();
    Drive { errors_m, odometry_m: off(odometry, true_pose(poses.last().unwrap())), steps }
}

fn largest(errors_m: &[f32]) -> f32 {
    errors_m.iter().copied().fold(0.0, f32::max)
}

fn boxed() -> Box<OfMicrocontroller> {
    Box::new(OfMicrocontroller::new(GraphMappingConfig::default()).unwrap())
}

#[test]
fn laps_around_a_building_close() {
    let mut mapper = boxed();
    let poses = laps(2);
    let seen = drive(&mut mapper, &poses);
    let rms_m = (seen.errors_m.iter().map(|error| error * error).sum::<f32>() / poses.len() as f32).sqrt();
    assert!(seen.odometry_m > 3.0, "odometry alone is lost: {} m", seen.odometry_m);
    assert!(rms_m < 0.06 && largest(&seen.errors_m) < 0.3, "{rms_m} m, at most {}", largest(&seen.errors_m));
    let counters = mapper.counters();
    assert!(counters.accepted > 0 && counters.scans_unlike == 0, "{counters:?}");
    assert_eq!(mapper.revision() > 0, counters.accepted > 0);
    // The second lap shows nothing new.
    let one = poses.len() / 2;
    let kept =
        |steps: &[MappingStep]| steps.iter().filter(|step| matches!(step, MappingStep::Kept(_))).count();
    let (first, second) = (kept(&seen.steps[..one]), kept(&seen.steps[one..]));
    assert!(second * 2 < first, "{first} scans in the first lap, {second} in the second");
}

/// Without room for the building the robot is followed where the map is, and what was not kept is counted.
#[test]
fn full_map_is_counted_and_still_serves() {
    let mut mapper =
        Box::new(GraphMapper::<6, 40, 30, FIELD_CELLS>::new(GraphMappingConfig::default()).unwrap());
    let there: Vec<Pose2> = (0..360).map(|step| Pose2::new(2.0 + 0.05 * step as f32, 2.0, 0.0)).collect();
    let mut poses = there.clone();
    poses.extend(there.iter().rev().copied());
    let seen = drive(&mut mapper, &poses);
    assert!(mapper.is_full() && mapper.scans().len() == 6, "{}", mapper.scans().len());
    assert!(mapper.counters().scans_without_room > 0 && seen.steps.contains(&MappingStep::Full));
    assert!(seen.errors_m.last().is_some_and(|error_m| *error_m < 0.15), "{:?}", seen.errors_m.last());
}

#[test]
fn scans_of_elsewhere_and_broken_input_are_unlike() {
    let mut mapper = boxed();
    drive(&mut mapper, &laps(1)[..200]);
    let pose = mapper.pose();
    let on = |x_m: f32| Pose2::new(9.65 + x_m, 0.0, 0.09);
    let nowhere: Vec<Point2> = (0..150)
        .map(|index| Point2::new((index % 13) as f32 * 0.7 - 4.0, (index % 7) as f32 * 0.9 - 3.1))
        .collect();
    mapper.push(&nowhere, on(0.3));
    mapper.push(&[], on(0.6));
    mapper.push(&[Point2::new(f32::NAN, 1.0), Point2::new(f32::INFINITY, 0.0)], on(0.9));
    mapper.push(&nowhere, Pose2 { x_m: f32::NAN, ..Pose2::default() });
    assert_eq!(mapper.counters().scans_unlike, 4);
    let after = mapper.pose();
    let gone = (after.x_m - pose.x_m).hypot(after.y_m - pose.y_m);
    assert!((0.5..1.3).contains(&gone), "as far as odometry says: {pose:?} {after:?}");
}

#[test]
fn room_is_what_the_microcontroller_has() {
    assert!(size_of::<OfMicrocontroller>() <= 200_000, "{}", size_of::<OfMicrocontroller>());
    assert!(GraphMapper::<4, 4, 4, 100>::new(GraphMappingConfig::default()).is_none());
}

/// Derivatives by small differences.
#[test]
fn edges_are_linearised_right() {
    let edge = GraphEdge::new([0, 1], Pose2::new(0.4, -0.2, 2.9), &Matrix3::identity(), true);
    let (from, to) = (Pose2::new(1.0, 2.0, 0.7), Pose2::new(0.2, 2.6, -2.8));
    let at = edge.linearised(from, to);
    for axis in 0..3 {
        let moved = |pose: Pose2| {
            let mut values = [pose.x_m, pose.y_m, pose.heading_rad];
            values[axis] += 1.0e-2;
            Pose2::new(values[0], values[1], values[2])
        };
        let by_from = (edge.linearised(moved(from), to).error - at.error) / 1.0e-2;
        let by_to = (edge.linearised(from, moved(to)).error - at.error) / 1.0e-2;
        assert!((by_from - at.by_from.column(axis)).norm() < 0.02, "{axis}: {by_from} {}", at.by_from);
        assert!((by_to - at.by_to.column(axis)).norm() < 0.02, "{axis}: {by_to} {}", at.by_to);
    }
}

/// A step of the conjugate gradients beside the whole system solved at once.
#[test]
fn gradients_agree_with_a_dense_solution() {
    let scans: Vec<KeptScan<4>> =
        (0..5).map(|i| KeptScan::new(Pose2::new(i as f32, 0.1 * i as f32, 0.1), i as f32, &[])).collect();
    let information = Matrix3::new(40.0, 3.0, 0.5, 3.0, 60.0, -1.0, 0.5, -1.0, 90.0);
    let edge = |from: u16, to: u16, x_m: f32| {
        GraphEdge::new([from, to], Pose2::new(x_m, 0.05, 0.02), &information, true)
    };
    let edges = [edge(0, 1, 1.0), edge(1, 2, 0.9), edge(2, 3, 1.1), edge(3, 4, 1.0), edge(0, 4, 3.5)];
    let mut gradient = Gradient::<5>::new();
    gradient.descend(&Problem { edges: &edges, scans: &scans, trusted: 1.0 });
    let (mut matrix, mut right) = (SMatrix::<f64, 15, 15>::identity() * 1.0e-3, SVector::<f64, 15>::zeros());
    for edge in &edges {
        let ends = [usize::from(edge.from), usize::from(edge.to)];
        let at = edge.linearised(scans[ends[0]].pose, scans[ends[1]].pose);
        let by = [at.by_from.map(f64::from), at.by_to.map(f64::from)];
        let weight = information.map(f64::from);
        for (i, a) in ends.iter().zip(&by) {
            let pull = a.transpose() * weight * at.error.map(f64::from);
            let mut part = right.fixed_rows_mut::<3>(3 * i);
            part -= pull;
            for (j, b) in ends.iter().zip(&by) {
                let mut block = matrix.fixed_view_mut::<3, 3>(3 * i, 3 * j);
                block += a.transpose() * weight * b;
            }
        }
    }
    let inner = matrix.fixed_view::<12, 12>(3, 3).into_owned();
    let expected = inner.lu().solve(&right.fixed_rows::<12>(3).into_owned()).unwrap();
    for (index, step) in gradient.steps().iter().enumerate().skip(1) {
        let wanted = expected.fixed_rows::<3>(3 * (index - 1)).map(|value| value as f32);
        assert!((step - wanted).norm() < 1.0e-3, "{index}: {step} {wanted}");
    }
    assert_eq!(gradient.steps()[0].norm(), 0.0, "the first stays");
}

/// What comes of five scans that are compared with five of the same places, kept 60 m of path before. `walls`: as they were and as they are;
/// `off_m`: how far the robot believes itself aside; `conflict_most`: share of returns that may contradict.
fn met_again(walls: [&[[f32; 4]]; 2], off_m: f32, conflict_most: f32) -> (Box<OfMicrocontroller>, bool) {
    let (mut mapper, mut chance) = (boxed(), Chance(5));
    mapper.config.loop_conflict_most = conflict_most;
    for (time, walls) in (0..).zip(walls) {
        for step in 0..5 {
            let x_m = 6.0 + 0.5 * step as f32;
            let returns: Vec<Point2> = scan_of(walls, Pose2::new(x_m, 2.0, 0.0), &mut chance);
            let returns: Vec<Point2> = returns.into_iter().filter(|point| point.norm() < 8.0).collect();
            let believed = Pose2::new(x_m + off_m * time as f32, 2.0, 0.0);
            let path_m = 60.0 * time as f32 + 0.5 * step as f32;
            mapper.scans.push(KeptScan::new(believed, path_m, &returns)).unwrap();
        }
    }
    let is_found = mapper.compare(9, 4);
    (mapper, is_found)
}

#[test]
fn place_that_is_met_again_is_found() {
    let (mapper, is_found) = met_again([&WALLS; 2], 0.6, 0.02);
    assert!(is_found && mapper.counters().accepted == 1, "{:?}", mapper.counters());
    let measured = mapper.edges()[0].measured;
    assert!(measured.x_m.hypot(measured.y_m) < 0.03, "{measured:?}");
}

/// The window is 2.9 m to each side: what resembles the place more may lie outside.
#[test]
fn place_at_the_rim_is_not_believed() {
    let (mapper, is_found) = met_again([&WALLS; 2], 2.5, 0.15);
    assert!(!is_found && mapper.counters().at_rim == 1, "{:?}", mapper.counters());
}

#[test]
fn corridor_that_fits_everywhere_is_ambiguous() {
    let corridor = [[-90.0, 0.0, 90.0, 0.0], [-90.0, 4.0, 90.0, 4.0]];
    let (mapper, is_found) = met_again([&corridor; 2], 0.6, 0.15);
    assert!(!is_found && mapper.counters().ambiguous == 1, "{:?}", mapper.counters());
}

/// A wall across, where the robot saw through before, is one return in twelve or so: with a limit below that it is another place, and the same
/// limit lets the place itself pass (`place_that_is_met_again_is_found`).
#[test]
fn place_with_another_wall_is_contradicted() {
    let mut now = WALLS.to_vec();
    now.push([9.5, 0.0, 9.5, 4.0]);
    let (mapper, is_found) = met_again([&WALLS, &now], 0.3, 0.02);
    assert!(!is_found && mapper.counters().contradicted == 1, "{:?}", mapper.counters());
}

/// A loop that contradicts all steps hardly bends the path; as one that counts in full it would.
#[test]
fn wrong_loop_is_outweighed() {
    let information = Matrix3::from_diagonal(&[100.0, 100.0, 400.0].into());
    let end_m = |loop_is_step: bool| {
        let mut scans = heapless::Vec::<KeptScan<4>, 5>::new();
        let mut edges = heapless::Vec::<GraphEdge, 5>::new();
        for number in 0..5_u16 {
            let x_m = f32::from(number);
            scans.push(KeptScan::new(Pose2::new(x_m, 0.0, 0.0), x_m, &[])).unwrap();
        }
        for number in 0..4_u16 {
            let step = Pose2::new(1.0, 0.0, 0.0);
            edges.push(GraphEdge::new([number, number + 1], step, &information, true)).unwrap();
        }
        let wrong = Pose2::new(1.0, 2.0, 0.0);
        edges.push(GraphEdge::new([0, 4], wrong, &information, loop_is_step)).unwrap();
        solve(&mut scans, &edges, (&mut Gradient::<5>::new(), 5.0));
        scans[4].pose.x_m
    };
    assert!(end_m(false) > 3.9, "{}", end_m(false));
    assert!(end_m(true) < 2.5, "{}", end_m(true));
}
