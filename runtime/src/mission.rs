//! Where the robot would like to go. What comes out is a *wanted* command; the guard decides what is permitted.

pub use floorguard_navigation::route::{ROUTE_WAYPOINTS_MAX, Route, RouteFollower, RouteLimits};
