//! One scan against scans whose poses are known.

use nalgebra::{Matrix3, Vector3};

use super::align::AlignRound;
use super::scan_view::ScanView;
use super::terms::{MatchLimits, match_pair};
use crate::se2::{Se2, wrap};

/// How a scan is located.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocateConfig {
    /// Deviation of the guess, metres.
    pub guess_m: f64,
    /// Deviation of the guess's heading, radians.
    pub guess_rad: f64,
    /// Deviation of a point from the wall, metres.
    pub point_deviation_m: f64,
    /// Distance across a wall at which points count half, metres.
    pub outlier_m: f64,
    /// Steps: distance within which points are the same place, and which points are asked.
    pub rounds: [AlignRound; 3],
    /// Kept scans before a scan, and after it, that it is compared with.
    pub partners: usize,
    /// A step shorter than this, metres and radians together, is the last one.
    pub step_least: f64,
}

impl Default for LocateConfig {
    fn default() -> Self {
        Self {
            guess_m: 0.05,
            guess_rad: 0.05,
            point_deviation_m: 0.2,
            outlier_m: 0.05,
            rounds: [(0.3, 2), (0.15, 1), (0.15, 1)]
                .map(|(distance_m, stride)| AlignRound { distance_m, stride }),
            partners: 2,
            step_least: 1.0e-2,
        }
    }
}

/// The pose at which a scan agrees best with its partners, near the guess. Keeps the guess where nothing matches.
#[must_use]
pub fn locate(view: &ScanView, guess: Se2, partners: &[(&ScanView, Se2)], config: &LocateConfig) -> Se2 {
    let full = 1.0 / (config.point_deviation_m * config.point_deviation_m);
    let (place, heading) = (1.0 / config.guess_m.powi(2), 1.0 / config.guess_rad.powi(2));
    let prior = Matrix3::from_diagonal(&Vector3::new(place, place, heading));
    let mut pose = guess;
    for AlignRound { distance_m, stride } in config.rounds {
        let limits = MatchLimits { distance_m, outlier_m: config.outlier_m, direction_cosine: 0.85, stride };
        let scale = stride as f64 * full;
        let away = Vector3::new(
            pose.x_m - guess.x_m,
            pose.y_m - guess.y_m,
            wrap(pose.heading_rad - guess.heading_rad),
        );
        let (mut matrix, mut gradient) = (prior, prior * away);
        for (partner, partner_pose) in partners {
            let matched = match_pair([view, partner], [pose, *partner_pose], &limits);
            matrix += matched.terms.first * scale;
            gradient += matched.terms.first_gradient * scale;
        }
        let Some(factor) = matrix.cholesky() else { return guess };
        let step = factor.solve(&gradient);
        pose = Se2::new(pose.x_m - step.x, pose.y_m - step.y, pose.heading_rad - step.z);
        if stride == 1 && step.norm() < config.step_least {
            break;
        }
    }
    pose
}
