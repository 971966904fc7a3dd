//! Cleaning: tours, missions, the robot's own tasks, and whether claims hold.

mod cleaning_claims;
mod cleaning_missions;
mod cleaning_reproduce;
mod cleaning_robot;
mod cleaning_tours;
