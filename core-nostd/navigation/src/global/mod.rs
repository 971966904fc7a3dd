//! Paths across the whole map, by one contract: Dijkstra as published, bucketed Dijkstra, A*, and a lattice of motions that
//! the drive can make, for long robots. Smoothing and re-planning belong to all of them.

mod bucket_queue;
mod contract;
mod gear_outlines;
mod gradient;
mod grid_planner;
mod grid_search;
mod grid_sweep;
mod lattice;
mod lattice_heap;
mod lattice_motions;
mod lattice_planner;
#[cfg(test)]
mod lattice_tests;
mod potential;
mod published;
mod replan;
mod smooth;
mod step_costs;
mod trace;

pub use contract::{GlobalPlanner, Plan, PlanFailure, PlanRequest};
pub use gear_outlines::GearOutlines;
pub use gradient::descend;
pub use grid_planner::GridPlanner;
pub use grid_search::{GridSearch, SearchEnd, SearchMethod};
pub use lattice::{Lattice, LatticeCell, LatticeNode, LatticeStorage, LatticeWorld, Worth};
pub use lattice_heap::HeapEntry;
pub use lattice_motions::{HEADINGS, Pace};
pub use lattice_planner::{LatticeGoal, LatticePlanner};
pub use potential::{UNREACHED, potential};
pub use published::{PublishedDijkstra, Wavefront, WavefrontFull};
pub use replan::{PlanState, check_plan};
pub use smooth::smooth;
pub use step_costs::StepCosts;
pub(crate) use trace::nearest_cell;
