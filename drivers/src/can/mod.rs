//! CAN frames, and the serial text protocol that carries them where there is no CAN controller.

mod frame;
mod slcan;

pub use frame::CanFrame;
pub use slcan::{SLCAN_LINE_BYTES, SlcanCounters, SlcanEvent, SlcanReceiver, encode_slcan};
