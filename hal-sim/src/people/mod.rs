//! People: bodies that lasers meet and a social-force model that moves them.

mod body;
mod build;
mod bump;
mod detour;
mod discs;
mod kind;
mod person;
mod social_force;
mod walk;

pub use body::{BodyPart, Limb, body_parts, limbs};
pub use build::{Bodies, Build, Clothes, PLAIN};
pub use bump::RobotShape;
pub use discs::{Disc, body_discs, ground_discs};
pub use kind::PersonKind;
pub use person::Person;
pub use social_force::Crowd;
pub use walk::RecordedWalk;
