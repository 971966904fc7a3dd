//! Cleaning that can be guaranteed: what is believed about dirt, what still has to be cleaned, and in which order.

mod active_cells;
mod belief;
mod brush_places;
mod dirt_model;
mod dirt_rate;
mod follow;
mod motion_model;
mod path_search;
mod planner;
mod poisson;
mod policy;
mod range_model;
mod resample;
mod swath;
mod swath_mask;
mod tour;
mod visit;

pub use active_cells::{ActiveCell, ActiveCells, Collapse};
pub use belief::{Belief, BeliefConfig, Evidence, PoseEstimate, UpdateReport};
pub use dirt_model::{ActuatorModel, CellDirt, DirtSensorModel, sweep_cell};
pub use dirt_rate::{DirtRate, RunObservation, attribute_hits, observed_share};
pub use follow::{FollowConfig, Following, follow};
pub use motion_model::{MotionNoise, OdometryStep, sample_motion};
pub use path_search::{PathSearch, SEARCH_CELLS_MAX, STRAIGHT, SearchCell};
pub use planner::{PlanReport, Planner};
pub use poisson::{negative_binomial_quantile, poisson_cdf, poisson_quantile, poisson_tail, threshold_rate};
pub use policy::{CleanRule, MissionRisk, Verdict};
pub use range_model::{BEAMS_TO_JUDGE, RangeModel, RangeModelConfig};
pub use resample::{normalise, systematic};
pub use swath::{Brush, Swath};
pub use swath_mask::SwathMask;
pub use tour::{Distances, EuclideanCells, TourError, TourSolver};
pub use visit::{Pass, PassShape, choose_pass};
