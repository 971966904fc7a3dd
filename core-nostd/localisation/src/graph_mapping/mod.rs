//! A map of a hall within fixed memory: graph SLAM on a microcontroller.
//!
//! Scans are matched against those of the last metres (Kohlbrecher et al. 2011), some of their returns are kept with their poses, places that
//! are met again are found by exact search over a window (Olson 2009; Hess et al. 2016), and all poses are solved together by
//! Gauss-Newton with conjugate gradients, loops weighted by dynamic covariance scaling (Agarwal et al. 2013). The book describes it
//! (Mapping on a microcontroller).

mod compare;
mod config;
mod edges;
mod gradient;
mod kept;
mod lines;
mod loops;
mod mapper;
mod outcome;
mod solve;
mod surroundings;
#[cfg(test)]
mod tests;
mod tracking;

pub use config::GraphMappingConfig;
pub use edges::GraphEdge;
pub use kept::{KeptScan, ShortPoint};
pub use mapper::{FIELD_CELLS, GraphMapper, OfMicrocontroller};
pub use outcome::{LoopCounters, MappingStep};
