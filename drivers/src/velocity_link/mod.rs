//! Velocities in, permitted velocities out: the guard under another program's navigation. Source: book, Velocity link.
//!
//! A navigation stack sends [`VelocityRequest`]s; [`Acceptance`] refuses those that are late, repeated, out of order or of
//! another sender, and forgets each at its deadline. [`Permit`]s go back. A base that takes velocities gets the same requests
//! from the guard and answers with [`MotionReport`]s. On a serial line [`LineReceiver`] finds the frames.
//!
//! The checksum finds damage, not malice: there is no key. Who can send to the port can drive the robot, within what the guard
//! permits.

mod acceptance;
mod frame;
mod line;
mod motion;
mod permit;
mod reason;
mod request;

pub use acceptance::{Acceptance, AcceptanceRules, Accepted, Arrival, LinkCounters, Refusal};
pub use frame::{FRAME_BYTES_MAX, FrameError};
pub use line::LineReceiver;
pub use motion::{MOTION_BYTES, MotionReport};
pub use permit::{NO_CAUSE, PERMIT_BYTES, Permit, PermitFlags};
pub use reason::{REASON_BYTES, Reason};
pub use request::{DEADLINE_MS, REQUEST_BYTES, StopDemand, VelocityRequest};

#[cfg(test)]
mod acceptance_tests;
#[cfg(test)]
mod vector_tests;
