//! What is known of a contact.

use serde::Serialize;

use crate::{BodyPlace, Force, LimbName, RobotPose};

/// With whom or what.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Other {
    /// Something that stands.
    Thing {
        /// Index in the list of objects.
        index: usize,
        /// Its name.
        name: String,
    },
    /// Somebody.
    Person {
        /// Number in the world.
        id: u32,
        /// Who.
        kind: &'static str,
        /// Part of the person.
        limb: LimbName,
    },
}

/// Kinds of contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactKind {
    /// The robot's own motion took its body towards the other.
    DroveInto,
    /// The robot moved, but not towards the other: somebody walked into its side or its rear.
    WalkedIntoMoving,
    /// The robot stood.
    WalkedIntoStanding,
    /// A wheel came over a hole in the floor.
    OverEdge,
}

/// The body of the robot has met something.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contact {
    /// Begin, seconds.
    pub at_s: f64,
    /// End, seconds; the run's end if it lasts.
    pub until_s: f64,
    /// With whom or what.
    pub other: Other,
    /// How it came about.
    pub kind: ContactKind,
    /// Where on the robot.
    pub place: BodyPlace,
    /// Where the robot was.
    pub pose: RobotPose,
    /// Speed of the robot's body at the point of contact, m/s.
    pub robot_mps: f32,
    /// The part of it that points to the other, m/s.
    pub robot_closing_mps: f32,
    /// Relative speed of both at the point, m/s.
    pub relative_mps: f32,
    /// The part of it in which both came together, m/s.
    pub closing_mps: f32,
    /// How hard.
    pub force: Force,
    /// Deepest penetration, metres: bodies in the simulator do not give way.
    pub depth_m: f32,
    /// A bumper was touched, and the robot went on for longer than it needs to stop.
    pub went_on: bool,
    /// A perfect machine with the same brakes would have stood by then.
    pub avoidable: bool,
    /// The sensor of this machine that saw the other early enough to stand by then.
    pub seen_by: Option<String>,
    /// How long before the contact that sensor saw it last, in time to brake, seconds.
    pub seen_before_s: Option<f32>,
}

impl Contact {
    /// The robot moved.
    #[must_use]
    pub fn while_moving(&self) -> bool {
        self.kind != ContactKind::WalkedIntoStanding
    }

    /// The other is a person.
    #[must_use]
    pub const fn is_person(&self) -> bool {
        matches!(self.other, Other::Person { .. })
    }

    /// One line for people.
    #[must_use]
    pub fn line(&self) -> String {
        let other = match &self.other {
            Other::Thing { name, .. } => name.clone(),
            Other::Person { id, kind, limb } => format!("{kind} {id} ({limb:?})").to_lowercase(),
        };
        let how = match self.kind {
            ContactKind::DroveInto => "drove into",
            ContactKind::WalkedIntoMoving => "was walked into while it moved by",
            ContactKind::WalkedIntoStanding => "stood and was walked into by",
            ContactKind::OverEdge => "drove over",
        };
        let by = match (&self.seen_by, self.avoidable, self.while_moving()) {
            (_, _, false) => String::new(),
            (Some(sensor), ..) => format!("; the {sensor} had seen it in time"),
            (None, true, _) => "; no sensor had seen it in time".to_owned(),
            (None, false, _) => "; nobody could have avoided it".to_owned(),
        };
        let by = if self.went_on { by + "; it went on although a bumper was touched" } else { by };
        let BodyPlace { part, side, point_m } = &self.place;
        format!(
            "{:.2} s: the robot {how} {other}, {side} of the {part} at {:.2} m height, {:.2} m/s, {:.0} mm deep{by}",
            self.at_s,
            point_m[2],
            self.relative_mps,
            self.depth_m * 1_000.0
        )
    }
}
