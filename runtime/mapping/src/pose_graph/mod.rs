//! Poses and what is known about pairs of them; the most likely poses.
//!
//! Sources: Grisetti, Kümmerle, Stachniss, Burgard 2010, "A tutorial on graph-based SLAM"; Agarwal et al. 2013 (dynamic
//! covariance scaling); Yang, Antonante, Tzoumas, Carlone 2020 (graduated non-convexity); Carlone, Censi 2014 (linear
//! start from the orientations).

mod along_path;
mod block_system;
mod edge;
mod g2o;
mod graph;
mod optimise;
mod robust;
mod start;

pub use along_path::optimise_along_path;
pub use block_system::{BlockSystem, PairTerms, Unsolvable};
pub use edge::{Edge, EdgeKind};
pub use g2o::{G2oError, read_g2o, write_g2o};
pub use graph::Graph;
pub use optimise::{OptimiseConfig, Optimised, optimise};
pub use robust::{RobustConfig, RobustOutcome, optimise_robustly};
pub use start::{chain_start, orientation_start};
