//! Encoders of the CiA 406 profile (wire-formats 4.2, 6.5).

mod position;
mod report;

pub use position::PositionCounter;
pub use report::EncoderReport;
