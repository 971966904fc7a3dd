//! How long the stages take: medians over many rounds, on the recordings that everybody else is measured on.

pub mod cleaning;
mod cpu;
mod floor;
mod guard;
mod lidar;
mod navigation;
mod navigation_lattice;
mod navigation_local;
mod peers;
mod slam;
pub mod tours;
mod tracking;

pub use cpu::{Took, took};
pub use floor::{FrameTime, run_floor};
pub use guard::{DECISION_MAX_NS, DecisionTime, decisions};
pub use lidar::{Measured, StageTime, run};
pub use navigation::{NavigationTime, navigation};
pub use navigation_lattice::{Office, OfficePath};
pub use peers::{OurTime, ours};

/// By the wall clock.
fn nanoseconds(work: impl FnMut()) -> f64 {
    took(work).wall_ns
}

/// NaN without any.
fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}
