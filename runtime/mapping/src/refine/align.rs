//! Rounds of matching and solving.

use nalgebra::{Matrix3, Vector3};

use super::pairs::{PairConfig, overlapping_pairs};
use super::scan_view::ScanView;
use super::terms::{MatchLimits, match_pair};
use crate::pose_graph::{Edge, IterativeConfig, IterativeSystem, PairTerms, Unsolvable};
use crate::se2::{Se2, wrap};

/// How the alignment works.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignConfig {
    /// Which scans are compared.
    pub pairs: PairConfig,
    /// Rounds from poses that may be decimetres off.
    pub rounds: Vec<AlignRound>,
    /// Rounds that follow them.
    pub last_rounds: Vec<AlignRound>,
    /// Distance across a wall at which points count half, metres.
    pub outlier_m: f64,
    /// Deviation of a point from the wall, metres, with what neighbouring points share.
    pub point_deviation_m: f64,
    /// Share of the points of a pair that must find a partner.
    pub matched_share: f64,
    /// Scans that have moved less against each other since they were matched keep their partners: metres and radians.
    pub still: (f64, f64),
    /// How the equations are solved.
    pub solver: IterativeConfig,
}

/// One round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignRound {
    /// Distance within which points are the same place, metres.
    pub distance_m: f32,
    /// Every so manyth point is asked.
    pub stride: usize,
}

impl Default for AlignConfig {
    fn default() -> Self {
        let round = |distance_m, stride| AlignRound { distance_m, stride };
        Self {
            pairs: PairConfig::default(),
            rounds: vec![round(0.4, 4), round(0.3, 4), round(0.2, 4)],
            last_rounds: vec![round(0.15, 1); 3],
            outlier_m: 0.05,
            point_deviation_m: 0.1,
            matched_share: 0.3,
            still: (0.01, 0.003),
            solver: IterativeConfig::default(),
        }
    }
}

/// What a pair of scans said when it was last matched.
struct Matched {
    round: AlignRound,
    poses: [Se2; 2],
    /// `None`: too few points found a partner.
    terms: Option<PairTerms>,
}

/// Moves the poses so that the walls of all scans agree, in these rounds; the edges hold what the walls leave open. Pose 0 stands
/// still.
///
/// # Errors
/// A part hangs on nothing.
pub fn align(
    views: &[ScanView],
    poses: &mut [Se2],
    edges: &[Edge],
    (config, rounds): (&AlignConfig, &[AlignRound]),
) -> Result<(), Unsolvable> {
    let compared = overlapping_pairs(poses, &config.pairs);
    let pairs: Vec<[usize; 2]> =
        compared.iter().copied().chain(edges.iter().map(|edge| [edge.from, edge.to])).collect();
    let mut system = IterativeSystem::new(poses.len(), &pairs, config.solver);
    let mut all: Vec<Option<Matched>> = compared.iter().map(|_| None).collect();
    for &round in rounds {
        system.clear();
        for ((index, &[a, b]), last) in compared.iter().enumerate().zip(&mut all) {
            let now = [poses[a], poses[b]];
            let kept = last.take().filter(|last| last.is_still_of(now, round, config.still));
            let matched = kept.unwrap_or_else(|| Matched::new([&views[a], &views[b]], now, round, config));
            if let Some(terms) = matched.terms_at(now) {
                system.add(index, &terms);
            }
            *last = Some(matched);
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

impl Matched {
    fn new(views: [&ScanView; 2], poses: [Se2; 2], round: AlignRound, config: &AlignConfig) -> Self {
        let AlignRound { distance_m, stride } = round;
        let limits = MatchLimits { distance_m, outlier_m: config.outlier_m, direction_cosine: 0.85, stride };
        let matched = match_pair(views, poses, &limits);
        let needed = (config.matched_share * matched.asked as f64).max(20.0 / stride.max(1) as f64);
        let scale = stride as f64 / (config.point_deviation_m * config.point_deviation_m);
        let is_enough = matched.matched as f64 >= needed;
        Self { round, poses, terms: is_enough.then(|| scaled(&held(&matched.terms), scale)) }
    }

    /// Whether the scans stand to each other as they stood when they were matched in a round like this.
    fn is_still_of(&self, poses: [Se2; 2], round: AlignRound, (still_m, still_rad): (f64, f64)) -> bool {
        let before = self.poses[0].between(self.poses[1]);
        let moved = before.between(poses[0].between(poses[1]));
        self.round == round && moved.length_m() < still_m && moved.heading_rad.abs() < still_rad
    }

    /// The terms where the scans stand now: distances across walls change with the poses, which points belong together does not.
    fn terms_at(&self, poses: [Se2; 2]) -> Option<PairTerms> {
        let terms = self.terms?;
        let [first, second] = [0, 1].map(|index| {
            let (now, then) = (poses[index], self.poses[index]);
            Vector3::new(now.x_m - then.x_m, now.y_m - then.y_m, wrap(now.heading_rad - then.heading_rad))
        });
        Some(PairTerms {
            first_gradient: terms.first_gradient + terms.first * first + terms.mixed * second,
            second_gradient: terms.second_gradient + terms.mixed.transpose() * first + terms.second * second,
            ..terms
        })
    }
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
