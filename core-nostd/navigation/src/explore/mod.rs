//! Exploration: where known floor borders on what was never seen (Yamauchi 1997).

mod explorer;
mod frontier;
mod goal_watch;
mod tour_explorer;
mod view_points;
mod visit_order;

pub use explorer::{Exploration, ExploreConfig, Explorer, FrontierCost};
pub use frontier::{FRONTIERS_MAX, Frontier, FrontierScratch, FrontierSearch, find_frontiers};
pub use tour_explorer::{TourExploration, TourExploreConfig, TourExplorer};
pub use view_points::{VIEW_POINTS_MAX, ViewConfig, ViewPoint, ViewPoints, ViewSearch};
pub use visit_order::{PLACES_MAX, VisitOrder, Ways, visit_order};
