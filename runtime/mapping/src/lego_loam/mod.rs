//! LeGO-LOAM as published (Shan and Englot 2018): ground and segments of a range image, edges and flats, odometry in two steps,
//! mapping onto key frames. It stands beside our own odometry, to be compared with; values are those of the authors' program.
//!
//! Left out: the inertial unit, which that program expects aligned and without which it runs by default; and the closing of
//! loops, which it has off by default, so that its pose graph never moves a pose.

mod config;
mod correspondences;
mod features;
mod ground;
mod mapper;
mod mapping;
mod motion;
mod neighbours;
mod odometry;
mod range_image;
mod segments;
mod selection;
mod thinning;
mod whole;

pub use config::{LegoLoamConfig, StepSolver};
pub use features::{Feature, Features, smoothness};
pub use mapper::LegoMapper;
pub use whole::{LegoLoam, LegoOutcome};
