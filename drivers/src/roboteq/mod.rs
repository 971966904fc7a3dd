//! Roboteq motor controllers by their serial line (book, Motor controllers: Roboteq).
//!
//! From Roboteq, "Advanced Digital Motor Controller User Manual" V1.8 (August 28, 2017), sections "Serial Communication Protocol",
//! "Runtime Commands" (S, EX, MG), "Runtime Queries" (S, C, FF) and "Set/Read Configuration Commands" (RWD).

mod line;

pub use line::{COMMAND_BYTES_MAX, EMERGENCY_STOPPED, RoboteqOrder, RoboteqReply};
