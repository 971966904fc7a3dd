//! Two-channel safety inputs (book, Safety inputs: Two channels).

mod dual_channel;

pub use dual_channel::DualChannel;
