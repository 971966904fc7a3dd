//! One piece of a drive: what the scans turned beside what the odometry turned.

use crate::input::OdometryTrack;
use crate::se2::{Se2, wrap};

/// The rate of turn is the mean over so much time to each side, seconds.
const RATE_HALF_S: f64 = 0.05;
/// Below this share of its square a column says nothing that the columns before do not.
const NEW_SHARE: f64 = 1.0e-6;

/// What a piece says about the offset: `gradient / information` is by how much the scans are later still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceTerms {
    /// Sum of the products of rate of turn and heading that is left over, rad²/s.
    pub gradient: f64,
    /// Sum of the squares of the rate of turn, (rad/s)².
    pub information: f64,
    /// Scans that were compared.
    pub scans: usize,
}

impl PieceTerms {
    /// By how much the scans are later than assumed, seconds.
    pub fn later_s(&self) -> f64 {
        self.gradient / self.information
    }

    /// How much the rate of turn changes, rad/s: root mean square.
    pub fn rate_change_radps(&self) -> f64 {
        (self.information / self.scans.max(1) as f64).sqrt()
    }
}

/// Compares the headings of scans with those of the odometry `offset_s` after their stamps. A heading that starts elsewhere, that
/// drifts evenly, and wheels that turn too much or too little are taken out before: they say nothing about the time. `None` where
/// the odometry has a gap.
pub fn compare(scans: &[(f64, Se2)], odometry: &OdometryTrack, offset_s: f64) -> Option<PieceTerms> {
    let &(start_s, start) = scans.first()?;
    let heading_at = |time_s: f64| Some(odometry.at(time_s + offset_s)?.heading_rad);
    let first_rad = heading_at(start_s)?;
    let (mut times, mut turned, mut rates, mut left) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut seen_rad, mut driven_rad) = (0.0, 0.0);
    for (time_s, pose) in scans {
        let turn = wrap(heading_at(time_s + RATE_HALF_S)? - heading_at(time_s - RATE_HALF_S)?);
        // Unwrapped: from scan to scan it is less than half a turn.
        driven_rad += wrap(heading_at(*time_s)? - first_rad - driven_rad);
        seen_rad += wrap(pose.heading_rad - start.heading_rad - seen_rad);
        times.push(time_s - start_s);
        turned.push(driven_rad);
        rates.push(0.5 * turn / RATE_HALF_S);
        left.push(seen_rad - driven_rad);
    }
    let columns = orthogonal([vec![1.0; times.len()], times, turned]);
    for column in columns {
        take_out(&column, &mut rates);
        take_out(&column, &mut left);
    }
    let gradient = product(&rates, &left);
    Some(PieceTerms { gradient, information: product(&rates, &rates), scans: rates.len() })
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What of a column lies along another one goes; that one stays.
fn take_out(column: &[f64], from: &mut [f64]) {
    let square = product(column, column);
    let share = if square > 0.0 { product(column, from) / square } else { 0.0 };
    from.iter_mut().zip(column).for_each(|(value, other)| *value -= share * other);
}

/// Each column without what the ones before it hold (Gram and Schmidt); zero where nothing is left.
fn orthogonal(mut columns: [Vec<f64>; 3]) -> [Vec<f64>; 3] {
    for index in 1..columns.len() {
        let (before, rest) = columns.split_at_mut(index);
        let Some(column) = rest.first_mut() else { continue };
        let square = product(column, column);
        before.iter().for_each(|known| take_out(known, column));
        if product(column, column) < NEW_SHARE * square {
            column.fill(0.0);
        }
    }
    columns
}
