//! One box for each person: the best, without those that overlap it (greedy non-maximum suppression).

use super::layout::Candidate;

/// Candidates that are looked at, the best ones.
const CANDIDATES_MAX: usize = 1_000;

/// The best candidates, the surest first, at most `most`; of two that overlap by more than `overlap_max` (intersection over
/// union) only the surer one stays. Equal scores keep their order.
///
/// ```
/// use floorguard_detector::{Candidate, suppress};
///
/// let at = |left: f32, score| Candidate { edges: [left, 0.0, left + 10.0, 10.0], score };
/// let kept = suppress(vec![at(0.0, 0.6), at(1.0, 0.9), at(30.0, 0.7)], 0.45, 32);
/// assert_eq!(kept.iter().map(|each| each.score).collect::<Vec<_>>(), [0.9, 0.7]);
/// ```
#[must_use]
pub fn suppress(mut candidates: Vec<Candidate>, overlap_max: f32, most: usize) -> Vec<Candidate> {
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut kept: Vec<Candidate> = Vec::new();
    for candidate in candidates.into_iter().take(CANDIDATES_MAX) {
        if kept.len() >= most {
            break;
        }
        if kept.iter().all(|better| overlap(better, &candidate) <= overlap_max) {
            kept.push(candidate);
        }
    }
    kept
}

fn area([left, top, right, bottom]: [f32; 4]) -> f32 {
    (right - left).max(0.0) * (bottom - top).max(0.0)
}

fn overlap(a: &Candidate, b: &Candidate) -> f32 {
    let ([al, at, ar, ab], [bl, bt, br, bb]) = (a.edges, b.edges);
    let common = area([al.max(bl), at.max(bt), ar.min(br), ab.min(bb)]);
    let either = area(a.edges) + area(b.edges) - common;
    if either > 0.0 { common / either } else { 0.0 }
}
