//! Dirt: what is new on a floor that nobody has seen before, without training on dirt or on floors.
//!
//! Two detectors on the same image. The published one compares the texture of blocks with a mixture fitted to all
//! blocks; ours asks of every pixel how rare its colour is. Source: algorithms F.

mod blocks;
mod lab;
mod mixture;
mod order;
mod published;
mod rarity;

pub use blocks::{Block, BlockGrid, DirtFault};
pub use lab::{Lab, LabTables};
pub use mixture::{COMPONENTS_MAX, Component, FitRules, Mixture, PASSES_MAX, Point, Scorer};
pub use published::{PublishedDetector, PublishedParameters};
pub use rarity::{RARITY_BIN, RarityDetector, RarityMemory};
