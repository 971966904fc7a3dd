//! Why a datagram is of no use.

use floorguard_types::number::nearest_f64;

use super::frame::FrameError;
use crate::link::OrderError;

/// A datagram that is of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// It is none of beams.
    Frame(FrameError),
    /// Its scan is another than the robot's file describes.
    Shape {
        /// In what.
        part: ShapePart,
        /// What it has: beams, or millionths of a degree.
        found: i64,
        /// What the robot's file has.
        expected: i64,
    },
    /// It is another sender's, or of no newer scan than the one before, or was heard before.
    Order(OrderError),
    /// It describes its scan in another way than the datagrams of it that came before.
    Disagrees {
        /// Its sequence.
        sequence: u32,
    },
}

/// In what two scans differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ShapePart {
    /// The number of beams.
    Beams,
    /// The angle of the first beam.
    FirstAngle,
    /// The angle from beam to beam.
    Step,
    /// The angle of the last beam.
    LastAngle,
}

impl DecodeError {
    /// The same up to its figures, which are others for each datagram.
    #[must_use]
    pub fn is_alike(&self, other: Self) -> bool {
        use core::mem::discriminant;
        match (self, other) {
            (Self::Frame(one), Self::Frame(other)) => discriminant(one) == discriminant(&other),
            (Self::Order(one), Self::Order(other)) => discriminant(one) == discriminant(&other),
            (Self::Shape { part: one, .. }, Self::Shape { part: other, .. }) => *one == other,
            (one, other) => discriminant(one) == discriminant(&other),
        }
    }
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Frame(error) => write!(f, "{error}"),
            Self::Shape { part: ShapePart::Beams, found, expected } => write!(
                f,
                "scan datagram of {found} beams; this robot's file has {expected}: correct `beams` of [scanner]"
            ),
            Self::Shape { part, found, expected } => {
                let (name, key) = match part {
                    ShapePart::FirstAngle => ("a first angle", "first_deg"),
                    ShapePart::Step => ("a step", "step_deg"),
                    ShapePart::Beams | ShapePart::LastAngle => ("a last angle", "step_deg"),
                };
                let degrees = |micros: i64| nearest_f64(micros) * 1.0e-6;
                write!(
                    f,
                    "scan datagram with {name} of {:.4}°; this robot's file has {:.4}°: correct `{key}` of [scanner]",
                    degrees(*found),
                    degrees(*expected)
                )
            }
            Self::Order(error) => write!(f, "scan datagram of {error}"),
            Self::Disagrees { sequence } => {
                write!(f, "scan datagram of scan {sequence} disagrees with another of that scan")
            }
        }
    }
}

impl core::error::Error for DecodeError {}
