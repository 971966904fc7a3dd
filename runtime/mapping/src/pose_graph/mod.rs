//! Poses and what is known about pairs of them; the most likely poses.
//!
//! Sources: Grisetti et al. 2010, "A tutorial on graph-based SLAM"; Agarwal et al. 2013 (dynamic
//! covariance scaling); Yang et al. 2020 (graduated non-convexity); Carlone and Censi 2014 (linear
//! start from the orientations).

mod block_system;
mod cholesky;
mod edge;
mod from_edges;
mod g2o;
mod graph;
mod iterative;
mod optimise;
mod robust;
mod space;
mod start;
mod supported;
mod uncertain;

pub use block_system::{BlockSystem, PairTerms, Unsolvable};
pub use edge::{Edge, EdgeKind};
pub use from_edges::optimise_from_edges;
pub use g2o::{G2oError, read_g2o, write_g2o};
pub use graph::Graph;
pub use iterative::{IterativeConfig, IterativeSystem};
pub use optimise::{OptimiseConfig, Optimised, optimise};
pub use robust::{RobustConfig, RobustDescent, RobustOutcome, optimise_robustly};
pub use space::{SpaceEdge, SpaceGraph};
pub use start::{chain_start, orientation_start};
pub use supported::support;
pub use uncertain::UncertainPose;
