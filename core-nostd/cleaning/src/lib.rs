//! Cleaning that can be guaranteed: what is believed about dirt, what still has to be cleaned, and in which order.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo,
        clippy::unimplemented,
        clippy::indexing_slicing,
        clippy::as_conversions
    )
)]

#[cfg(test)]
extern crate std;

mod active_cells;
mod belief;
mod brush_places;
mod dirt_model;
mod lane_queue;
mod planner;
mod policy;
mod swath;
mod swath_mask;
mod tour;
mod visit;
mod visit_plan;

pub use active_cells::{ActiveCell, ActiveCells, Collapse};
pub use belief::{Belief, BeliefConfig, Evidence, ParticlePose, PoseDeviation, UpdateReport};
pub use dirt_model::{ActuatorModel, CellDirt, DirtSensorModel, sweep_cell};
pub use lane_queue::{Lane, LaneAttempt, LaneQueue, LaneRules};
pub use planner::{PlanCells, PlanReport, Planner};
pub use policy::{CleanRule, MissionRisk, RiskLimits, Verdict};
pub use swath::{Brush, Swath};
pub use swath_mask::{SwathMask, SweptCell};
pub use tour::{Distances, EuclideanCells, TourError, TourSolver};
pub use visit::{Pass, PassPlaces, PassShape, choose_pass};
pub use visit_plan::VisitPlan;
