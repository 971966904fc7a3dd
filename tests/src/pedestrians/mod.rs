//! Drives right through recorded pedestrians (ETH and UCY): `cargo xtask reproduce pedestrians`.
//!
//! A robot with the navigator's parameters and the guard's rules for people crosses the busiest place of each recording from one
//! side to the other. People walk as they were recorded, or want to and push each other off and the robot by social forces, so that
//! their own detours can be measured. Ours drives, ours that takes people for standing, the dynamic window, and a robot that stands
//! until the path is free. Judged by true positions. The floor has no obstacles: the recordings name none.

mod crowd;
mod drive;
mod policy;
mod recording;
mod scenes;
mod social_force;
mod start;
mod table;

pub use crowd::Behaviour;
pub use drive::{Driven, Robot, Trial, drive, undisturbed};
pub use policy::Policy;
pub use recording::{Recording, Walk};
pub use scenes::{SCENES, example_robot};
pub use start::{Start, draw};
pub use table::pedestrians;
