//! Judges contacts of a simulated robot by true geometry: the whole body in 3-D against people and objects of any
//! height, in any motion.
//!
//! The judge depends on none of the robot's own crates and reads none of its data. It gets plain numbers: the true
//! shape and pose of the robot, the true bodies of people, the true objects. It does not know protective fields,
//! tracks, decisions or their reasons, so that a wrong idea of the robot cannot excuse itself.
//!
//! What a contact could have been avoided by is decided twice: by a perfect machine with the same brakes, and by this
//! machine's sensors, whose view is computed here by casting rays at the true scene.
#![forbid(unsafe_code)]

mod avoidance;
mod body;
mod braking;
mod contact;
mod corridor;
mod detection;
mod force;
mod job;
mod judge;
mod motion;
mod need;
mod report;
mod scene;
mod sensor;
mod sight;
mod solid;
mod track;

pub use body::{BodyError, BodyPart, BodyPlace, Nearest, RobotBody};
pub use braking::Brakes;
pub use contact::{Contact, ContactKind, Other};
pub use force::{Force, ForceClass};
pub use job::{Job, JobOutcome};
pub use judge::{ContactJudge, Setup};
pub use motion::{RobotMotion, RobotPose};
pub use report::{ContactCounts, Report};
pub use scene::{Limb, LimbName, Moment, Person, Surface, Thing, ThingKind};
pub use sensor::{Sensor, SensorView};
pub use solid::Solid;
