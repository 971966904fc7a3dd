//! What it costs to drive where: layers of obstacles, people and zones, inflated by the robot's size.
//!
//! The values are those of the ROS navigation costmap (package `costmap_2d`): 0 is free, 253 the robot's inscribed disc
//! touches an obstacle, 254 an obstacle, 255 unknown.

mod compose;
#[cfg(test)]
pub(crate) mod floor_tests;
mod footprint_cost;
mod inflation;
mod obstacle_layer;
mod people_layer;
mod rays;
mod space_layer;
mod view;
mod zones;

pub use compose::{CostmapLayers, LayerMismatch, compose};
pub use footprint_cost::{FootprintHit, footprint_cost};
pub(crate) use footprint_cost::{Placement, line_cost, outline_cost};
pub use inflation::{INFLATION_CELLS_MAX, Inflation, InflationConfig, InflationError, InflationScratch};
pub use obstacle_layer::{Beam, ObstacleLayer, ObstacleLimits};
pub use people_layer::{PeopleCost, add_people};
pub use rays::RayCells;
pub use space_layer::{SpaceCell, SpaceLayer, SpaceLimits, SpaceRay};
pub use view::{CostmapView, Costs};
pub use zones::{Zone, ZoneKind, speed_limit_mps};
