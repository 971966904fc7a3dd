//! The offset of a whole drive.

use super::piece::{PieceTerms, compare};
use crate::input::OdometryTrack;
use crate::se2::Se2;

/// A piece of a drive, seconds: some turns of a robot, and little drift.
const PIECE_S: f64 = 4.0;
/// Fewer scans in a piece say nothing...
const SCANS_LEAST: usize = 12;
/// ... and scans farther apart end it, seconds.
const GAP_S: f64 = 0.5;
/// A piece in which the rate of turn changes by less, rad/s, says nothing about the time.
const RATE_CHANGE_RADPS: f64 = 0.03;
/// Fewer turning pieces give no offset: their scatter would not be known.
const PIECES_LEAST: usize = 4;
/// Rounds, at most, and the change below which one is the last, seconds.
const ROUNDS: usize = 12;
const STEP_S: f64 = 1.0e-5;
/// A piece farther from the others than so many deviations weighs as if it lay there (Huber 1964).
const HUBER: f64 = 1.5;
/// Rounds of these weights.
const WEIGHT_ROUNDS: usize = 10;
/// From the median of distances without their signs to a standard deviation.
const DEVIATION_OF_MEDIAN: f64 = 1.4826;
/// An offset counts from so many of its deviations on...
const SIGNIFICANT: f64 = 4.0;
/// ... if it is known to this, seconds...
const DEVIATION_MAX_S: f64 = 0.005;
/// ... and no larger than this, seconds.
pub const OFFSET_MAX_S: f64 = 0.06;

/// By how much scans are younger than their stamps say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeOffset {
    /// To be added to the stamps, seconds; negative: the scans are older.
    pub younger_s: f64,
    /// Standard deviation, by the scatter of the pieces of the drive, seconds.
    pub deviation_s: f64,
    /// Pieces of the drive in which the robot turned.
    pub pieces: usize,
}

impl TimeOffset {
    /// Whether the stamps should be corrected by it: it is known well, differs from none, and is not absurd.
    #[must_use]
    pub fn is_believed(&self) -> bool {
        self.differs() && self.deviation_s <= DEVIATION_MAX_S && self.younger_s.abs() <= OFFSET_MAX_S
    }

    /// Larger than the age of any scan: two clocks, or stamps of something else.
    #[must_use]
    pub fn is_absurd(&self) -> bool {
        self.differs() && self.younger_s.abs() > OFFSET_MAX_S
    }

    fn differs(&self) -> bool {
        self.younger_s.abs() > SIGNIFICANT * self.deviation_s
    }
}

/// The offset at which the headings of the mapped scans agree best with the odometry, by least squares over the pieces of the drive in
/// which the robot turned. `None` where too little turns: a straight drive says nothing about the time. The poses are ordered by
/// time; where they stand in the map plays no role.
#[must_use]
pub fn estimate_time_offset(poses: &[(f64, Se2)], odometry: &OdometryTrack) -> Option<TimeOffset> {
    let turns = |piece: &&[(f64, Se2)]| {
        compare(piece, odometry, 0.0).is_some_and(|terms| terms.rate_change_radps() >= RATE_CHANGE_RADPS)
    };
    let turning: Vec<&[(f64, Se2)]> = pieces(poses).into_iter().filter(turns).collect();
    let mut offset_s = 0.0;
    let mut found = None;
    for _ in 0..ROUNDS {
        let terms: Vec<PieceTerms> =
            turning.iter().filter_map(|piece| compare(piece, odometry, offset_s)).collect();
        let (later_s, deviation_s) = combined(&terms)?;
        offset_s = (offset_s + later_s).clamp(-2.0 * OFFSET_MAX_S, 2.0 * OFFSET_MAX_S);
        found = Some(TimeOffset { younger_s: offset_s, deviation_s, pieces: terms.len() });
        if later_s.abs() < STEP_S {
            break;
        }
    }
    found
}

/// The drive in pieces of the same duration, cut at gaps; those with few scans are left out.
fn pieces(poses: &[(f64, Se2)]) -> Vec<&[(f64, Se2)]> {
    let mut pieces = Vec::new();
    let mut rest = poses;
    while let Some((start_s, _)) = rest.first() {
        let is_last = |pair: &[(f64, Se2)]| pair[1].0 - pair[0].0 > GAP_S || pair[1].0 - start_s > PIECE_S;
        let count = rest.windows(2).position(is_last).map_or(rest.len(), |last| last + 1);
        let (piece, after) = rest.split_at(count);
        if piece.len() >= SCANS_LEAST {
            pieces.push(piece);
        }
        rest = after;
    }
    pieces
}

/// The offset that the pieces have in common and its standard deviation; `None` of too few.
fn combined(terms: &[PieceTerms]) -> Option<(f64, f64)> {
    let terms: Vec<&PieceTerms> = terms.iter().filter(|terms| terms.information > 0.0).collect();
    if terms.len() < PIECES_LEAST {
        return None;
    }
    let mut weights = vec![1.0; terms.len()];
    let mut mean_s = 0.0;
    for _ in 0..WEIGHT_ROUNDS {
        let weighed =
            || terms.iter().zip(&weights).map(|(terms, weight)| (terms, weight * terms.information));
        let all: f64 = weighed().map(|(_, weight)| weight).sum();
        mean_s = weighed().map(|(terms, weight)| weight * terms.later_s()).sum::<f64>() / all;
        // Each in units of what its information allows.
        let away: Vec<f64> =
            terms.iter().map(|terms| (terms.later_s() - mean_s).abs() * terms.information.sqrt()).collect();
        let deviation = (DEVIATION_OF_MEDIAN * median(&away)).max(1.0e-12);
        weights = away.iter().map(|away| (HUBER * deviation / away.max(1.0e-12)).min(1.0)).collect();
    }
    let all: f64 = terms.iter().zip(&weights).map(|(terms, weight)| weight * terms.information).sum();
    let square = |(terms, weight): (&&PieceTerms, &f64)| {
        let away = weight * terms.information * (terms.later_s() - mean_s);
        away * away
    };
    // The scatter of the pieces as it is, whatever made it. That of few pieces is known badly: the deviation is that of Student's
    // distribution with one degree of freedom less than pieces.
    let count = terms.len() as f64;
    let squares: f64 = terms.iter().zip(&weights).map(square).sum();
    Some((mean_s, (squares * count / (count - 3.0)).sqrt() / all))
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}
