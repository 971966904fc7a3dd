//! Where a scan was taken: against a field of nearby returns, by exact search over a window and by descent from a guess.
//!
//! Sources: Olson 2009, "Real-time correlative scan matching"; Hess et al. 2016, "Real-time loop closure
//! in 2D LIDAR SLAM", section V.B (branch and bound); Kohlbrecher et al. 2011 (descent on an interpolated grid);
//! Blais and Levine 1995, Censi 2008 (a scan onto a scan, by lines).

mod candidate;
mod covariance;
mod descent;
mod points;
mod projection;
mod search;
mod window;

pub use candidate::{Candidate, CellOffset};
pub use covariance::{ScoreSurface, score_covariance};
pub use descent::{DescentConfig, Guess, Refined, refine};
pub use points::{BeamTiming, RangeLimits, scan_points};
pub use projection::{Panorama, Projected};
pub use search::{Found, SearchScratch, search};
pub use window::{Exclusion, MotionPenalty, SearchWindow};
