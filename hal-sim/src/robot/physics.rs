//! Motion of the base: a steered and powered front wheel with encoders on the rear wheels (book, Odometry: Tricycle), a powered rear
//! axle with steered front wheels, or a drive on each of two or four wheels.

use floorguard_types::geometry::{Point2, Pose2, Twist2, wrap_angle};

use super::rolling::{PlanarVelocity, body, rims};
use super::{RobotParameters, Train};

/// How the wheels are held at this moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BrakeLaw {
    /// The drive has power and follows this speed, m/s: of the front wheel's rim, or of the rear axle.
    Driven(f32),
    /// The drives of the wheels follow these rim speeds, m/s; one without power has its brake on.
    Wheels([Option<f32>; 4]),
    /// No power: the spring brake falls in.
    Braked,
}

/// The moving robot.
#[derive(Clone, Debug)]
pub struct RobotBody {
    parameters: RobotParameters,
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    /// Ground speed at the front wheel, or of the rear axle, m/s.
    front_mps: f32,
    /// Rim speeds of wheels that have a drive each, m/s.
    rims_mps: [f32; 4],
    steering_rad: f32,
    acceleration_mps2: f32,
    unpowered_s: f32,
    /// Metres rolled by each wheel that measures: left and right, or all four.
    rolled_m: [f64; 4],
    /// Share of the grip that is left: 1 dry, 0.3 wet soap.
    pub grip: f32,
    /// Its drives turn so many times as fast as commanded; 1 unless they are broken.
    pub drive_gain: f32,
    /// Its drives report so much of what they turn; 1 unless they are broken.
    pub feedback_gain: f32,
    /// Each encoder counts so much of what its wheel rolls; 1 unless it is broken.
    pub encoder_gains: [f32; 4],
}

impl RobotBody {
    /// Standing at a pose.
    #[must_use]
    pub fn new(parameters: RobotParameters, pose: Pose2) -> Self {
        Self {
            parameters,
            x_m: f64::from(pose.x_m),
            y_m: f64::from(pose.y_m),
            heading_rad: f64::from(pose.heading_rad),
            front_mps: 0.0,
            rims_mps: [0.0; 4],
            steering_rad: 0.0,
            acceleration_mps2: 0.0,
            unpowered_s: 0.0,
            rolled_m: [0.0; 4],
            grip: 1.0,
            drive_gain: 1.0,
            feedback_gain: 1.0,
            encoder_gains: [1.0; 4],
        }
    }

    /// World frame.
    #[must_use]
    pub fn pose(&self) -> Pose2 {
        Pose2::new(self.x_m as f32, self.y_m as f32, wrap_angle(self.heading_rad as f32))
    }

    /// Where the robot is `ahead_s` later if nothing changes; for firings between two steps.
    #[must_use]
    pub fn pose_ahead(&self, ahead_s: f32) -> Pose2 {
        let twist = self.twist();
        let turned = twist.angular_radps * ahead_s;
        self.pose().compose(Pose2::new(
            twist.linear_mps * ahead_s,
            twist.linear_mps * ahead_s * turned / 2.0,
            turned,
        ))
    }

    /// A drive turns each wheel.
    const fn has_wheel_drives(&self) -> bool {
        matches!(self.parameters.train, Train::TwoWheels | Train::FourMecanum)
    }

    fn velocity(&self) -> PlanarVelocity {
        if self.has_wheel_drives() {
            return body(&self.parameters, self.rims_mps);
        }
        let Twist2 { linear_mps, angular_radps } = self.twist();
        PlanarVelocity { ahead_mps: linear_mps, left_mps: 0.0, turn_radps: angular_radps }
    }

    /// Of the base point, robot frame: the middle of the rear axle, or of the base.
    #[must_use]
    pub fn twist(&self) -> Twist2 {
        let (sin, cos) = libm::sincosf(self.steering_rad);
        let wheelbase_m = self.parameters.wheelbase_m;
        match self.parameters.train {
            Train::FrontWheel => {
                Twist2 { linear_mps: self.front_mps * cos, angular_radps: self.front_mps * sin / wheelbase_m }
            }
            // Both axles turn about the same point, on the line of the rear one.
            Train::RearAxle => Twist2 {
                linear_mps: self.front_mps,
                angular_radps: self.front_mps * sin / (cos * wheelbase_m),
            },
            Train::TwoWheels | Train::FourMecanum => {
                let PlanarVelocity { ahead_mps, turn_radps, .. } = body(&self.parameters, self.rims_mps);
                Twist2 { linear_mps: ahead_mps, angular_radps: turn_radps }
            }
        }
    }

    /// Counter-clockwise, radians.
    #[must_use]
    pub const fn steering_rad(&self) -> f32 {
        self.steering_rad
    }

    /// Speed of the powered front wheel, or of the powered rear axle, as its drive reports it, m/s.
    #[must_use]
    pub const fn front_mps(&self) -> f32 {
        self.front_mps * self.feedback_gain
    }

    /// Along the robot, m/s².
    #[must_use]
    pub const fn acceleration_mps2(&self) -> f32 {
        self.acceleration_mps2
    }

    /// Counts of the left and right encoder `ahead_s` after the last step.
    #[must_use]
    pub fn counts(&self, ahead_s: f32) -> [i64; 2] {
        let [left, right, ..] = self.wheel_counts(ahead_s);
        [left, right]
    }

    /// Counts of all wheels that measure, `ahead_s` after the last step.
    #[must_use]
    pub fn wheel_counts(&self, ahead_s: f32) -> [i64; 4] {
        let (rolled_m, speeds) = (self.rolled_m(), self.measured_mps());
        [0, 1, 2, 3].map(|wheel| {
            let ahead_m = f64::from(speeds[wheel] * self.encoder_gains[wheel] * ahead_s);
            ((rolled_m[wheel] + ahead_m) * f64::from(self.parameters.ticks_per_m)).floor() as i64
        })
    }

    /// Metres that each wheel has rolled that measures, as its encoder counts them.
    #[must_use]
    pub fn rolled_m(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|wheel| self.rolled_m[wheel] * f64::from(self.encoder_gains[wheel]))
    }

    /// Encoder counts per metre.
    #[must_use]
    pub const fn ticks_per_m(&self) -> f32 {
        self.parameters.ticks_per_m
    }

    /// Speed of the left and right rear wheel as their encoders count them, m/s; of wheels with drives, of the first two.
    #[must_use]
    pub fn wheel_speeds(&self) -> [f32; 2] {
        let [left, right, ..] = self.measured_mps();
        [left * self.encoder_gains[0], right * self.encoder_gains[1]]
    }

    /// Rim speeds of wheels that have a drive each, as the drives report them, m/s.
    #[must_use]
    pub fn rims_mps(&self) -> [f32; 4] {
        self.rims_mps.map(|rim_mps| rim_mps * self.feedback_gain)
    }

    /// Rim speeds that move the body like this, of wheels that have a drive each.
    #[must_use]
    pub fn rims_for(&self, twist: Twist2) -> [f32; 4] {
        let Twist2 { linear_mps, angular_radps } = twist;
        rims(
            &self.parameters,
            PlanarVelocity { ahead_mps: linear_mps, left_mps: 0.0, turn_radps: angular_radps },
        )
    }

    fn measured_mps(&self) -> [f32; 4] {
        if self.has_wheel_drives() {
            return self.rims_mps;
        }
        let twist = self.twist();
        let half = twist.angular_radps * self.parameters.track_m / 2.0;
        [twist.linear_mps - half, twist.linear_mps + half, 0.0, 0.0]
    }

    /// One step. `steering_target_rad` is `None` while the steering drive is off, or where nothing steers.
    pub fn step(&mut self, step_s: f32, law: BrakeLaw, steering_target_rad: Option<f32>) {
        let grip = self.parameters.grip_mps2 * self.grip;
        let is_powered = match law {
            BrakeLaw::Driven(_) => true,
            BrakeLaw::Wheels(wheels) => wheels.iter().all(Option::is_some),
            BrakeLaw::Braked => false,
        };
        self.unpowered_s = if is_powered { 0.0 } else { self.unpowered_s + step_s };
        // Before the brake grips only rolling friction slows the robot.
        let holds = self.unpowered_s >= self.parameters.brake_delay_s;
        let braked = (0.0, if holds { self.parameters.brake_mps2.min(grip) } else { 0.1 });
        let before = self.twist().linear_mps;
        let approach = |speed: &mut f32, (wanted, limit): (f32, f32)| {
            *speed += (wanted - *speed).clamp(-limit * step_s, limit * step_s);
        };
        match law {
            BrakeLaw::Driven(rim_mps) => approach(&mut self.front_mps, (self.drive_gain * rim_mps, grip)),
            BrakeLaw::Wheels(wheels) => {
                for (rim, wanted) in self.rims_mps.iter_mut().zip(wheels) {
                    approach(rim, wanted.map_or(braked, |wanted| (self.drive_gain * wanted, grip)));
                }
            }
            BrakeLaw::Braked => {
                approach(&mut self.front_mps, braked);
                self.rims_mps.iter_mut().for_each(|rim| approach(rim, braked));
            }
        }
        if let Some(target) = steering_target_rad {
            let max = self.parameters.steering_max_rad;
            let step = self.parameters.steering_rate_radps * step_s;
            self.steering_rad += (target.clamp(-max, max) - self.steering_rad).clamp(-step, step);
        }
        self.roll(step_s);
        self.acceleration_mps2 = (self.twist().linear_mps - before) / step_s.max(1.0e-6);
    }

    fn roll(&mut self, step_s: f32) {
        let velocity = self.velocity();
        let (ds, dh) = (f64::from(velocity.ahead_mps * step_s), f64::from(velocity.turn_radps * step_s));
        let middle = self.heading_rad + dh / 2.0;
        self.x_m += ds * libm::cos(middle);
        self.y_m += ds * libm::sin(middle);
        if velocity.left_mps != 0.0 {
            let aside = f64::from(velocity.left_mps * step_s);
            self.x_m -= aside * libm::sin(middle);
            self.y_m += aside * libm::cos(middle);
        }
        self.heading_rad += dh;
        let speeds = self.measured_mps();
        for (travel, speed) in self.rolled_m.iter_mut().zip(speeds) {
            *travel += f64::from(speed * step_s);
        }
    }

    /// Where the wheels touch the floor, robot frame, metres.
    #[must_use]
    pub fn wheels_m(parameters: &RobotParameters) -> Vec<Point2> {
        let (front_m, half_m) = (parameters.wheelbase_m, parameters.track_m / 2.0);
        let places: &[(f32, f32)] = match parameters.train {
            Train::FrontWheel => &[(front_m, 0.0), (0.0, half_m), (0.0, -half_m)],
            Train::TwoWheels => &[(0.0, half_m), (0.0, -half_m)],
            Train::RearAxle => &[(0.0, half_m), (0.0, -half_m), (front_m, half_m), (front_m, -half_m)],
            Train::FourMecanum => {
                let x_m = front_m / 2.0;
                &[(x_m, half_m), (x_m, -half_m), (-x_m, half_m), (-x_m, -half_m)]
            }
        };
        places.iter().map(|(x_m, y_m)| Point2::new(*x_m, *y_m)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> RobotBody {
        RobotBody::new(RobotParameters::default(), Pose2::default())
    }

    /// v²/(2b), plus the distance before the brake grips.
    #[test]
    fn braking_distance_follows_the_formula() {
        let mut robot = body();
        for _ in 0..1_000 {
            robot.step(0.001, BrakeLaw::Driven(1.0), Some(0.0));
        }
        let start = robot.pose().x_m;
        for _ in 0..2_000 {
            robot.step(0.001, BrakeLaw::Braked, None);
        }
        let travel = robot.pose().x_m - start;
        let expected = 0.05 + 0.995 * 0.995 / 3.0;
        assert!((travel - expected).abs() < 0.005, "{travel} against {expected}");
        assert_eq!(robot.front_mps(), 0.0);
    }

    /// α = atan(ωL/v), v_s = v/cos α.
    #[test]
    fn steering_and_rear_wheels_agree() {
        let mut robot = body();
        let angle = libm::atanf(0.3 * 0.8 / 0.5);
        for _ in 0..3_000 {
            robot.step(0.001, BrakeLaw::Driven(0.5 / libm::cosf(angle)), Some(angle));
        }
        let twist = robot.twist();
        assert!((twist.linear_mps - 0.5).abs() < 1e-4 && (twist.angular_radps - 0.3).abs() < 1e-4);
        let [left, right] = robot.wheel_speeds();
        assert!(((right - left) / 0.6 - 0.3).abs() < 1e-4);
    }

    /// A wheel whose drive has failed brakes, and turns the base towards its side.
    #[test]
    fn braked_wheel_turns_the_base() {
        let parameters = RobotParameters { train: Train::TwoWheels, ..RobotParameters::default() };
        let mut robot = RobotBody::new(parameters, Pose2::default());
        let ahead = BrakeLaw::Wheels([Some(0.5), Some(0.5), None, None].map(|wheel| wheel.or(Some(0.0))));
        (0..1_000).for_each(|_| robot.step(0.001, ahead, None));
        assert!((robot.twist().linear_mps - 0.5).abs() < 1e-4 && robot.twist().angular_radps == 0.0);
        let failed = BrakeLaw::Wheels([None, Some(0.5), Some(0.0), Some(0.0)]);
        (0..1_000).for_each(|_| robot.step(0.001, failed, None));
        assert!((robot.twist().angular_radps - 0.5 / 0.6).abs() < 1e-3, "{:?}", robot.twist());
    }

    /// A car's rear axle turns about the point that the front wheels look across to: tan α = L/R.
    #[test]
    fn rear_axle_follows_the_front_wheels() {
        let parameters = RobotParameters { train: Train::RearAxle, ..RobotParameters::default() };
        let mut robot = RobotBody::new(parameters, Pose2::default());
        let angle = libm::atanf(0.8 / 2.0);
        (0..3_000).for_each(|_| robot.step(0.001, BrakeLaw::Driven(0.5), Some(angle)));
        let twist = robot.twist();
        assert!((twist.linear_mps / twist.angular_radps - 2.0).abs() < 1e-3, "{twist:?}");
    }

    /// What a broken device says is not what the body does, whatever carries it.
    #[test]
    fn broken_devices_lie_on_every_base() {
        for train in [Train::FrontWheel, Train::RearAxle, Train::TwoWheels, Train::FourMecanum] {
            let parameters = RobotParameters { train, ..RobotParameters::default() };
            let mut robot = RobotBody::new(parameters, Pose2::default());
            robot.encoder_gains = [0.5, 0.25, 1.0, 1.0];
            robot.feedback_gain = 0.8;
            let law = if robot.has_wheel_drives() {
                BrakeLaw::Wheels([Some(0.5); 4])
            } else {
                BrakeLaw::Driven(0.5)
            };
            (0..2_000).for_each(|_| robot.step(0.001, law, None));
            assert!((robot.twist().linear_mps - 0.5).abs() < 1e-4, "{train:?}");
            let reported = if robot.has_wheel_drives() { robot.rims_mps()[0] } else { robot.front_mps() };
            assert!((reported - 0.4).abs() < 1e-4, "{train:?}: {reported}");
            let [left, right] = robot.wheel_speeds();
            assert!((left - 0.25).abs() < 1e-4 && (right - 0.125).abs() < 1e-4, "{train:?}: {left}, {right}");
            let travel = robot.pose().x_m;
            let [left_m, right_m, ..] = robot.rolled_m().map(|metres| metres as f32);
            let shares = [left_m / travel, right_m / travel];
            assert!(
                (shares[0] - 0.5).abs() < 1e-3 && (shares[1] - 0.25).abs() < 1e-3,
                "{train:?}: {shares:?}"
            );
            let [left, right] = robot.counts(0.1);
            let expected = [left_m + 0.025, right_m + 0.0125].map(|metres| metres * robot.ticks_per_m());
            let off = (left as f32 - expected[0]).abs().max((right as f32 - expected[1]).abs());
            assert!(off < 3.0, "{train:?}: {left}, {right} against {expected:?}");
        }
    }
}
