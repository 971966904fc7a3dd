//! The seven published steps as they stand, on plain lists and sets: what ours is compared with, and a second model.
//!
//! The steps of the book, Motion: Published steps (parameters `paper`): whole clusters, each compared with its
//! predecessor in the sweep before. Everything is kept in the frame of the odometry, so the robot's own motion is in
//! the points. Floor and clusters are ours (ground and clusters decide nothing here).

use std::collections::BTreeSet;

use floorguard_perception::motion::MotionParameters;
use floorguard_perception::people::{PeoplePipeline, SweepContext};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::Sweep;

/// Edge of a voxel, metres.
const VOXEL_M: f64 = 0.1;
/// Sweeps are this far apart, seconds.
const SWEEP_S: f64 = 0.1;

type Point = [f64; 3];

/// A cluster of one sweep.
struct Cluster {
    points: Vec<Point>,
    centroid: Point,
    volume_m3: f64,
    /// Sweeps in a row in which it changed.
    run: u8,
    changed: bool,
}

/// What is remembered from sweep to sweep.
pub struct Published {
    parameters: MotionParameters,
    /// What is farther along x or y of the lidar is cut off, metres.
    crop_m: f32,
    /// Smaller clusters are noise.
    points_min: usize,
    before: Vec<Cluster>,
    /// Centroid and sweeps at rest of what is believed to move.
    moving: Vec<(Point, u8)>,
}

impl Published {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new(parameters: MotionParameters, crop_m: f32, points_min: usize) -> Self {
        Self { parameters, crop_m, points_min, before: Vec::new(), moving: Vec::new() }
    }

    /// Where clusters are reported as moving, in the frame of the odometry.
    pub fn process(&mut self, people: &PeoplePipeline, sweep: &Sweep, context: &SweepContext) -> Vec<Point2> {
        let mut now = self.clusters(people, sweep, context);
        let predecessors: Vec<Option<usize>> =
            (0..now.len()).map(|index| self.predecessor(&now, index)).collect();
        for (cluster, predecessor) in now.iter_mut().zip(predecessors) {
            let before = predecessor.and_then(|index| self.before.get(index));
            cluster.changed = before.is_some_and(|before| has_changed(before, cluster, &self.parameters));
            let run = before.map_or(0, |before| before.run);
            cluster.run = if cluster.changed { run.saturating_add(1) } else { 0 };
        }
        let reported = self.observe(&now);
        self.believe(&now);
        self.before = now;
        reported
    }

    /// Clusters within the published crop.
    fn clusters(&self, people: &PeoplePipeline, sweep: &Sweep, context: &SweepContext) -> Vec<Cluster> {
        let mut points: Vec<Vec<Point>> = vec![Vec::new(); people.clusters().len()];
        let columns = sweep.used_columns();
        let duration_s = f64::from(sweep.end_stamp.seconds_since(sweep.stamp));
        for (index, column) in columns.iter().enumerate().filter(|(_, column)| column.measured) {
            let before_end_s = duration_s * (index as f64 / columns.len() as f64 - 1.0);
            for (ring, raw) in column.range_raw.iter().enumerate() {
                let range_m = f64::from(*raw) * f64::from(sweep.range_unit_mm) * 1.0e-3;
                let elevation = (2.0 * ring as f64 - 15.0).to_radians();
                let azimuth = f64::from(column.azimuth_cdeg).to_radians() * 0.01;
                let (x, y) =
                    (azimuth.cos() * elevation.cos() * range_m, -azimuth.sin() * elevation.cos() * range_m);
                let kept = *raw != 0 && x.abs().max(y.abs()) <= f64::from(self.crop_m);
                let cluster = people.cluster_of(index, ring).filter(|_| kept);
                if let Some(list) = cluster.and_then(|cluster| points.get_mut(cluster)) {
                    list.push(placed([x, y, range_m * elevation.sin()], before_end_s, context));
                }
            }
        }
        points.into_iter().filter(|points| points.len() >= self.points_min).map(Cluster::new).collect()
    }

    /// Reciprocal neighbours of like volume within reach.
    fn predecessor(&self, now: &[Cluster], index: usize) -> Option<usize> {
        let cluster = now.get(index)?;
        let (candidate, distance_m) = nearest(&self.before, cluster.centroid)?;
        let before = self.before.get(candidate)?;
        let gate_m = f64::from(self.parameters.speed_max_mps) * SWEEP_S + f64::from(self.parameters.gate_m);
        let mutual = nearest(now, before.centroid).is_some_and(|(back, _)| back == index);
        let change = (cluster.volume_m3 - before.volume_m3).abs();
        let alike =
            change < f64::from(self.parameters.volume_change_max) * (cluster.volume_m3 + before.volume_m3);
        (mutual && alike && distance_m <= gate_m).then_some(candidate)
    }

    /// Confidence of the known ones (book, Motion: Confidence).
    fn observe(&mut self, now: &[Cluster]) -> Vec<Point2> {
        let mut reported = Vec::new();
        for (centroid, rest) in &mut self.moving {
            let near = nearest(now, *centroid).filter(|(_, d)| *d <= f64::from(self.parameters.leave_off_m));
            let Some(cluster) = near.and_then(|(index, _)| now.get(index)) else {
                *rest += 1;
                continue;
            };
            *rest = if cluster.changed { rest.saturating_sub(1) } else { *rest + 1 };
            *centroid = cluster.centroid;
            if *rest <= self.parameters.rest_max {
                reported.push(Point2::new(centroid[0] as f32, centroid[1] as f32));
            }
        }
        self.moving.retain(|(_, rest)| *rest <= self.parameters.rest_max);
        reported
    }

    /// New ones at the end of a chain (book, Motion: Confidence).
    fn believe(&mut self, now: &[Cluster]) {
        for cluster in now.iter().filter(|cluster| cluster.run >= self.parameters.chain) {
            let catch_up_m = f64::from(self.parameters.catch_up_m);
            let known = self
                .moving
                .iter_mut()
                .find(|(centroid, _)| distance(*centroid, cluster.centroid) <= catch_up_m);
            match known {
                Some((centroid, _)) => *centroid = cluster.centroid,
                None => self.moving.push((cluster.centroid, 0)),
            }
        }
    }
}

impl Cluster {
    fn new(points: Vec<Point>) -> Self {
        let count = points.len() as f64;
        let over = |axis: usize, fold: fn(f64, f64) -> f64| {
            points.iter().map(|point| point[axis]).reduce(fold).unwrap_or(0.0)
        };
        let centroid = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
        let volume_m3 = [0, 1, 2].map(|axis| over(axis, f64::max) - over(axis, f64::min)).iter().product();
        Self { points, centroid, volume_m3, run: 0, changed: false }
    }
}

/// Returns in voxels that were empty, with the lattice at the first point of the cluster before.
fn has_changed(before: &Cluster, now: &Cluster, parameters: &MotionParameters) -> bool {
    let origin = before.points.first().copied().unwrap_or_default();
    let voxel = |point: &Point| [0, 1, 2].map(|axis| ((point[axis] - origin[axis]) / VOXEL_M).floor() as i64);
    let filled: BTreeSet<[i64; 3]> = before.points.iter().map(voxel).collect();
    let new = now.points.iter().filter(|point| !filled.contains(&voxel(point))).count();
    new * usize::from(parameters.sensitivity) > before.points.len() + now.points.len()
}

fn distance(a: Point, b: Point) -> f64 {
    [0, 1, 2].map(|axis| (a[axis] - b[axis]).powi(2)).iter().sum::<f64>().sqrt()
}

fn nearest(clusters: &[Cluster], centroid: Point) -> Option<(usize, f64)> {
    let distances = clusters.iter().map(|cluster| distance(cluster.centroid, centroid)).enumerate();
    distances.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// From the lidar at the moment of the beam to the frame of the odometry.
fn placed(in_lidar: Point, before_end_s: f64, context: &SweepContext) -> Point {
    let mounting = context.sensor_in_base.translation;
    let [x, y, z] = in_lidar;
    let moved = Pose2::new(
        context.twist.linear_mps * before_end_s as f32,
        0.0,
        context.twist.angular_radps * before_end_s as f32,
    );
    let base = context.base_in_odom.compose(moved);
    let point = base.transform(Point2::new(x as f32 + mounting.x_m, y as f32 + mounting.y_m));
    [f64::from(point.x_m), f64::from(point.y_m), z + f64::from(mounting.z_m)]
}
