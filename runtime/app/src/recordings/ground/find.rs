//! Which points of a cloud are floor: the robot's own stage, sixteen rings at a time, levelled by what it finds.

use std::collections::BTreeMap;

use floorguard_perception::people::FloorMask;
use floorguard_types::geometry::{Point3, Transform3};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use crate::recordings::arguments::Tilt;
use crate::recordings::replay::{Cell, CloudSorter, Point};

/// Rings that the stage takes at once.
const RINGS: usize = 16;
/// A cloud that names no rings is cut into so many by elevation.
const CUT_RINGS: u16 = 64;
/// So often the plane of the floor levels the cloud again.
const ROUNDS: usize = 6;
/// Points within this of the floor point of their cell belong to it, metres.
const SAME_M: f32 = 0.06;
/// The plane is fitted to floor no farther away, metres: beyond, a floor need not be flat.
const FITTED_M: f32 = 15.0;
/// Points farther off the plane than this are left out of the next fit, metres.
const OFF_M: f32 = 0.15;
/// Layers of level points below the sensor: their height, and how far down they begin and end, metres.
const LAYER_M: f32 = 0.04;
const LOWEST_M: f32 = 0.2;
const LAYERS: usize = 80;
/// Tilts that are tried: so many steps either way about both axes, degrees.
const TILT_STEPS: i8 = 6;
const TILT_STEP_DEG: f32 = 2.0;
/// Of so many points.
const SAMPLED: usize = 8_000;
/// Fewer points make no floor.
const POINTS_MIN: usize = 100;

/// The floor of a cloud.
pub struct Ground {
    /// For each point, whether it is floor.
    pub is_floor: Vec<bool>,
    /// Unit normal upwards in the frame of the cloud, and height of the sensor above the floor in metres.
    pub normal: [f32; 3],
    /// See above.
    pub height_m: f32,
    /// Mean distance of the fitted points from the plane, metres.
    pub residual_m: f32,
}

/// Finds it; `None` where too few points lie below the sensor. Linear in the points, a few times.
pub fn ground(points: &[Point], tilt: Tilt) -> Option<Ground> {
    let named = points.iter().all(|point| point.ring.is_some());
    let owned: Vec<Point> = if named { points.to_vec() } else { cut_into_rings(points) };
    let passes = passes(&owned);
    let mut mounting = levelled(&owned, tilt)?;
    let mut found = None;
    for _ in 0..ROUNDS {
        let is_floor = marked(&owned, &passes, &mounting);
        let plane = fitted(&owned, &is_floor, &mounting)?;
        mounting = level(plane.normal, plane.height_m);
        found = Some(Ground { is_floor, ..plane });
    }
    found
}

fn tilted(tilt: Tilt) -> Transform3 {
    let Tilt { roll_deg, pitch_deg } = tilt;
    Transform3::from_mounting(Point3::new(0.0, 0.0, 0.0), roll_deg.to_radians(), pitch_deg.to_radians(), 0.0)
}

/// The mounting around the given tilt in which most points lie in one level layer below the sensor, and few below that.
fn levelled(points: &[Point], given: Tilt) -> Option<Transform3> {
    let every = points.len().div_ceil(SAMPLED).max(1);
    let near = |at: &Point3| libm::hypotf(at.x_m, at.y_m) < FITTED_M;
    let sample: Vec<Point3> = points.iter().step_by(every).map(place).filter(near).collect();
    let steps = || (-TILT_STEPS..=TILT_STEPS).map(|step| f32::from(step) * TILT_STEP_DEG);
    let mut best = (0_i64, None);
    for (roll_deg, pitch_deg) in steps().flat_map(|roll| steps().map(move |pitch| (roll, pitch))) {
        let tilt = Tilt { roll_deg: given.roll_deg + roll_deg, pitch_deg: given.pitch_deg + pitch_deg };
        let mut mounting = tilted(tilt);
        let mut layers = [0_i64; LAYERS];
        for at in &sample {
            let layer = (-mounting.transform(*at).z_m - LOWEST_M) / LAYER_M;
            if let Some(count) = (layer >= 0.0).then(|| layers.get_mut(layer as usize)).flatten() {
                *count += 1;
            }
        }
        // From the lowest layer up: under a floor lies nothing.
        let mut below = 0;
        for (index, pair) in layers.windows(2).enumerate().rev() {
            let score = pair.iter().sum::<i64>() - below / 2;
            if score > best.0 {
                mounting.translation.z_m = LOWEST_M + (index as f32 + 1.0) * LAYER_M;
                best = (score, Some(mounting));
            }
            below += pair.last().copied().unwrap_or(0);
        }
    }
    best.1
}

/// Rings by elevation, as many as there may be.
fn cut_into_rings(points: &[Point]) -> Vec<Point> {
    let elevation = |point: &Point| {
        let [x, y, z] = point.position_m;
        libm::atan2f(z, libm::hypotf(x, y))
    };
    let mut sorted: Vec<f32> = points.iter().map(elevation).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let at =
        |share: usize| sorted.get(sorted.len().saturating_sub(1) * share / 1_000).copied().unwrap_or(0.0);
    let (low, high) = (at(2), at(998));
    let step = ((high - low) / f32::from(CUT_RINGS)).max(1.0e-4);
    let ring = |point: &Point| ((elevation(point) - low) / step).clamp(0.0, f32::from(CUT_RINGS - 1)) as u16;
    points.iter().map(|point| Point { ring: Some(ring(point)), ..*point }).collect()
}

/// Every sixteen rings that lie spread over the view, with their sweep.
fn passes(points: &[Point]) -> Vec<(CloudSorter, Box<Sweep>)> {
    let mut by_ring = BTreeMap::<u16, Vec<Point>>::new();
    for point in points {
        by_ring.entry(point.ring.unwrap_or(0)).or_default().push(*point);
    }
    let count = by_ring.len().div_ceil(RINGS).max(1);
    let rings: Vec<Vec<Point>> = by_ring.into_values().collect();
    let pass = |first: usize| {
        let own: Vec<Point> = rings.iter().skip(first).step_by(count).flatten().copied().collect();
        let (mut sorter, mut sweep) = (CloudSorter::default(), Box::new(Sweep::EMPTY));
        sorter.sweep_of(&own, (Stamp::ZERO, 100_000), &mut sweep);
        (sorter, sweep)
    };
    (0..count).map(pass).collect()
}

fn marked(points: &[Point], passes: &[(CloudSorter, Box<Sweep>)], mounting: &Transform3) -> Vec<bool> {
    let mut mask = FloorMask::new();
    let mut is_floor = vec![false; points.len()];
    for (sorter, sweep) in passes {
        mask.find(sweep, &sorter.angles(), mounting);
        for (point, marked) in points.iter().zip(&mut is_floor) {
            let Some(Cell { column, ring, raw }) = sorter.cell(point) else { continue };
            let Some(nearest) = sweep.columns.get(column).and_then(|column| column.range_raw.get(ring))
            else {
                continue;
            };
            // A cell keeps its nearest point; others of it are floor where they lie as low.
            let rise = f32::from(raw.abs_diff(*nearest)) * 0.002 * slope(point);
            *marked |= mask.is_floor(column, ring) && rise < SAME_M;
        }
    }
    is_floor
}

/// How steeply the ray to a point rises or falls.
fn slope(point: &Point) -> f32 {
    let [x, y, z] = point.position_m;
    (z / libm::hypotf(libm::hypotf(x, y), z).max(1.0e-3)).abs()
}

fn place(point: &Point) -> Point3 {
    let [x, y, z] = point.position_m;
    Point3::new(x, y, z)
}

/// The plane of least squares through the marked points, in the frame of the cloud.
fn fitted(points: &[Point], is_floor: &[bool], mounting: &Transform3) -> Option<Ground> {
    let used: Vec<Point3> = points
        .iter()
        .zip(is_floor)
        .filter(|(_, is_floor)| **is_floor)
        .map(|(point, _)| place(point))
        .filter(|at| libm::hypotf(at.x_m, at.y_m) < FITTED_M && mounting.transform(*at).z_m.abs() < OFF_M)
        .collect();
    if used.len() < POINTS_MIN {
        return None;
    }
    let mut sums = nalgebra::Matrix3::<f64>::zeros();
    let mut right = nalgebra::Vector3::<f64>::zeros();
    for at in &used {
        let row = nalgebra::Vector3::new(f64::from(at.x_m), f64::from(at.y_m), 1.0);
        sums += row * row.transpose();
        right += row * f64::from(at.z_m);
    }
    let plane = sums.lu().solve(&right)?;
    let normal = nalgebra::Vector3::new(-plane.x, -plane.y, 1.0);
    let length = normal.norm();
    let normal = normal / length;
    let height_m = -plane.z / length;
    let off = |at: &Point3| {
        (normal.x * f64::from(at.x_m)
            + normal.y * f64::from(at.y_m)
            + normal.z * f64::from(at.z_m)
            + height_m)
            .abs()
    };
    let residual_m = used.iter().map(off).sum::<f64>() / used.len() as f64;
    Some(Ground {
        is_floor: Vec::new(),
        normal: [normal.x as f32, normal.y as f32, normal.z as f32],
        height_m: height_m as f32,
        residual_m: residual_m as f32,
    })
}

/// A mounting that makes the plane level.
fn level([x, y, z]: [f32; 3], height_m: f32) -> Transform3 {
    let pitch_rad = -libm::asinf(x.clamp(-1.0, 1.0));
    let roll_rad = libm::atan2f(y, z);
    Transform3::from_mounting(Point3::new(0.0, 0.0, height_m), roll_rad, pitch_rad, 0.0)
}
