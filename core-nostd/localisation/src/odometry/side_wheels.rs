//! Bases without a steered wheel: the left and the right side turn at speeds of their own (book, Odometry: Bases).

use floorguard_types::geometry::Twist2;

use super::base_model::BaseModel;

/// Speeds of both sides over ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideSpeeds {
    /// Of the wheels on the left, m/s.
    pub left_mps: f32,
    /// Of the wheels on the right, m/s.
    pub right_mps: f32,
}

/// A differential base (one driven wheel on each side of an axle), or an omnidirectional one that is not driven sideways: four
/// Mecanum wheels, of which those of one side turn alike.
///
/// ```
/// use floorguard_localisation::odometry::{BaseModel, SideWheels};
/// use floorguard_types::geometry::Twist2;
///
/// let base = SideWheels::differential(0.5);
/// let wheels = base.wheels(Twist2 { linear_mps: 0.4, angular_radps: 0.8 });
/// assert!((wheels.left_mps - 0.2).abs() < 1.0e-6 && (wheels.right_mps - 0.6).abs() < 1.0e-6);
/// // Four Mecanum wheels turn as a differential base does whose track is length plus width.
/// assert_eq!(SideWheels::mecanum(0.4, 0.5).track_m, 0.9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideWheels {
    /// Distance between the sides, metres, > 0; of Mecanum wheels what turns alike.
    pub track_m: f32,
}

impl SideWheels {
    /// Two driven wheels, `track_m` apart. Siegwart and Nourbakhsh (2004), section 3.2.3.
    #[must_use]
    pub const fn differential(track_m: f32) -> Self {
        Self { track_m }
    }

    /// Four Mecanum wheels at the corners of a rectangle. With rollers at 45° the wheels of one side turn alike when the base does
    /// not move sideways, and `ω = (right − left)/(length + width)`. Muir and Neuman (1987), section 4.
    #[must_use]
    pub const fn mecanum(wheelbase_m: f32, track_m: f32) -> Self {
        Self { track_m: wheelbase_m + track_m }
    }

    /// Half the distance between the sides: how much faster the outer wheel is than the base point, metres per radian.
    #[must_use]
    pub const fn lever_m(&self) -> f32 {
        0.5 * self.track_m
    }
}

impl BaseModel for SideWheels {
    type Wheels = SideSpeeds;

    fn wheels(&self, twist: Twist2) -> SideSpeeds {
        let across_mps = twist.angular_radps * self.lever_m();
        SideSpeeds { left_mps: twist.linear_mps - across_mps, right_mps: twist.linear_mps + across_mps }
    }

    fn twist(&self, wheels: &SideSpeeds) -> Twist2 {
        Twist2 {
            linear_mps: 0.5 * (wheels.left_mps + wheels.right_mps),
            angular_radps: (wheels.right_mps - wheels.left_mps) / self.track_m.max(1.0e-3),
        }
    }

    /// All of them.
    fn drivable(&self, twist: Twist2) -> Twist2 {
        twist
    }

    fn fastest_wheel_mps(&self, twist: Twist2) -> f32 {
        libm::fabsf(twist.linear_mps) + libm::fabsf(twist.angular_radps) * self.lever_m()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wheel on a circle of radius r about the turning point is as fast as ω·r: textbook geometry, without the formulas above.
    #[test]
    fn wheels_roll_on_circles() {
        let base = SideWheels::differential(0.6);
        let (radius_m, angular_radps) = (2.0, 0.25);
        let wheels = base.wheels(Twist2 { linear_mps: radius_m * angular_radps, angular_radps });
        assert!((wheels.left_mps - angular_radps * (radius_m - 0.3)).abs() < 1.0e-6);
        assert!((wheels.right_mps - angular_radps * (radius_m + 0.3)).abs() < 1.0e-6);
        let spin = base.wheels(Twist2 { linear_mps: 0.0, angular_radps: 1.0 });
        assert_eq!(spin, SideSpeeds { left_mps: -0.3, right_mps: 0.3 });
    }

    #[test]
    fn motion_comes_back_from_the_wheels() {
        let base = SideWheels::mecanum(0.35, 0.45);
        for step in 0..100_u8 {
            let linear_mps = f32::from(step % 10) * 0.2 - 1.0;
            let angular_radps = f32::from(step / 10) * 0.3 - 1.5;
            let twist = Twist2 { linear_mps, angular_radps };
            let back = base.twist(&base.wheels(twist));
            assert!((back.linear_mps - linear_mps).abs() < 1.0e-5, "{twist:?} {back:?}");
            assert!((back.angular_radps - angular_radps).abs() < 1.0e-5, "{twist:?} {back:?}");
            let wheels = base.wheels(twist);
            let fastest_mps = wheels.left_mps.abs().max(wheels.right_mps.abs());
            assert!((base.fastest_wheel_mps(twist) - fastest_mps).abs() < 1.0e-5);
        }
    }
}
