//! What the guard does at a moment, in the words of a program outside.

use floorguard_types::time::Stamp;

/// What the guard does to the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Restraint {
    /// Nothing.
    #[default]
    None,
    /// It limits the speed.
    Slows,
    /// It holds the robot.
    Stops,
}

/// The robot at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotMoment {
    /// On the robot's clock.
    pub at: Stamp,
    /// What the guard does.
    pub restraint: Restraint,
    /// Why, in few words; empty without a restraint.
    pub cause: String,
    /// The greatest permitted speed, m/s.
    pub limit_mps: f32,
}
