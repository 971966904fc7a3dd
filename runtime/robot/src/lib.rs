//! The robot on a Linux computer: its tasks on two rings, camera, lidar on a motor, cleaning, what it knows of its place, what it learns.
//!
//! Nothing here knows the simulator or the laboratory.
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

#[macro_use]
extern crate floorguard_host;

pub mod actuated;
pub mod assembly;
pub mod camera;
pub mod cleaner;
pub mod environment;
pub mod learning;
pub mod navigator;
pub mod ordered;
pub mod picture_files;
pub mod site;
