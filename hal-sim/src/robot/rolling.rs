//! How wheels that roll without slip move a body: written from where each wheel touches the floor and in which direction it can
//! roll, and from nothing that the robot's own software uses.
//!
//! A driven wheel at a place of a rigid body rolls with the velocity of that place along the wheel; what it measures is that
//! component. A Mecanum wheel measures the component along its rollers' free direction's normal, which mixes both axes.

use super::{RobotParameters, Train};

/// Velocity of the base point in the robot frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PlanarVelocity {
    /// Forward, m/s.
    pub ahead_mps: f32,
    /// To the left, m/s.
    pub left_mps: f32,
    /// Counter-clockwise, rad/s.
    pub turn_radps: f32,
}

/// A driven wheel: where it is, and the direction along which the floor drives it, scaled so that its rim's speed is the
/// component of the floor's velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Contact {
    at_m: [f32; 2],
    along: [f32; 2],
}

/// Wheels of a base that has a drive on each of them.
fn contacts(parameters: &RobotParameters) -> Vec<Contact> {
    let half_m = parameters.track_m / 2.0;
    let straight = [1.0, 0.0];
    match parameters.train {
        Train::FrontWheel | Train::RearAxle | Train::TwoWheels => {
            [half_m, -half_m].map(|y_m| Contact { at_m: [0.0, y_m], along: straight }).to_vec()
        }
        Train::FourMecanum => {
            let x_m = parameters.wheelbase_m / 2.0;
            // Rollers at 45° whose axes point towards the middle, seen from above: the rim's speed is forward minus or plus sideways.
            [(x_m, half_m, -1.0), (x_m, -half_m, 1.0), (-x_m, half_m, 1.0), (-x_m, -half_m, -1.0)]
                .map(|(x_m, y_m, aside)| Contact { at_m: [x_m, y_m], along: [1.0, aside] })
                .to_vec()
        }
    }
}

/// Rim speed of each driven or measuring wheel while the body moves like this, m/s.
pub(super) fn rims(parameters: &RobotParameters, velocity: PlanarVelocity) -> [f32; 4] {
    let mut speeds = [0.0; 4];
    for (speed, wheel) in speeds.iter_mut().zip(contacts(parameters)) {
        // The velocity of a place of a rigid body: that of the base point plus ω × r.
        let ahead_mps = velocity.ahead_mps - velocity.turn_radps * wheel.at_m[1];
        let left_mps = velocity.left_mps + velocity.turn_radps * wheel.at_m[0];
        *speed = wheel.along[0] * ahead_mps + wheel.along[1] * left_mps;
    }
    speeds
}

/// How the body moves when its wheels turn at these rim speeds. Four wheels may contradict each other; then all slip a little, and the
/// sum of the squares of what they slip is least.
pub(super) fn body(parameters: &RobotParameters, speeds: [f32; 4]) -> PlanarVelocity {
    if parameters.train == Train::TwoWheels {
        let [left_mps, right_mps, ..] = speeds;
        let turn_radps = (right_mps - left_mps) / parameters.track_m;
        return PlanarVelocity { ahead_mps: (left_mps + right_mps) / 2.0, left_mps: 0.0, turn_radps };
    }
    // One unit of each motion turns the wheels like this; the three columns are square to each other.
    let column = |ahead_mps, left_mps, turn_radps| {
        rims(parameters, PlanarVelocity { ahead_mps, left_mps, turn_radps })
    };
    let onto = |column: [f32; 4]| {
        let dot = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
        dot(column, speeds) / dot(column, column).max(1.0e-6)
    };
    PlanarVelocity {
        ahead_mps: onto(column(1.0, 0.0, 0.0)),
        left_mps: onto(column(0.0, 1.0, 0.0)),
        turn_radps: onto(column(0.0, 0.0, 1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(train: Train) -> RobotParameters {
        RobotParameters { train, wheelbase_m: 0.5, track_m: 0.4, ..RobotParameters::default() }
    }

    /// Muir and Neuman (1987): alike wheels drive ahead, sides against each other turn, diagonals against each other move sideways.
    #[test]
    fn mecanum_wheels_move_as_published() {
        let base = parameters(Train::FourMecanum);
        let ahead = body(&base, [0.5; 4]);
        assert!(
            (ahead.ahead_mps - 0.5).abs() < 1e-6
                && ahead.left_mps.abs() < 1e-6
                && ahead.turn_radps.abs() < 1e-6
        );
        let left = body(&base, [-0.3, 0.3, 0.3, -0.3]);
        assert!(
            (left.left_mps - 0.3).abs() < 1e-6 && left.ahead_mps.abs() < 1e-6 && left.turn_radps.abs() < 1e-6
        );
        let turn = body(&base, [-0.45, 0.45, -0.45, 0.45]);
        assert!((turn.turn_radps - 1.0).abs() < 1e-5 && turn.left_mps.abs() < 1e-6, "{turn:?}");
    }

    #[test]
    fn wheels_and_body_agree() {
        for train in [Train::TwoWheels, Train::FourMecanum] {
            let base = parameters(train);
            let moved = PlanarVelocity { ahead_mps: 0.6, left_mps: 0.0, turn_radps: -0.7 };
            let back = body(&base, rims(&base, moved));
            assert!(
                (back.ahead_mps - 0.6).abs() < 1e-5 && (back.turn_radps + 0.7).abs() < 1e-5,
                "{train:?} {back:?}"
            );
        }
        let [left, right, ..] = rims(
            &parameters(Train::TwoWheels),
            PlanarVelocity { turn_radps: 1.0, ..PlanarVelocity::default() },
        );
        assert!((left + 0.2).abs() < 1e-6 && (right - 0.2).abs() < 1e-6);
    }
}
