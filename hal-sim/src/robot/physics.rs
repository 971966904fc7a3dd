//! Motion of the three-wheeled base: steered and powered front wheel, encoders on the rear wheels (book, Odometry:
//! Tricycle).

use floorguard_types::geometry::{Pose2, Twist2, wrap_angle};

use super::RobotParameters;

/// How the front wheel is held at this moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BrakeLaw {
    /// The drive has power and follows this rim speed, m/s.
    Driven(f32),
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
    /// Ground speed at the front wheel, m/s.
    front_mps: f32,
    steering_rad: f32,
    acceleration_mps2: f32,
    unpowered_s: f32,
    /// Metres rolled by the left and right rear wheel.
    rolled_m: [f64; 2],
    /// Share of the grip that is left: 1 dry, 0.3 wet soap.
    pub grip: f32,
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
            steering_rad: 0.0,
            acceleration_mps2: 0.0,
            unpowered_s: 0.0,
            rolled_m: [0.0; 2],
            grip: 1.0,
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

    /// Of the middle of the rear axle, robot frame.
    #[must_use]
    pub fn twist(&self) -> Twist2 {
        let (sin, cos) = libm::sincosf(self.steering_rad);
        Twist2 {
            linear_mps: self.front_mps * cos,
            angular_radps: self.front_mps * sin / self.parameters.wheelbase_m,
        }
    }

    /// Counter-clockwise, radians.
    #[must_use]
    pub const fn steering_rad(&self) -> f32 {
        self.steering_rad
    }

    /// Ground speed at the front wheel, m/s.
    #[must_use]
    pub const fn front_mps(&self) -> f32 {
        self.front_mps
    }

    /// Along the robot, m/s².
    #[must_use]
    pub const fn acceleration_mps2(&self) -> f32 {
        self.acceleration_mps2
    }

    /// Counts of the left and right encoder `ahead_s` after the last step.
    #[must_use]
    pub fn counts(&self, ahead_s: f32) -> [i64; 2] {
        let speeds = self.wheel_speeds();
        [0, 1].map(|side| {
            let travel = self.rolled_m[side] + f64::from(speeds[side] * ahead_s);
            (travel * f64::from(self.parameters.ticks_per_m)).floor() as i64
        })
    }

    /// Encoder counts per metre.
    #[must_use]
    pub const fn ticks_per_m(&self) -> f32 {
        self.parameters.ticks_per_m
    }

    /// Ground speed of the left and right rear wheel, m/s.
    #[must_use]
    pub fn wheel_speeds(&self) -> [f32; 2] {
        let twist = self.twist();
        let half = twist.angular_radps * self.parameters.track_m / 2.0;
        [twist.linear_mps - half, twist.linear_mps + half]
    }

    /// One step. `steering_target_rad` is `None` while the steering drive is off.
    pub fn step(&mut self, step_s: f32, law: BrakeLaw, steering_target_rad: Option<f32>) {
        let grip = self.parameters.grip_mps2 * self.grip;
        let (wanted, limit) = match law {
            BrakeLaw::Driven(rim_mps) => {
                self.unpowered_s = 0.0;
                (rim_mps, grip)
            }
            BrakeLaw::Braked => {
                self.unpowered_s += step_s;
                let holds = self.unpowered_s >= self.parameters.brake_delay_s;
                // Before the brake grips only rolling friction slows the robot.
                (0.0, if holds { self.parameters.brake_mps2.min(grip) } else { 0.1 })
            }
        };
        let before = self.twist().linear_mps;
        self.front_mps += (wanted - self.front_mps).clamp(-limit * step_s, limit * step_s);
        if let Some(target) = steering_target_rad {
            let max = self.parameters.steering_max_rad;
            let step = self.parameters.steering_rate_radps * step_s;
            self.steering_rad += (target.clamp(-max, max) - self.steering_rad).clamp(-step, step);
        }
        self.roll(step_s);
        self.acceleration_mps2 = (self.twist().linear_mps - before) / step_s.max(1.0e-6);
    }

    fn roll(&mut self, step_s: f32) {
        let twist = self.twist();
        let (ds, dh) = (f64::from(twist.linear_mps * step_s), f64::from(twist.angular_radps * step_s));
        let middle = self.heading_rad + dh / 2.0;
        self.x_m += ds * libm::cos(middle);
        self.y_m += ds * libm::sin(middle);
        self.heading_rad += dh;
        let speeds = self.wheel_speeds();
        for (travel, speed) in self.rolled_m.iter_mut().zip(speeds) {
            *travel += f64::from(speed * step_s);
        }
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
}
