//! From near to exactly there, by the pose of the robot in the frame of the place: x ahead, the place at the origin.
//!
//! Onto the line through the place the robot steers by its distance from it and by its heading, both weighed so that they fade together
//! without a swing: over a way s the distance y follows y″ = −y / l² − 2 y′ / l, critically damped (l: `line_m`).

use floorguard_types::geometry::{Pose2, Twist2};

use super::config::DockingConfig;

/// A try that ended beyond the place goes back so far at least before the next one, metres.
const BEYOND_M: f32 = 0.3;
/// So near to the line, as a share of what counts, nothing has to be done about it any more.
const NEAR: f32 = 0.7;
/// A turn ends a little inside of what counts.
const INSIDE: f32 = 0.4;

/// What to do now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DockStep {
    /// Go on with this velocity; it may be none while the robot looks.
    Drive(Twist2),
    /// It stands where it should.
    Docked,
    /// It did not meet the place in all its tries.
    Failed,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// Ahead, onto the place.
    Ahead,
    /// It stands, and has done so for so many commands.
    Stands(u8),
    /// On the spot.
    Turns,
    /// Back until x is less than this.
    Back(f32),
}

/// An approach.
#[derive(Clone, Debug)]
pub struct DockApproach {
    config: DockingConfig,
    phase: Phase,
    tries: u8,
}

impl DockApproach {
    /// Before the first try.
    #[must_use]
    pub const fn new(config: DockingConfig) -> Self {
        Self { config, phase: Phase::Ahead, tries: 0 }
    }

    /// Tries that have ended without meeting the place.
    #[must_use]
    pub const fn tries(&self) -> u8 {
        self.tries
    }

    /// The next command, for the robot at this pose in the frame of the place. Constant cost.
    pub fn step(&mut self, robot_in_dock: Pose2) -> DockStep {
        // A change of phase gives its first command at once: two changes at most, from standing to a turn that is not needed.
        for _ in 0..3 {
            let step = match self.phase {
                Phase::Ahead => self.ahead(robot_in_dock),
                Phase::Stands(count) => self.look(robot_in_dock, count),
                Phase::Turns => self.turn(robot_in_dock),
                Phase::Back(until_m) => self.back(robot_in_dock, until_m),
            };
            if let Some(step) = step {
                return step;
            }
        }
        DockStep::Drive(Twist2::ZERO)
    }

    /// `None`: the place is reached or passed.
    fn ahead(&mut self, robot: Pose2) -> Option<DockStep> {
        let left_m = -robot.x_m;
        let config = &self.config;
        if left_m <= config.creep_mps * config.response_s {
            self.phase = Phase::Stands(0);
            return None;
        }
        let slowed_mps = libm::sqrtf(2.0 * config.braking_mps2 * left_m);
        let speed_mps = slowed_mps.min(config.speed_mps).max(config.creep_mps);
        let is_on_line = left_m < config.align_m && libm::fabsf(robot.y_m) < NEAR * config.within_m;
        let aside_m = if is_on_line { 0.0 } else { robot.y_m };
        let curvature = self.curvature(aside_m, robot.heading_rad);
        Some(DockStep::Drive(Twist2 { linear_mps: speed_mps, angular_radps: speed_mps * curvature }))
    }

    /// The bend that leads onto the line, for a distance to its left and a heading to its left.
    fn curvature(&self, aside_m: f32, heading_rad: f32) -> f32 {
        let line_m = self.config.line_m.max(0.01);
        let wanted = -aside_m / (line_m * line_m) - 2.0 * heading_rad / line_m;
        wanted.clamp(-self.config.curvature_per_m, self.config.curvature_per_m)
    }

    /// What was reached, after a while of standing: a filter behind the sensors settles meanwhile.
    fn look(&mut self, robot: Pose2, count: u8) -> Option<DockStep> {
        if count < self.config.stands {
            self.phase = Phase::Stands(count.saturating_add(1));
            return Some(DockStep::Drive(Twist2::ZERO));
        }
        let within_m = self.config.within_m;
        let is_aside = libm::fabsf(robot.y_m) > within_m;
        if !is_aside && libm::fabsf(robot.x_m) <= within_m {
            if libm::fabsf(robot.heading_rad) <= self.config.within_rad {
                return Some(DockStep::Docked);
            }
            self.phase = Phase::Turns;
            return None;
        }
        if !is_aside && robot.x_m < 0.0 {
            self.phase = Phase::Ahead;
            return None;
        }
        self.tries = self.tries.saturating_add(1);
        if self.tries >= self.config.tries {
            return Some(DockStep::Failed);
        }
        let way_m = if is_aside { self.config.back_m } else { BEYOND_M };
        self.phase = Phase::Back(-way_m);
        None
    }

    fn turn(&mut self, robot: Pose2) -> Option<DockStep> {
        let off_rad = libm::fabsf(robot.heading_rad);
        if off_rad <= INSIDE * self.config.within_rad {
            self.phase = Phase::Stands(0);
            return None;
        }
        let [slowest, fastest] = self.config.turn_radps;
        let rate_radps = off_rad.max(slowest).min(fastest);
        let angular_radps = -libm::copysignf(rate_radps, robot.heading_rad);
        Some(DockStep::Drive(Twist2 { linear_mps: 0.0, angular_radps }))
    }

    /// Backwards along the line: what is behind the robot then leads.
    fn back(&mut self, robot: Pose2, until_m: f32) -> Option<DockStep> {
        if robot.x_m <= until_m {
            self.phase = Phase::Ahead;
            return None;
        }
        let curvature = self.curvature(-robot.y_m, robot.heading_rad);
        let speed_mps = self.config.reverse_mps;
        Some(DockStep::Drive(Twist2 { linear_mps: -speed_mps, angular_radps: speed_mps * curvature }))
    }
}
