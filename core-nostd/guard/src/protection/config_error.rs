//! Why a configuration is refused.

use core::fmt;

use super::source::Source;
use floorguard_types::geometry::Point2;

/// Nothing starts half-configured (FG-REQ-060). The number is the index of the field set where there is one.
#[derive(Clone, Debug, PartialEq)]
pub enum GuardConfigError {
    /// The footprint has fewer than three corners or is not around the origin of the robot frame.
    Footprint,
    /// A limit or threshold is not a positive number; its name.
    NotPositive(&'static str),
    /// There is no field set for straight forward travel.
    NoForwardField,
    /// A field has fewer than three corners.
    FieldCorners(usize),
    /// A protective field does not contain the footprint.
    FieldInsideFootprint(usize),
    /// A protective field is shorter than the stopping distance at its greatest speed: needed and given, metres.
    FieldTooShort {
        /// Which set.
        set: usize,
        /// Needed beyond the body, metres.
        needed_m: f32,
        /// Given beyond the body, metres.
        given_m: f32,
    },
    /// A protective field leaves out a part of what the body sweeps before it stands. The box around the least field:
    FieldTooNarrow {
        /// Which set.
        set: usize,
        /// Least x and y, metres.
        least: Point2,
        /// Greatest x and y, metres.
        greatest: Point2,
    },
    /// The scanner has no beams, more than the capacity, or no positive step.
    Scanner,
    /// The second scanner is as wrong, is not waited for, or the program lacks the memory for its table.
    RearScanner,
    /// The lidar has no rings, or the body ends below the floor clearance.
    Lidar,
    /// A source limits later than it stops, or has no positive deadline.
    Deadline(Source),
}

impl fmt::Display for GuardConfigError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Footprint => {
                out.write_str("the footprint needs three corners around the origin of the robot frame")
            }
            Self::NotPositive(name) => write!(out, "{name} must be a positive number"),
            Self::NoForwardField => out.write_str("there is no field set for forward travel"),
            Self::FieldCorners(set) => {
                write!(out, "field set {set} has a field with fewer than three corners")
            }
            Self::FieldInsideFootprint(set) => {
                write!(out, "the protective field of set {set} does not contain the footprint")
            }
            Self::FieldTooShort { set, needed_m, given_m } => write!(
                out,
                "the protective field of set {set} reaches {given_m:.2} m beyond the body, stopping needs {needed_m:.2} m"
            ),
            Self::FieldTooNarrow { set, least, greatest } => write!(
                out,
                "the protective field of set {set} leaves out what the body sweeps, from [{:.2}, {:.2}] to [{:.2}, {:.2}]",
                least.x_m, least.y_m, greatest.x_m, greatest.y_m
            ),
            Self::Scanner => {
                out.write_str("the scanner needs beams, at most the capacity, and a positive step")
            }
            Self::RearScanner => out.write_str(
                "the rear scanner needs beams, a deadline, and a program with the memory for it: none on a microcontroller",
            ),
            Self::Lidar => {
                out.write_str("the lidar needs rings, and a body height above its floor clearance")
            }
            Self::Deadline(source) => write!(out, "the deadlines of the {} are not in order", source.name()),
        }
    }
}

impl core::error::Error for GuardConfigError {}
