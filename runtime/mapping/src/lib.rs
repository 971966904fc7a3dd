//! Maps a building on a Linux computer, from scans and odometry: poses, sub-maps, pose graph, files for other tools.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod calibrate;
pub mod clean;
pub mod colouring;
pub mod front_end;
pub mod grid_map;
pub mod input;
pub mod lego_loam;
pub mod lidar3d;
pub mod localise;
pub mod loops;
pub mod mapper;
pub mod metrics;
pub mod output;
mod pages;
pub mod pose_graph;
pub mod refine;
mod saved;
mod se2;
pub mod time_offset;
mod turn;

pub use pages::Pages;
pub use se2::Se2;
pub use turn::{turn_about, turn_angle_rad, turn_vector};
