//! Two-channel safety inputs (wire-formats 7.1).

mod dual_channel;

pub use dual_channel::DualChannel;
