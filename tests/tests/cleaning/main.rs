//! Cleaning and navigation: missions, the robot's own tasks, whether claims hold, planners in published worlds.

mod cleaning_claims;
mod cleaning_missions;
mod cleaning_reproduce;
mod cleaning_robot;
mod dead_ends;
mod navigation_barn;
mod navigation_docking;
mod navigation_drive;
mod navigation_exploration;
mod navigation_paths;
mod navigation_pedestrians;
mod navigation_prediction;
mod navigation_tour;
