//! What really was, in recordings of simulated runs: the robot, everybody and everything, for judges of other makers.

use std::io::{Seek, Write};

use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::time::Stamp;

use super::cdr::Encoder;
use super::messages;
use super::recorder::{RecordError, Recorder};
use super::run::RunRecorder;
use super::schemas;
use super::topics;

/// Where the robot truly was, frame `world`, and how it moved.
pub const TRUE_ODOMETRY: &str = "/ground_truth/odometry";
/// Everybody's limbs, frame `world`: a namespace each, with the person's number and kind.
pub const TRUE_PEOPLE: &str = "/ground_truth/people";
/// Everything that stands, frame `world`, at the beginning of the recording: a namespace each, with its name.
pub const TRUE_THINGS: &str = "/ground_truth/things";

/// Whether a topic holds what only a simulator knows: no program that judges by it may use it.
#[must_use]
pub fn is_truth(topic: &str) -> bool {
    topic.starts_with("/ground_truth/")
}

/// Shape of a solid; sizes are whole lengths, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolidShape {
    /// Along its own x, y, z.
    Box([f64; 3]),
    /// Diameter.
    Ball(f64),
    /// Diameter, and height along its own z.
    Cylinder(f64, f64),
}

/// A solid in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueSolid {
    /// Whom or what it belongs to.
    pub name: String,
    /// Number within that.
    pub id: i32,
    /// Shape.
    pub shape: SolidShape,
    /// Middle, metres.
    pub centre_m: [f64; 3],
    /// Rotation: x, y, z, w.
    pub turn: [f64; 4],
    /// What else is known: the part of the body, the surface, a hole in the floor.
    pub text: String,
}

/// `visualization_msgs/msg/MarkerArray` of solids; everything drawn before is cleared first.
fn solids(stamp: Stamp, all: &[TrueSolid]) -> Vec<u8> {
    let mut encoder = Encoder::new();
    encoder.length(all.len() + 1);
    let nothing = TrueSolid {
        name: String::new(),
        id: 0,
        shape: SolidShape::Ball(0.0),
        centre_m: [0.0; 3],
        turn: [0.0, 0.0, 0.0, 1.0],
        text: String::new(),
    };
    marker(&mut encoder, stamp, (&nothing, 3));
    all.iter().for_each(|solid| marker(&mut encoder, stamp, (solid, 0)));
    encoder.finish()
}

fn marker(encoder: &mut Encoder, stamp: Stamp, (solid, action): (&TrueSolid, i32)) {
    let (kind, size_m) = match solid.shape {
        SolidShape::Box(size_m) => (1, size_m),
        SolidShape::Ball(diameter_m) => (2, [diameter_m; 3]),
        SolidShape::Cylinder(diameter_m, height_m) => (3, [diameter_m, diameter_m, height_m]),
    };
    messages::header(encoder, stamp, "world");
    encoder.text(&solid.name).i32(solid.id).i32(kind).i32(action);
    encoder.f64s(&solid.centre_m).f64s(&solid.turn).f64s(&size_m);
    [0.2, 0.4, 0.8, 0.5].iter().for_each(|channel| _ = encoder.f32(*channel));
    // lifetime, not locked, no points, no colours, no texture
    encoder.i32(0).u32(0).u8(0).length(0).length(0).text("");
    messages::header(encoder, Stamp::ZERO, "");
    encoder.text("").octets(&[]).length(0);
    encoder.text(&solid.text).text("").text("").octets(&[]).u8(0);
}

impl<W: Write + Seek> Recorder<W> {
    fn true_solids(
        &mut self,
        topic: &'static str,
        (at, all): (Stamp, &[TrueSolid]),
    ) -> Result<(), RecordError> {
        self.message(topic, &schemas::MARKER_ARRAY, at, &solids(at, all))
    }
}

impl<W: Write + Seek> RunRecorder<W> {
    /// What stands, and where the odometry frame lies in the world.
    pub fn true_world(&mut self, (at, odometry_in_world): (Stamp, Pose2), things: &[TrueSolid]) {
        let frame = messages::flat_frame(at, ("world", "odom"), odometry_in_world);
        self.write(|out| out.message(topics::TF_STATIC, &schemas::TF_MESSAGE, at, &frame));
        self.true_things(at, things);
    }

    /// What stands from now on beside what stood before.
    pub fn true_things(&mut self, at: Stamp, things: &[TrueSolid]) {
        self.write(|out| out.true_solids(TRUE_THINGS, (at, things)));
    }

    /// The robot and everybody.
    pub fn true_moment(&mut self, at: Stamp, (pose, twist): (Pose2, Twist2), people: &[TrueSolid]) {
        let frames = ("world", "base_link_true");
        let odometry = messages::odometry_in(frames, at, (pose, twist), &[[0.0; 3]; 3]);
        self.write(|out| out.message(TRUE_ODOMETRY, &schemas::ODOMETRY, at, &odometry));
        self.write(|out| out.true_solids(TRUE_PEOPLE, (at, people)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode;

    #[test]
    fn solids_are_read_as_markers() {
        let limb = TrueSolid {
            name: "person 4 (adult)".to_owned(),
            id: 2,
            shape: SolidShape::Cylinder(0.13, 0.8),
            centre_m: [1.5, -2.0, 0.4],
            turn: [0.0, 0.0, 0.0, 1.0],
            text: "lower-leg".to_owned(),
        };
        let message = solids(Stamp::from_micros(1_500_000), std::slice::from_ref(&limb));
        let drawn = decode::markers(&message).expect("a list of markers");
        assert_eq!((drawn.len(), drawn[0].action), (2, 3));
        assert_eq!((drawn[1].group.as_str(), drawn[1].id), ("person 4 (adult)", 2));
        assert_eq!(drawn[1].text, "lower-leg");
        assert_eq!((drawn[1].pose.x_m, drawn[1].pose.y_m), (1.5, -2.0));
    }
}
