//! Poses and velocities in space, in double precision, without the trigonometry of the platform.

use nalgebra::{Matrix3, Matrix6, Vector3};

/// Below this angle the series is more exact than the quotient, radians.
const SMALL_RAD: f64 = 1.0e-4;

/// Where a frame stands in another one. Invariant: the rotation is orthonormal to within rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose3 {
    /// From the inner frame to the outer one.
    pub rotation: Matrix3<f64>,
    /// Origin of the inner frame in the outer one, metres.
    pub place_m: Vector3<f64>,
}

/// A constant velocity of a body, in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist3 {
    /// rad/s about the body's axes.
    pub angular_radps: Vector3<f64>,
    /// m/s along the body's axes.
    pub linear_mps: Vector3<f64>,
}

/// The matrix of the cross product with `v` from the left.
#[must_use]
pub fn cross_matrix(v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

/// sin θ / θ, (1 − cos θ) / θ² and (θ − sin θ) / θ³.
fn quotients(angle_rad: f64) -> [f64; 3] {
    let square = angle_rad * angle_rad;
    if angle_rad < SMALL_RAD {
        return [1.0 - square / 6.0, 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0];
    }
    let (sin, cos) = libm::sincos(angle_rad);
    [sin / angle_rad, (1.0 - cos) / square, (angle_rad - sin) / (square * angle_rad)]
}

impl Twist3 {
    /// At rest.
    #[must_use]
    pub fn zero() -> Self {
        Self { angular_radps: Vector3::zeros(), linear_mps: Vector3::zeros() }
    }

    /// The motion of this velocity over a time (negative: back in time), seen from where it began: the exponential map of
    /// the rigid motions.
    #[must_use]
    pub fn over(&self, seconds: f64) -> Pose3 {
        let turn = self.angular_radps * seconds;
        let [sine, cosine, rest] = quotients(libm::sqrt(turn.norm_squared()));
        let cross = cross_matrix(&turn);
        let square = cross * cross;
        let mean = Matrix3::identity() + cross * cosine + square * rest;
        Pose3 {
            rotation: Matrix3::identity() + cross * sine + square * cosine,
            place_m: mean * self.linear_mps * seconds,
        }
    }
}

impl Pose3 {
    /// The frame itself.
    #[must_use]
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), place_m: Vector3::zeros() }
    }

    /// `self` followed by `inner`.
    #[must_use]
    pub fn compose(&self, inner: &Self) -> Self {
        Self {
            rotation: orthonormal(&(self.rotation * inner.rotation)),
            place_m: self.rotation * inner.place_m + self.place_m,
        }
    }

    /// The pose that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let back = self.rotation.transpose();
        Self { rotation: back, place_m: -(back * self.place_m) }
    }

    /// A point of the inner frame in the outer one.
    #[must_use]
    pub fn transform(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.place_m
    }

    /// The rotation as axis times angle, radians; for angles below 180°.
    #[must_use]
    pub fn rotation_vector(&self) -> Vector3<f64> {
        let m = &self.rotation;
        let sine = Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12) * 0.5;
        let length = libm::sqrt(sine.norm_squared());
        let angle_rad = libm::atan2(length, 0.5 * (m.trace() - 1.0));
        if length < 1.0e-9 { sine } else { sine * (angle_rad / length) }
    }

    /// Rotation as quaternion x, y, z, w with w ≥ 0.
    #[must_use]
    pub fn quaternion(&self) -> [f64; 4] {
        let vector = self.rotation_vector();
        let angle_rad = libm::sqrt(vector.norm_squared());
        let (sin, cos) = libm::sincos(0.5 * angle_rad);
        let scale = if angle_rad < SMALL_RAD { 0.5 } else { sin / angle_rad };
        [vector.x * scale, vector.y * scale, vector.z * scale, cos]
    }

    /// Turned by a rotation vector and moved by a step, both small and in the inner frame.
    #[must_use]
    pub fn moved(&self, turn_rad: Vector3<f64>, step_m: Vector3<f64>) -> Self {
        let turn = Twist3 { angular_radps: turn_rad, linear_mps: Vector3::zeros() }.over(1.0);
        self.compose(&Self { rotation: turn.rotation, place_m: step_m })
    }

    /// How errors of rotation and place in the outer frame of `self` appear in its inner frame.
    #[must_use]
    pub(super) fn error_transport(&self) -> Matrix6<f64> {
        let back = self.rotation.transpose();
        let mut transport = Matrix6::zeros();
        transport.fixed_view_mut::<3, 3>(0, 0).copy_from(&back);
        transport.fixed_view_mut::<3, 3>(3, 3).copy_from(&back);
        transport.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-(back * cross_matrix(&self.place_m))));
        transport
    }
}

/// One step of Newton's method towards the nearest rotation.
fn orthonormal(m: &Matrix3<f64>) -> Matrix3<f64> {
    m * (Matrix3::identity() * 3.0 - m.transpose() * m) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn twist() -> Twist3 {
        Twist3 { angular_radps: Vector3::new(0.1, -0.2, 0.7), linear_mps: Vector3::new(1.0, 0.3, -0.1) }
    }

    #[test]
    fn exponential_agrees_with_many_small_steps() {
        let steps = 100_000;
        let mut pose = Pose3::identity();
        for _ in 0..steps {
            let (turn, step) = (twist().angular_radps, twist().linear_mps);
            pose = pose.moved(turn / f64::from(steps), step / f64::from(steps));
        }
        let exact = twist().over(1.0);
        assert!((exact.place_m - pose.place_m).norm() < 1.0e-5, "{exact:?} {pose:?}");
        assert!((exact.rotation - pose.rotation).norm() < 1.0e-9);
        assert!((exact.rotation_vector() - twist().angular_radps).norm() < 1.0e-12);
    }

    #[test]
    fn going_back_in_time_undoes_a_motion() {
        let there = twist().over(0.4);
        let back = there.compose(&twist().over(-0.4));
        assert!(back.place_m.norm() < 1.0e-12 && back.rotation_vector().norm() < 1.0e-12);
        let nothing = there.compose(&there.inverse());
        assert!(nothing.place_m.norm() < 1.0e-12 && nothing.rotation_vector().norm() < 1.0e-12);
    }

    #[test]
    fn quaternion_turns_as_the_matrix() {
        let pose = twist().over(1.0);
        let [x, y, z, w] = pose.quaternion();
        let quaternion = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        assert!((quaternion.to_rotation_matrix().matrix() - pose.rotation).norm() < 1.0e-12);
    }
}
