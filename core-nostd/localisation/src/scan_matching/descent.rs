//! Descent from a guess: the pose at which the points lie nearest to the returns of a field.

use floorguard_mapping::match_field::FieldLevel;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::nearest_f32;
use nalgebra::{Matrix3, Vector3};

/// How a descent weighs what it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DescentConfig {
    /// Distance at which a value of the field has fallen to zero, metres.
    pub reach_m: f32,
    /// Deviation of a return from the surface that the field shows, metres.
    pub return_deviation_m: f32,
    /// Distance at which a return counts half (Cauchy's weight), metres.
    pub outlier_distance_m: f32,
    /// Steps at most.
    pub steps_max: u8,
    /// A step below this length (metres, radians) ends the descent.
    pub step_least: f32,
}

/// The guess from which the descent begins, and what odometry says about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guess {
    /// Where to begin, in the field's frame.
    pub start: Pose2,
    /// What odometry expects, in the field's frame.
    pub expected: Pose2,
    /// How sure odometry is: inverse covariance of x, y and heading in the field's frame; zero without odometry.
    pub information: Matrix3<f32>,
}

impl Guess {
    /// Without odometry: the points alone decide.
    #[must_use]
    pub fn without_odometry(start: Pose2) -> Self {
        Self { start, expected: start, information: Matrix3::zeros() }
    }
}

/// Where a descent ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// In the field's frame.
    pub pose: Pose2,
    /// Mean value of the points, 0 to 1; a point outside the reach counts 0.
    pub score: f32,
    /// Inverse covariance that the returns alone give, of x, y and heading in the field's frame.
    pub information: Matrix3<f32>,
    /// Steps that were needed.
    pub steps: u8,
}

impl Refined {
    /// Nothing was matched: no information.
    #[must_use]
    pub fn none() -> Self {
        Self { pose: Pose2::default(), score: 0.0, information: Matrix3::zeros(), steps: 0 }
    }
}

/// The normal equations of one step.
struct Normal {
    matrix: Matrix3<f32>,
    vector: Vector3<f32>,
    value_sum: f32,
}

/// No descent takes more steps, whatever its configuration asks for.
const STEPS_MAX: u8 = 100;

/// Gauss-Newton on the distance to the nearest return, which is `reach` · (1 − value). Cost: steps × points.
#[must_use]
pub fn refine(level: &FieldLevel<'_>, points: &[Point2], guess: &Guess, config: &DescentConfig) -> Refined {
    let mut pose = guess.start;
    let mut steps = 0_u8;
    for _ in 0..config.steps_max.min(STEPS_MAX) {
        steps = steps.saturating_add(1);
        let normal = accumulate(level, points, pose, config);
        let away = difference(pose, guess.expected);
        let matrix = normal.matrix + guess.information;
        let vector = normal.vector + guess.information * away;
        let floor = Matrix3::from_diagonal_element(1.0e-3);
        let Some(factor) = (matrix + floor).cholesky() else { break };
        let step = -factor.solve(&vector);
        // A wild step is cut to the reach: beyond it the field says nothing about it.
        let length = step.norm();
        let cut = if length > config.reach_m { config.reach_m / length } else { 1.0 };
        let step = step * cut;
        pose = Pose2::new(pose.x_m + step.x, pose.y_m + step.y, pose.heading_rad + step.z);
        if length < config.step_least {
            break;
        }
    }
    let last = accumulate(level, points, pose, config);
    let count = nearest_f32(points.len().max(1));
    Refined { pose, score: last.value_sum / count, information: last.matrix, steps }
}

/// Pose less pose, with the heading wrapped.
fn difference(a: Pose2, b: Pose2) -> Vector3<f32> {
    let turn = Pose2::new(0.0, 0.0, a.heading_rad - b.heading_rad).heading_rad;
    Vector3::new(a.x_m - b.x_m, a.y_m - b.y_m, turn)
}

fn accumulate(level: &FieldLevel<'_>, points: &[Point2], pose: Pose2, config: &DescentConfig) -> Normal {
    let (sin, cos) = libm::sincosf(pose.heading_rad);
    let weight_at_zero = 1.0 / (config.return_deviation_m * config.return_deviation_m).max(1.0e-8);
    let outlier = 1.0 / (config.outlier_distance_m * config.outlier_distance_m).max(1.0e-8);
    let [mut xx, mut xy, mut yy, mut xt, mut yt, mut tt] = [0.0_f32; 6];
    let [mut bx, mut by, mut bt, mut value_sum] = [0.0_f32; 4];
    for point in points {
        let (turned_x, turned_y) = (cos * point.x_m - sin * point.y_m, sin * point.x_m + cos * point.y_m);
        let sample = level.sample(Point2::new(pose.x_m + turned_x, pose.y_m + turned_y));
        if sample.value <= 0.0 {
            continue;
        }
        value_sum += sample.value;
        let distance = config.reach_m * (1.0 - sample.value);
        let weight = weight_at_zero / (1.0 + distance * distance * outlier);
        let (jx, jy) = (-config.reach_m * sample.slope_x, -config.reach_m * sample.slope_y);
        let jt = jy * turned_x - jx * turned_y;
        let (wx, wy, wt) = (weight * jx, weight * jy, weight * jt);
        xx += wx * jx;
        xy += wx * jy;
        yy += wy * jy;
        xt += wx * jt;
        yt += wy * jt;
        tt += wt * jt;
        bx += wx * distance;
        by += wy * distance;
        bt += wt * distance;
    }
    Normal {
        matrix: Matrix3::new(xx, xy, xt, xy, yy, yt, xt, yt, tt),
        vector: Vector3::new(bx, by, bt),
        value_sum,
    }
}
