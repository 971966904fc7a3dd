//! Encoders of the CiA 406 profile (book, CANopen: CiA 406 encoders).

mod position;
mod report;

pub use position::PositionCounter;
pub use report::EncoderReport;
