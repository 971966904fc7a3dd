//! The robot's tasks on a tape: input from memory, virtual time, the same fingerprint as on the host.

pub mod carriers;
pub mod clock;
pub mod play;
pub mod stages;
pub mod stopwatch;
pub mod task_set;
