//! Dirt: what is novel on an unknown floor, without training on dirt or on floors.
//!
//! Two detectors on the same image. The published one compares the texture of blocks with a mixture fitted to all
//! blocks; ours asks of every pixel how rare its colour and texture are, and whether they stay where they are while the
//! robot moves. Source: book, Floor and dirt.

mod blocks;
mod lab;
mod lines;
mod mixture;
mod novelty;
mod order;
mod pixels;
mod published;
mod rarity;
mod recall;
mod surroundings;

pub use blocks::{Block, BlockGrid, DirtFault};
pub use lab::{Lab, LabTables};
pub use mixture::{COMPONENTS_MAX, Component, FitRules, Mixture, PASSES_MAX, Point, Scorer};
pub use novelty::{NOVELTY_BIN, NoveltyDetector, NoveltyMemory};
pub use pixels::Pixel;
pub use published::{PublishedDetector, PublishedParameters};
pub use recall::{FloorView, Remembered};
