//! Extended Kalman filter over encoders and gyroscope (book, Odometry: Filter).
//!
//! State: x, y, heading, forward speed, turning rate, gyroscope bias. Every measurement is a single number, so that
//! an update divides by one positive scalar and never inverts a matrix; covariance in Joseph form.

use nalgebra::{Matrix6, RowVector6, Vector6};

use super::wheels::WheelMotion;
use floorguard_types::geometry::{Pose2, Twist2, wrap_angle};
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::{Age, Stamp};

/// What is believed about the errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryNoise {
    /// Random walk of the speed, (m/s)²/s.
    pub speed_walk: f32,
    /// Random walk of the turning rate, (rad/s)²/s.
    pub turn_walk: f32,
    /// Random walk of the gyroscope's bias, (rad/s)²/s.
    pub bias_walk: f32,
    /// Speed by encoders, m/s.
    pub encoder_speed_sigma_mps: f32,
    /// Turning rate by encoders, rad/s.
    pub encoder_turn_sigma_radps: f32,
    /// Turning rate by gyroscope, rad/s.
    pub gyroscope_sigma_radps: f32,
}

impl OdometryNoise {
    /// The values of the book, Odometry: Filter.
    pub const DEFAULT: Self = Self {
        speed_walk: 0.5,
        turn_walk: 1.0,
        bias_walk: 1.0e-6,
        encoder_speed_sigma_mps: 0.02,
        encoder_turn_sigma_radps: 0.05,
        gyroscope_sigma_radps: 0.005,
    };

    /// The same for measuring wheels that stand `track_m` apart: the turning rate is as sure as they are far from each other (book,
    /// Odometry: Bases).
    #[must_use]
    pub fn for_track(track_m: f32) -> Self {
        let sigma_radps = Self::DEFAULT.encoder_turn_sigma_radps * (TRACK_M / track_m.max(0.05));
        Self { encoder_turn_sigma_radps: sigma_radps, ..Self::DEFAULT }
    }
}

/// The track for which the default holds, metres.
const TRACK_M: f32 = 0.6;

/// What was refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OdometryCounters {
    /// Measurements outside the gate of three standard deviations.
    pub outliers: u32,
    /// Times that a run of outliers made the filter doubt itself.
    pub inflations: u32,
    /// Samples too old or too far ahead to be used.
    pub untimely: u32,
}

/// Squared number of standard deviations (book, Odometry: Filter).
const GATE: f32 = 9.0;
/// More refusals of one sensor in a row and it is the filter that is wrong.
const REFUSALS_MAX: u8 = 10;
/// Standing that long proves that the speed is zero, microseconds.
const STILL_US: u64 = 500_000;
/// Standard deviation of "it stands", m/s and rad/s.
const STILL_SIGMA: f32 = 1.0e-3;
/// A step longer than this is not integrated: the sources were gone, microseconds.
const STEP_MAX_US: u64 = 500_000;
/// A sample may be this much older than the state: sensors differ in latency, microseconds.
const LATE_MAX_US: u64 = 100_000;

#[derive(Clone, Copy)]
enum Sensor {
    EncoderSpeed,
    EncoderTurn,
    Gyroscope,
}

impl Sensor {
    const fn index(self) -> usize {
        match self {
            Self::EncoderSpeed => 0,
            Self::EncoderTurn => 1,
            Self::Gyroscope => 2,
        }
    }
}

/// The filter.
#[derive(Clone, Debug)]
pub struct Odometry {
    noise: OdometryNoise,
    state: Vector6<f32>,
    covariance: Matrix6<f32>,
    stamp: Option<Stamp>,
    still_since: Option<Stamp>,
    refusals: [u8; 3],
    counters: OdometryCounters,
}

impl Odometry {
    /// At the origin, standing, with an unknown bias of about 0.3 °/s.
    #[must_use]
    pub fn new(noise: OdometryNoise) -> Self {
        let variances = Vector6::new(0.0, 0.0, 0.0, 0.01, 0.01, 2.5e-5);
        Self {
            noise,
            state: Vector6::zeros(),
            covariance: Matrix6::from_diagonal(&variances),
            stamp: None,
            still_since: None,
            refusals: [0; 3],
            counters: OdometryCounters::default(),
        }
    }

    /// Encoders.
    pub fn on_wheels(&mut self, motion: &WheelMotion) {
        if !motion.twist.is_finite() || !self.predict(motion.stamp) {
            return;
        }
        let row = RowVector6::new(0.0, 0.0, 0.0, 1.0, 0.0, 0.0);
        let sigma = self.noise.encoder_speed_sigma_mps;
        self.update(Sensor::EncoderSpeed, row, motion.twist.linear_mps, sigma);
        let row = RowVector6::new(0.0, 0.0, 0.0, 0.0, 1.0, 0.0);
        let sigma = self.noise.encoder_turn_sigma_radps;
        self.update(Sensor::EncoderTurn, row, motion.twist.angular_radps, sigma);
        if !motion.still {
            self.still_since = None;
            return;
        }
        let since = *self.still_since.get_or_insert(motion.stamp);
        if matches!(since.age(motion.stamp), Age::Past(still_us) if still_us >= STILL_US) {
            let row = RowVector6::new(0.0, 0.0, 0.0, 1.0, 0.0, 0.0);
            self.update(Sensor::EncoderSpeed, row, 0.0, STILL_SIGMA);
            let row = RowVector6::new(0.0, 0.0, 0.0, 0.0, 1.0, 0.0);
            self.update(Sensor::EncoderTurn, row, 0.0, STILL_SIGMA);
        }
    }

    /// Gyroscope, in the robot's axes. A suspect sample is not used.
    pub fn on_imu(&mut self, sample: &ImuSample) {
        let [_, _, yaw_radps] = sample.angular_radps;
        if sample.suspect || !yaw_radps.is_finite() || !self.predict(sample.stamp) {
            return;
        }
        let row = RowVector6::new(0.0, 0.0, 0.0, 0.0, 1.0, 1.0);
        self.update(Sensor::Gyroscope, row, yaw_radps, self.noise.gyroscope_sigma_radps);
    }

    /// In the odometry frame, which begins where the filter began.
    #[must_use]
    pub fn pose(&self) -> Pose2 {
        let [x_m, y_m, heading_rad, ..] = self.numbers();
        Pose2 { x_m, y_m, heading_rad }
    }

    /// In the robot's frame.
    #[must_use]
    pub fn twist(&self) -> Twist2 {
        let [_, _, _, linear_mps, angular_radps, _] = self.numbers();
        Twist2 { linear_mps, angular_radps }
    }

    /// The gyroscope's bias, rad/s.
    #[must_use]
    pub fn bias_radps(&self) -> f32 {
        let [.., bias_radps] = self.numbers();
        bias_radps
    }

    /// Of the newest sample used.
    #[must_use]
    pub const fn stamp(&self) -> Option<Stamp> {
        self.stamp
    }

    /// Variances of x, y (m²) and heading (rad²).
    #[must_use]
    pub fn pose_variances(&self) -> [f32; 3] {
        let diagonal = self.covariance.diagonal();
        [diagonal.x, diagonal.y, diagonal.z]
    }

    /// What was refused.
    #[must_use]
    pub const fn counters(&self) -> OdometryCounters {
        self.counters
    }

    fn numbers(&self) -> [f32; 6] {
        self.state.into()
    }

    /// Moves the state to a moment. False when the sample cannot be used.
    fn predict(&mut self, stamp: Stamp) -> bool {
        let Some(last) = self.stamp else {
            self.stamp = Some(stamp);
            return true;
        };
        match last.age(stamp) {
            Age::Future(late_us) if late_us <= LATE_MAX_US => return true,
            Age::Future(_) => {
                self.counters.untimely = self.counters.untimely.saturating_add(1);
                return false;
            }
            Age::Past(step_us) if step_us > STEP_MAX_US => {
                self.counters.untimely = self.counters.untimely.saturating_add(1);
                self.stamp = Some(stamp);
                return true;
            }
            Age::Past(_) => {}
        }
        let seconds = stamp.seconds_since(last);
        self.stamp = Some(stamp);
        let [x_m, y_m, heading_rad, linear_mps, angular_radps, bias] = self.numbers();
        let (sin, cos) = libm::sincosf(heading_rad + 0.5 * angular_radps * seconds);
        self.state = Vector6::new(
            x_m + linear_mps * cos * seconds,
            y_m + linear_mps * sin * seconds,
            wrap_angle(heading_rad + angular_radps * seconds),
            linear_mps,
            angular_radps,
            bias,
        );
        #[rustfmt::skip]
        let jacobian = Matrix6::new(
            1.0, 0.0, -linear_mps * sin * seconds, cos * seconds, 0.0, 0.0,
            0.0, 1.0, linear_mps * cos * seconds, sin * seconds, 0.0, 0.0,
            0.0, 0.0, 1.0, 0.0, seconds, 0.0,
            0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
            0.0, 0.0, 0.0, 0.0, 1.0, 0.0,
            0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        );
        let noise = &self.noise;
        let walk = Vector6::new(0.0, 0.0, 0.0, noise.speed_walk, noise.turn_walk, noise.bias_walk);
        self.covariance =
            jacobian * self.covariance * jacobian.transpose() + Matrix6::from_diagonal(&(walk * seconds));
        true
    }

    /// One number: `measured` = row · state + noise of standard deviation `sigma`.
    fn update(&mut self, sensor: Sensor, row: RowVector6<f32>, measured: f32, sigma: f32) {
        let along = self.covariance * row.transpose();
        let variance = (row * along).x + sigma * sigma;
        let surprise = measured - (row * self.state).x;
        if !(variance.is_finite() && variance > 0.0) {
            return;
        }
        let Some(refusals) = self.refusals.get_mut(sensor.index()) else { return };
        if surprise * surprise > GATE * variance {
            *refusals = refusals.saturating_add(1);
            self.counters.outliers = self.counters.outliers.saturating_add(1);
            if *refusals <= REFUSALS_MAX {
                return;
            }
            // The sensor insists: doubt the motion, not the place.
            self.counters.inflations = self.counters.inflations.saturating_add(1);
            self.covariance += Matrix6::from_diagonal(&Vector6::new(0.0, 0.0, 0.0, 0.1, 0.1, 1.0e-5));
        }
        *refusals = 0;
        let gain = along / variance;
        self.state += gain * surprise;
        if let Some(heading_rad) = self.state.get_mut(2) {
            *heading_rad = wrap_angle(*heading_rad);
        }
        let rest = Matrix6::identity() - gain * row;
        self.covariance =
            rest * self.covariance * rest.transpose() + gain * gain.transpose() * (sigma * sigma);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wheels(micros: u64, linear_mps: f32, angular_radps: f32) -> WheelMotion {
        WheelMotion {
            stamp: Stamp::from_micros(micros),
            twist: Twist2 { linear_mps, angular_radps },
            distance_m: linear_mps * 0.01,
            turn_rad: angular_radps * 0.01,
            still: linear_mps == 0.0 && angular_radps == 0.0,
        }
    }

    fn imu(micros: u64, yaw_radps: f32) -> ImuSample {
        ImuSample {
            stamp: Stamp::from_micros(micros),
            angular_radps: [0.0, 0.0, yaw_radps],
            ..ImuSample::default()
        }
    }

    #[test]
    fn a_circle_closes() {
        let mut odometry = Odometry::new(OdometryNoise::DEFAULT);
        // 0.5 m/s at 0.25 rad/s: radius 2 m, once around in 8π s.
        let steps = (8.0 * core::f32::consts::PI / 0.01) as u64;
        for step in 0..=steps {
            odometry.on_wheels(&wheels(step * 10_000, 0.5, 0.25));
            odometry.on_imu(&imu(step * 10_000 + 5_000, 0.25));
        }
        let pose = odometry.pose();
        assert!(libm::hypotf(pose.x_m, pose.y_m) < 0.05, "{pose:?}");
        assert_eq!(odometry.counters().untimely, 0);
    }

    #[test]
    fn standstill_estimates_bias_and_keeps_heading() {
        let mut odometry = Odometry::new(OdometryNoise::DEFAULT);
        for step in 0..1_000 {
            odometry.on_wheels(&wheels(step * 10_000, 0.0, 0.0));
            odometry.on_imu(&imu(step * 10_000 + 5_000, 0.004));
        }
        assert!((odometry.bias_radps() - 0.004).abs() < 5e-4, "{}", odometry.bias_radps());
        assert!(odometry.pose().heading_rad.abs() < 0.01, "{:?}", odometry.pose());
    }

    #[test]
    fn one_outlier_is_refused_persistent_ones_accepted() {
        let mut odometry = Odometry::new(OdometryNoise::DEFAULT);
        for step in 0..100 {
            odometry.on_wheels(&wheels(step * 10_000, 0.5, 0.0));
        }
        let before = odometry.counters().outliers;
        odometry.on_wheels(&wheels(1_000_000, 5.0, 0.0));
        assert_eq!(odometry.counters().outliers, before + 1);
        assert!((odometry.twist().linear_mps - 0.5).abs() < 0.01);
        for step in 101..160 {
            odometry.on_wheels(&wheels(step * 10_000, 1.2, 0.0));
        }
        assert!((odometry.twist().linear_mps - 1.2).abs() < 0.01, "{:?}", odometry.twist());
    }

    #[test]
    fn past_stamps_and_gaps_move_nothing() {
        let mut odometry = Odometry::new(OdometryNoise::DEFAULT);
        odometry.on_wheels(&wheels(1_000_000, 0.5, 0.0));
        odometry.on_wheels(&wheels(10_000, 0.5, 0.0));
        odometry.on_wheels(&wheels(9_000_000, 0.5, 0.0));
        assert!(odometry.pose().x_m.abs() < 1e-3);
        assert_eq!(odometry.counters().untimely, 2);
        let nan = WheelMotion {
            twist: Twist2 { linear_mps: f32::NAN, angular_radps: 0.0 },
            ..wheels(9_010_000, 0.5, 0.0)
        };
        odometry.on_wheels(&nan);
        assert!(odometry.pose().x_m.is_finite());
    }
}
