//! Rounds of matching and solving.

use nalgebra::{Matrix3, Vector3};

use super::pairs::{PairConfig, overlapping_pairs};
use super::scan_view::ScanView;
use super::terms::{MatchLimits, match_pair};
use crate::pose_graph::{BlockSystem, Edge, PairTerms, Unsolvable};
use crate::se2::Se2;

/// How the alignment works.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignConfig {
    /// Which scans are compared.
    pub pairs: PairConfig,
    /// Distance within which points are the same place, round by round, metres.
    pub distances_m: Vec<f32>,
    /// Distance across a wall at which points count half, metres.
    pub outlier_m: f64,
    /// Deviation of a point from the wall, metres, with what neighbouring points share.
    pub point_deviation_m: f64,
    /// Share of the points of a pair that must find a partner.
    pub matched_share: f64,
}

impl Default for AlignConfig {
    fn default() -> Self {
        Self {
            pairs: PairConfig::default(),
            distances_m: vec![0.4, 0.3, 0.2, 0.15, 0.15, 0.15],
            outlier_m: 0.05,
            point_deviation_m: 0.1,
            matched_share: 0.3,
        }
    }
}

/// Moves the poses so that the walls of all scans agree; the edges hold what the walls leave open. Pose 0 stands still.
///
/// # Errors
/// A part hangs on nothing.
pub fn align(
    views: &[ScanView],
    poses: &mut [Se2],
    edges: &[Edge],
    config: &AlignConfig,
) -> Result<(), Unsolvable> {
    let compared = overlapping_pairs(poses, &config.pairs);
    let pairs: Vec<[usize; 2]> =
        compared.iter().copied().chain(edges.iter().map(|edge| [edge.from, edge.to])).collect();
    let mut system = BlockSystem::new(poses.len(), &pairs);
    let scale = 1.0 / (config.point_deviation_m * config.point_deviation_m);
    for &distance_m in &config.distances_m {
        let limits = MatchLimits { distance_m, outlier_m: config.outlier_m, direction_cosine: 0.85 };
        system.clear();
        for (index, &[a, b]) in compared.iter().enumerate() {
            let matched = match_pair([&views[a], &views[b]], [poses[a], poses[b]], &limits);
            let needed = (config.matched_share * matched.asked as f64).max(20.0);
            if matched.matched as f64 >= needed {
                system.add(index, &scaled(&held(&matched.terms), scale));
            }
        }
        for (index, edge) in edges.iter().enumerate() {
            system.add(compared.len() + index, &edge.terms(poses[edge.from], poses[edge.to], 1.0));
        }
        let step = system.solve()?;
        for (pose, step) in poses.iter_mut().skip(1).zip(step.chunks_exact(3)) {
            *pose = Se2::new(pose.x_m + step[0], pose.y_m + step[1], pose.heading_rad + step[2]);
        }
    }
    Ok(())
}

/// The direction of a wall is known to a few degrees, and returns lie denser near the scanner: along a smooth corridor the sum of
/// these errors draws scans towards each other. A direction of the place with less than this share of the largest curvature is
/// left to the edges.
const HELD_SHARE: f64 = 0.02;

/// The terms without a direction of the place that the walls do not hold.
fn held(terms: &PairTerms) -> PairTerms {
    let block = terms.first.fixed_view::<2, 2>(0, 0).into_owned();
    let eigen = block.symmetric_eigen();
    let weak = eigen.eigenvalues.imin();
    if eigen.eigenvalues[weak] >= HELD_SHARE * eigen.eigenvalues.max() {
        return *terms;
    }
    let along = eigen.eigenvectors.column(weak);
    let along = Vector3::new(along.x, along.y, 0.0);
    let across = Matrix3::identity() - along * along.transpose();
    PairTerms {
        first: across * terms.first * across,
        second: across * terms.second * across,
        mixed: across * terms.mixed * across,
        first_gradient: across * terms.first_gradient,
        second_gradient: across * terms.second_gradient,
    }
}

fn scaled(terms: &PairTerms, scale: f64) -> PairTerms {
    PairTerms {
        first: terms.first * scale,
        second: terms.second * scale,
        mixed: terms.mixed * scale,
        first_gradient: terms.first_gradient * scale,
        second_gradient: terms.second_gradient * scale,
    }
}
