//! Pose and velocity with their covariance: predicted by white noise of the acceleration, corrected by what wheels,
//! gyroscope, floor and lidar measure (Bar-Shalom et al. 2001, section 6.2, for each axis of the body).

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::motion::{Pose3, Twist3};

/// Covariance or information of rotation, place, angular and linear velocity, in the body's axes.
pub type Matrix12 = SMatrix<f64, 12, 12>;
pub(super) type Vector12 = SVector<f64, 12>;

/// Where the sensor is and how it moves, at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionState {
    /// Sensor in the map.
    pub pose: Pose3,
    /// Velocity in the sensor's axes.
    pub twist: Twist3,
    /// Of errors in the sensor's axes: radians, metres, rad/s, m/s.
    pub covariance: Matrix12,
}

/// How much the velocity changes within a second, one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionNoise {
    /// About each axis, rad/s.
    pub angular_radps: Vector3<f64>,
    /// Along each axis, m/s.
    pub linear_mps: Vector3<f64>,
}

impl Default for MotionNoise {
    /// A robot that drives on a floor: it turns about the vertical axis, and rises or sinks hardly ever.
    fn default() -> Self {
        Self { angular_radps: Vector3::new(0.5, 0.5, 2.0), linear_mps: Vector3::new(1.0, 1.0, 0.1) }
    }
}

impl MotionNoise {
    /// A person who carries the sensor.
    #[must_use]
    pub fn hand_held() -> Self {
        Self { angular_radps: Vector3::from_element(4.0), linear_mps: Vector3::from_element(2.0) }
    }
}

/// A vector measured with a deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian3 {
    /// Mean.
    pub mean: Vector3<f64>,
    /// Standard deviation of each part, > 0.
    pub deviation: Vector3<f64>,
}

/// Speed of the robot by its wheels, at the sensor and in its axes; the sensor is mounted level and ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSpeed {
    /// Along the axes, m/s: a wheel that cannot slide sideways says so here.
    pub linear_mps: Gaussian3,
    /// About the axes, rad/s.
    pub angular_radps: Gaussian3,
}

/// What else is known of the motion during a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionAid {
    /// From the wheels.
    pub wheels: Option<WheelSpeed>,
    /// From a gyroscope, in the sensor's axes, rad/s.
    pub gyroscope: Option<Gaussian3>,
}

/// The floor is level, and the sensor stands upright on it at a constant height: the plane of the first pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorPrior {
    /// Standard deviation of the height, metres, > 0.
    pub height_m: f64,
    /// Standard deviation of roll and pitch, radians, > 0.
    pub tilt_rad: f64,
}

impl Default for FloorPrior {
    fn default() -> Self {
        Self { height_m: 0.02, tilt_rad: 0.5_f64.to_radians() }
    }
}

/// A quadratic in the correction of a state: information and gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quadratic {
    pub(super) information: Matrix12,
    pub(super) gradient: Vector12,
}

/// What the shape of the motion within a sweep adds to the pose at its end, one standard deviation.
const LOOSE_RAD: f64 = 2.0e-4;
const LOOSE_M: f64 = 5.0e-4;
/// What a sensor at rest still moves from sweep to sweep, and its velocity, one standard deviation.
const REST_RAD: f64 = 1.0e-5;
const REST_M: f64 = 5.0e-5;
const REST_RADPS: f64 = 3.0e-3;
const REST_MPS: f64 = 5.0e-3;
/// First row of each velocity in the state.
const ANGULAR: usize = 6;
const LINEAR: usize = 9;

impl MotionState {
    /// At the origin of the map, which is exact, with a velocity that is not known: it has the deviation that a second of
    /// motion gives it.
    #[must_use]
    pub fn at_origin(unknown: &MotionNoise) -> Self {
        let exact = 1.0e-8;
        let mut variances = Vector12::repeat(exact);
        let square = |deviation: Vector3<f64>| deviation.component_mul(&deviation);
        variances.fixed_rows_mut::<3>(ANGULAR).copy_from(&square(unknown.angular_radps));
        variances.fixed_rows_mut::<3>(LINEAR).copy_from(&square(unknown.linear_mps));
        let covariance = Matrix12::from_diagonal(&variances);
        Self { pose: Pose3::identity(), twist: Twist3::zero(), covariance }
    }

    /// The state after a time ≥ 0 without a measurement. The velocity is the mean one of the time: it changes at its
    /// beginning, and pose and velocity err together. (Were they free of each other, sweeps could be straightened by a wrong
    /// velocity, and leave a map in which that velocity fits.)
    #[must_use]
    pub fn predicted(&self, seconds: f64, noise: &MotionNoise) -> Self {
        let motion = self.twist.over(seconds);
        let mut step = Matrix12::identity();
        step.fixed_view_mut::<6, 6>(0, 0).copy_from(&motion.error_transport());
        step.fixed_view_mut::<6, 6>(0, ANGULAR).fill_diagonal(seconds);
        let mut covariance = step * self.covariance * step.transpose();
        let parts = [(0, ANGULAR, noise.angular_radps), (3, LINEAR, noise.linear_mps)];
        for (place, velocity, deviation) in parts {
            let variance = deviation.component_mul(&deviation) * seconds;
            let mut add = |row: usize, column: usize, factor: f64| {
                let mut block = covariance.view_mut((row, column), (3, 3));
                block += Matrix3::from_diagonal(&(variance * factor));
            };
            add(place, place, seconds * seconds);
            add(place, velocity, seconds);
            add(velocity, place, seconds);
            add(velocity, velocity, 1.0);
        }
        for (row, loose) in [(0, LOOSE_RAD), (3, LOOSE_M)] {
            let mut block = covariance.view_mut((row, row), (3, 3));
            block += Matrix3::identity() * (loose * loose);
        }
        Self { pose: self.pose.compose(&motion), twist: self.twist, covariance }
    }

    /// The state after a time at rest.
    #[must_use]
    pub fn resting(&self) -> Self {
        let mut covariance = Matrix12::zeros();
        covariance.fixed_view_mut::<6, 6>(0, 0).copy_from(&self.covariance.fixed_view::<6, 6>(0, 0));
        let loose = [(0, REST_RAD), (3, REST_M), (ANGULAR, REST_RADPS), (LINEAR, REST_MPS)];
        for (row, deviation) in loose {
            let mut block = covariance.view_mut((row, row), (3, 3));
            block += Matrix3::identity() * (deviation * deviation);
        }
        Self { pose: self.pose, twist: Twist3::zero(), covariance }
    }

    /// This state as a measurement of `other`: what pulls `other` back to it. `None` if the covariance is not positive.
    #[must_use]
    pub(super) fn information(&self) -> Option<Matrix12> {
        Some(self.covariance.cholesky()?.inverse())
    }

    /// The difference `self` − `from`, in the axes of `from`.
    pub(super) fn difference(&self, from: &Self) -> Vector12 {
        let between = from.pose.inverse().compose(&self.pose);
        let mut difference = Vector12::zeros();
        difference.fixed_rows_mut::<3>(0).copy_from(&between.rotation_vector());
        difference.fixed_rows_mut::<3>(3).copy_from(&between.place_m);
        difference
            .fixed_rows_mut::<3>(ANGULAR)
            .copy_from(&(self.twist.angular_radps - from.twist.angular_radps));
        difference.fixed_rows_mut::<3>(LINEAR).copy_from(&(self.twist.linear_mps - from.twist.linear_mps));
        difference
    }

    /// Corrected by a step in its own axes.
    pub(super) fn corrected(&self, step: &Vector12) -> Self {
        let part = |row: usize| step.fixed_rows::<3>(row).into_owned();
        Self {
            pose: self.pose.moved(part(0), part(3)),
            twist: Twist3 {
                angular_radps: self.twist.angular_radps + part(ANGULAR),
                linear_mps: self.twist.linear_mps + part(LINEAR),
            },
            covariance: self.covariance,
        }
    }
}

impl Quadratic {
    /// Of a prior: its information, and the difference of the state from it.
    pub(super) fn of_prior(information: &Matrix12, difference: &Vector12) -> Self {
        Self { information: *information, gradient: information * difference }
    }

    /// Counts what it says about a direction of the place (a unit vector), and of the velocity along it, with a share only,
    /// 0 to 1; 0 is as if an unknown shift along the direction were part of every return (the Schur complement).
    pub(super) fn reduce(&mut self, direction: &Vector3<f64>, share: f64) {
        for row in [3, LINEAR] {
            let mut along = Vector12::zeros();
            along.fixed_rows_mut::<3>(row).copy_from(direction);
            let pull = self.information * along;
            let value = pull.dot(&along);
            if value > 0.0 {
                let factor = (1.0 - share) / value;
                self.gradient -= pull * (along.dot(&self.gradient) * factor);
                self.information -= pull * pull.transpose() * factor;
            }
        }
    }

    /// Squared deviations of the best pose from the present one; `None` where no pose is best.
    pub(super) fn pose_tension(&self) -> Option<f64> {
        let information = self.information.fixed_view::<6, 6>(0, 0).into_owned();
        let gradient = self.gradient.fixed_rows::<6>(0).into_owned();
        Some(information.cholesky()?.solve(&gradient).dot(&gradient))
    }

    /// What wheels and gyroscope say about the velocity.
    pub(super) fn add_aid(&mut self, aid: &MotionAid, twist: &Twist3) {
        if let Some(wheels) = aid.wheels {
            self.add_vector(LINEAR, twist.linear_mps, &wheels.linear_mps);
            self.add_vector(ANGULAR, twist.angular_radps, &wheels.angular_radps);
        }
        if let Some(rate) = aid.gyroscope {
            self.add_vector(ANGULAR, twist.angular_radps, &rate);
        }
    }

    fn add_vector(&mut self, row: usize, value: Vector3<f64>, measured: &Gaussian3) {
        let information = measured.deviation.map(|deviation| 1.0 / (deviation * deviation).max(1.0e-12));
        let mut block = self.information.view_mut((row, row), (3, 3));
        block += Matrix3::from_diagonal(&information);
        let mut gradient = self.gradient.rows_mut(row, 3);
        gradient += information.component_mul(&(value - measured.mean));
    }

    /// What a level floor says about height, roll and pitch.
    pub(super) fn add_floor(&mut self, floor: &FloorPrior, pose: &Pose3) {
        let up = pose.rotation.transpose() * Vector3::z();
        let mut add = |rows: [(usize, f64); 3], residual: f64, deviation: f64| {
            let mut row = Vector12::zeros();
            for (index, value) in rows {
                row.rows_mut(index, 1).fill(value);
            }
            let weight = 1.0 / (deviation * deviation).max(1.0e-12);
            self.information += row * row.transpose() * weight;
            self.gradient += row * (residual * weight);
        };
        add([(3, up.x), (4, up.y), (5, up.z)], pose.place_m.z, floor.height_m);
        add([(0, 0.0), (1, -up.z), (2, up.y)], up.x, floor.tilt_rad);
        add([(0, up.z), (1, 0.0), (2, -up.x)], up.y, floor.tilt_rad);
    }
}
