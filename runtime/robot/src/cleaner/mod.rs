//! The cleaning mission of the robot that drives: the belief and the tours of the trials, with real bytes around, and
//! paths for a long robot among people.

mod areas;
mod body;
mod cleaning_orders;
mod ground;
mod known_floor;
mod lane_list;
mod lane_plan;
mod mission;
mod mission_report;
mod obstacles;
mod ordered;
mod orders;
mod pace;
mod passes;
mod path_finder;
mod plan;
mod progress;
mod queue;
mod refused;
mod retreat;
mod senses;
mod setup;
mod store;
mod surroundings;
mod targets;
mod times;
mod track;
mod visits;

pub use areas::{AREAS_MAX, Area, AreaKind, check_areas};
pub use cleaning_orders::{CleaningCommand, CleaningOrder, CleaningOrders, CleaningStage, CleaningStatus};
pub use known_floor::KnownFloor;
pub use mission::{Cleaner, SharedWatch};
pub use ordered::{CleaningCounts, Whereabouts};
pub use orders::{MissionOrder, MissionOrders, QUEUE_MAX, QueueStatus};
pub(crate) use plan::MapRuns;
pub use plan::{ExpectedDirt, MissionPlan, MissionStrategy, PlanBegin};
pub use progress::{CellState, Doubt, LaneCount, MissionPhase, MissionProgress, MissionWatch, UncertainCell};
pub use queue::MissionQueue;
pub use setup::MissionSetup;
pub use store::Store;
pub use times::{TimeUse, Times};
