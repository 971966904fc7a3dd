//! Anything into every decoder, the configuration, recordings and the whole runtime.
//!
//! [`decoders`], [`scanning`], [`motors`], [`files`] and [`worlds`] feed what they are given and say how much of it was of use; they panic where the
//! answer is wrong. Two kinds of callers give: the tests `fuzz_…`, in-process and on the stable compiler, corrupt real
//! messages (`cargo xtask campaign fuzz-…` runs 1e8 of them); libFuzzer, in the folder `fuzz`, follows the branches
//! that it has seen.

mod corpus;
mod corrupt;
pub mod decoders;
pub mod files;
pub mod links;
pub mod messages;
pub mod motors;
pub mod scanning;
pub mod worlds;

pub use corpus::{
    Corpus, bridged_datagrams, bridged_samples, bridged_scans, cola_scans, livox_datagrams, ouster_turn,
    rplidar_turns,
};
pub use corrupt::{corrupt, pick};
