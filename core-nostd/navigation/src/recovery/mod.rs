//! What a robot does that does not come forward: wait, clear the costmap, back out along the way it came, try the other way
//! round, call for help. Each measure has its reason in one sentence.

mod ladder;
mod reason;
mod trail;

pub use ladder::{Measure, Recovery, RecoveryMoment, RecoveryStep, RecoveryTimes};
pub use reason::Obstruction;
pub use trail::{TRAIL_POSES, Trail};
