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

/// Rounds at most.
const ROUNDS_MAX: usize = 32;

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
    let mut pairs = overlapping_pairs(poses, &config.pairs);
    let compared = pairs.len();
    pairs.extend(edges.iter().map(|edge| [edge.from as u32, edge.to as u32]));
    pairs.shrink_to_fit();
    let mut system = IterativeSystem::new(poses.len(), pairs, config.solver);
    // Where all scans stood at the beginning of each round, and in which round each pair was matched last: its terms are made
    // again from that, as they are larger than everything else together.
    let mut stood: Vec<Vec<Se2>> = Vec::with_capacity(rounds.len());
    let mut matched_in: Vec<Option<u8>> = vec![None; compared];
    for (number, round) in rounds.iter().take(ROUNDS_MAX).enumerate() {
        system.clear();
        stood.push(poses.to_vec());
        for (index, last) in matched_in.iter_mut().enumerate() {
            let [a, b] = system.pair(index);
            let at = |number: u8| {
                let poses = &stood[usize::from(number)];
                [poses[a], poses[b]]
            };
            let now = [poses[a], poses[b]];
            let is_kept =
                |last: &u8| rounds[usize::from(*last)] == *round && is_still(at(*last), now, config.still);
            let matched = last.filter(is_kept).unwrap_or(number as u8);
            *last = Some(matched);
            if let Some(terms) = terms_of([&views[a], &views[b]], at(matched), *round, config) {
                system.add(index, &moved(terms, at(matched), now));
            }
        }
        for (index, edge) in edges.iter().enumerate() {
            system.add(compared + index, &edge.terms(poses[edge.from], poses[edge.to], 1.0));
        }
        let step = system.solve()?;
        for (pose, step) in poses.iter_mut().skip(1).zip(step.chunks_exact(3)) {
            *pose = Se2::new(pose.x_m + step[0], pose.y_m + step[1], pose.heading_rad + step[2]);
        }
    }
    Ok(())
}

/// What the walls say about a pair at these poses; `None`: too few points found a partner.
fn terms_of(
    views: [&ScanView; 2],
    poses: [Se2; 2],
    round: AlignRound,
    config: &AlignConfig,
) -> Option<PairTerms> {
    let AlignRound { distance_m, stride } = round;
    let limits = MatchLimits { distance_m, outlier_m: config.outlier_m, direction_cosine: 0.85, stride };
    let matched = match_pair(views, poses, &limits);
    let needed = (config.matched_share * matched.asked as f64).max(20.0 / stride.max(1) as f64);
    let scale = stride as f64 / (config.point_deviation_m * config.point_deviation_m);
    let is_enough = matched.matched as f64 >= needed;
    is_enough.then(|| scaled(&held(&matched.terms), scale))
}

/// Whether the scans stand to each other as they stood then.
fn is_still(then: [Se2; 2], now: [Se2; 2], (still_m, still_rad): (f64, f64)) -> bool {
    let moved = then[0].between(then[1]).between(now[0].between(now[1]));
    moved.length_m() < still_m && moved.heading_rad.abs() < still_rad
}

/// The terms where the scans stand now: distances across walls change with the poses, which points belong together does not.
fn moved(terms: PairTerms, then: [Se2; 2], now: [Se2; 2]) -> PairTerms {
    let [first, second] = [0, 1].map(|index| {
        let (now, then) = (now[index], then[index]);
        Vector3::new(now.x_m - then.x_m, now.y_m - then.y_m, wrap(now.heading_rad - then.heading_rad))
    });
    PairTerms {
        first_gradient: terms.first_gradient + terms.first * first + terms.mixed * second,
        second_gradient: terms.second_gradient + terms.mixed.transpose() * first + terms.second * second,
        ..terms
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
