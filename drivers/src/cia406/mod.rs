//! Encoders of the CiA 406 profile (wire-formats 4.2, 6.5).

mod position;

pub use position::PositionCounter;
