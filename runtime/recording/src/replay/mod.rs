//! A recorded run once more, through the robot's own tasks on the virtual clock.

mod audience;
mod delivery;
mod ordered_world;
mod replayed_world;
mod scanner_pipe;
mod scripted_line;

pub use audience::{Difference, OrderOutcome, ReplayAudience, ReplayError, ReplayOutcome};
pub use replayed_world::{
    IMU_BAUD, LEARNED, MISSION, NAVIGATION, REPEATABLE, is_replayable, replay_recording,
};
pub use scanner_pipe::ScannerPipe;
