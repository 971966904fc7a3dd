//! Collects frame after frame what was there and the tracker's output.
//!
//! The rules are those of CLEAR-MOT: a pairing of the frame before is kept as long as it is within the gate; only the
//! rest is paired anew, as many as possible and then at the least distance.

use std::collections::{BTreeMap, BTreeSet};

use floorguard_types::geometry::Point2;

use super::assignment::best_pairs;
use super::identity::Overlaps;
use super::summary::{MotSummary, ratio};

/// A track farther than this from a person, metres, is not the track of that person: about an arm's length and the
/// usual gate of evaluations on the floor.
pub const POINT_GATE_M: f64 = 1.0;

/// Distances are compared as integers of a millionth, so that the solver gives the same pairs on every machine.
const DISTANCE_STEPS: f64 = 1.0e6;
/// What a pair is worth before its distance is taken off: more than all distances of a frame together.
const PAIR_WORTH: i64 = 1 << 40;

/// Compares tracks with the truth.
#[derive(Clone, Debug, Default)]
pub struct MotAccumulator {
    /// Newest track of each object.
    partner: BTreeMap<u64, u64>,
    lives: BTreeMap<u64, Life>,
    overlaps: Overlaps,
    distance_sum: f64,
    counts: MotSummary,
}

/// What became of one true object.
#[derive(Clone, Copy, Debug, Default)]
struct Life {
    seen: u64,
    covered: u64,
    lost_since_covered: bool,
}

impl MotAccumulator {
    /// Nothing seen yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// One frame of points on the floor, metres, all in the same frame of reference; the gate is [`POINT_GATE_M`].
    /// Identifiers are unique within each list.
    pub fn frame(&mut self, truth: &[(u64, Point2)], tracks: &[(u64, Point2)]) {
        let distance = |object: usize, track: usize| {
            let distance_m = f64::from(truth[object].1.distance(tracks[track].1));
            (distance_m <= POINT_GATE_M).then_some(distance_m)
        };
        let ids = |list: &[(u64, Point2)]| -> Vec<u64> { list.iter().map(|(id, _)| *id).collect() };
        self.frame_by_distance(&ids(truth), &ids(tracks), distance);
    }

    /// One frame with any distance: `distance(object index, track index)` is `None` beyond the gate.
    pub fn frame_by_distance(
        &mut self,
        objects: &[u64],
        tracks: &[u64],
        distance: impl Fn(usize, usize) -> Option<f64>,
    ) {
        self.counts.frames += 1;
        self.counts.objects += objects.len() as u64;
        self.counts.predictions += tracks.len() as u64;
        for (row, object) in objects.iter().enumerate() {
            for (column, track) in tracks.iter().enumerate() {
                if distance(row, column).is_some() {
                    self.overlaps.add(*object, *track);
                }
            }
        }
        let mut pairs = self.kept_pairs(objects, tracks, &distance);
        pairs.extend(new_pairs(objects.len(), tracks.len(), &pairs, &distance));
        for (row, column) in &pairs {
            let (object, track) = (objects[*row], tracks[*column]);
            let before = self.partner.insert(object, track);
            self.counts.switches += u64::from(before.is_some_and(|before| before != track));
            self.distance_sum += distance(*row, *column).unwrap_or(0.0);
        }
        self.counts.matches += pairs.len() as u64;
        self.counts.misses += (objects.len() - pairs.len()) as u64;
        self.counts.false_positives += (tracks.len() - pairs.len()) as u64;
        let covered: BTreeSet<usize> = pairs.iter().map(|(row, _)| *row).collect();
        for (row, object) in objects.iter().enumerate() {
            let life = self.lives.entry(*object).or_default();
            self.counts.fragmentations += u64::from(life.live_on(covered.contains(&row)));
        }
    }

    /// Pairings of earlier frames that still hold.
    fn kept_pairs(
        &self,
        objects: &[u64],
        tracks: &[u64],
        distance: &impl Fn(usize, usize) -> Option<f64>,
    ) -> Vec<(usize, usize)> {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (row, object) in objects.iter().enumerate() {
            let Some(partner) = self.partner.get(object) else { continue };
            let Some(column) = tracks.iter().position(|track| track == partner) else { continue };
            let is_taken = pairs.iter().any(|(_, taken)| *taken == column);
            if !is_taken && distance(row, column).is_some() {
                pairs.push((row, column));
            }
        }
        pairs
    }

    /// The newest track of each object that ever had one.
    #[must_use]
    pub const fn partners(&self) -> &BTreeMap<u64, u64> {
        &self.partner
    }

    /// The figures so far.
    #[must_use]
    pub fn summary(&self) -> MotSummary {
        let counts = self.counts;
        let identity = self.overlaps.identity_true_positives() as f64;
        let wrong = counts.misses + counts.false_positives + counts.switches;
        let covered_at_least = |share: f64| {
            self.lives.values().filter(|life| life.covered as f64 >= share * life.seen as f64).count() as u64
        };
        let unique_objects = self.lives.len() as u64;
        MotSummary {
            unique_objects,
            mostly_tracked: covered_at_least(0.8),
            mostly_lost: unique_objects - covered_at_least(0.2),
            mota: ratio(wrong as f64, counts.objects).map(|share| 1.0 - share),
            motp: ratio(self.distance_sum, counts.matches),
            idf1: ratio(2.0 * identity, counts.objects + counts.predictions),
            identity_precision: ratio(identity, counts.predictions),
            identity_recall: ratio(identity, counts.objects),
            ..counts
        }
    }
}

impl Life {
    /// One more frame; says whether it was found again after a loss.
    fn live_on(&mut self, is_covered: bool) -> bool {
        let found_again = is_covered && self.lost_since_covered;
        self.seen += 1;
        self.covered += u64::from(is_covered);
        self.lost_since_covered = !is_covered && self.covered > 0;
        found_again
    }
}

/// Pairs what is left over: as many as possible, then at the least total distance.
fn new_pairs(
    objects: usize,
    tracks: usize,
    taken: &[(usize, usize)],
    distance: &impl Fn(usize, usize) -> Option<f64>,
) -> Vec<(usize, usize)> {
    let rows: Vec<_> = (0..objects).filter(|row| taken.iter().all(|(other, _)| other != row)).collect();
    let columns: Vec<_> =
        (0..tracks).filter(|column| taken.iter().all(|(_, other)| other != column)).collect();
    let worth = |row: usize, column: usize| {
        distance(rows[row], columns[column])
            .map_or(0, |distance| (PAIR_WORTH - (distance * DISTANCE_STEPS) as i64).max(1))
    };
    let pairs = best_pairs(rows.len(), columns.len(), worth);
    pairs.into_iter().map(|(row, column)| (rows[row], columns[column])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(id: u64, x_m: f32) -> (u64, Point2) {
        (id, Point2::new(x_m, 0.0))
    }

    #[test]
    fn nothing_to_measure_gives_no_figures() {
        let mut accumulator = MotAccumulator::new();
        accumulator.frame(&[], &[]);
        let summary = accumulator.summary();
        assert_eq!((summary.frames, summary.mota, summary.motp, summary.idf1), (1, None, None, None));
    }

    #[test]
    fn switch_miss_and_ghost_are_distinguished() {
        let mut accumulator = MotAccumulator::new();
        accumulator.frame(&[at(1, 0.0)], &[at(10, 0.5)]);
        accumulator.frame(&[at(1, 0.0)], &[]);
        accumulator.frame(&[at(1, 0.0)], &[at(11, 0.1), at(12, 9.0)]);
        let summary = accumulator.summary();
        assert_eq!((summary.matches, summary.misses, summary.false_positives), (2, 1, 1));
        assert_eq!((summary.switches, summary.fragmentations), (1, 1));
        assert_eq!(summary.mota, Some(0.0));
        assert!((summary.motp.expect("two matches") - 0.3).abs() < 1e-6);
        // One of three observations has the identity that it should have.
        assert_eq!(summary.idf1, Some(2.0 / 6.0));
    }

    #[test]
    fn pairing_is_kept_despite_nearer_track() {
        let mut accumulator = MotAccumulator::new();
        accumulator.frame(&[at(1, 0.0)], &[at(10, 0.1)]);
        accumulator.frame(&[at(1, 0.0)], &[at(10, 0.8), at(11, 0.1)]);
        assert_eq!(accumulator.summary().switches, 0);
        // Beyond the gate it breaks.
        accumulator.frame(&[at(1, 0.0)], &[at(10, 1.1), at(11, 0.1)]);
        assert_eq!(accumulator.summary().switches, 1);
    }
}
