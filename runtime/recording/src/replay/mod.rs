//! A recorded run once more, through the robot's own tasks on the virtual clock.

mod replayed_world;
mod scanner_pipe;

pub use replayed_world::{
    IMU_BAUD, LEARNED, MISSION, REPEATABLE, ReplayAudience, ReplayError, ReplayOutcome, is_replayable,
    replay_recording,
};
pub use scanner_pipe::ScannerPipe;
