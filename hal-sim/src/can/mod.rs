//! The devices on the CAN bus: two drives, two encoders and the safety controller's gateway (book, CANopen).

mod dictionary;
mod drive;
mod encoder;
mod frame;
mod gateway;
mod node;
mod slcan;

pub use drive::{Drive, DriveKind, DriveState, MeasuredMotion};
pub use encoder::Encoder;
pub use frame::CanFrame;
pub use gateway::{Gateway, SafetyChannels};
pub use node::Node;
pub use slcan::{SlcanDecoder, encode_slcan};
