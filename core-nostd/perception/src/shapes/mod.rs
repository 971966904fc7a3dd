//! Shapes: from the returns of a candidate to the probability that it is a person.
//!
//! The table of the robot (`person_model`) and the classifier of the published experiments (`classify`). Source: book, People.

pub mod classify;
pub mod person_model;
mod person_table;
pub mod shape;
pub(crate) mod waist;
