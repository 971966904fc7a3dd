//! The cleaning mission of the robot that drives: the belief and the tours of the trials, with real bytes around, and
//! paths for a long robot among people.

mod body;
mod ground;
mod mission;
mod mission_report;
mod obstacles;
mod path_finder;
mod plan;
mod progress;
mod retreat;
mod senses;
mod setup;
mod store;
mod surroundings;
mod targets;
mod times;
mod track;
mod visits;

pub use mission::{Cleaner, SharedWatch};
pub(crate) use plan::MapRuns;
pub use plan::{ExpectedDirt, MissionPlan, MissionStrategy, PlanBegin};
pub use progress::{CellState, Doubt, LaneCount, MissionPhase, MissionProgress, MissionWatch, UncertainCell};
pub use setup::MissionSetup;
pub use store::Store;
pub use times::{TimeUse, Times};
