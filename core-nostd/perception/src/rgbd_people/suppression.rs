//! One person, one detection: of boxes that overlap, or people who would stand in each other, the best stays.
//!
//! Source: book, Depth people: Suppression.

use heapless::Vec;

use super::detection::RgbdDetection;
use floorguard_types::capacities::RGBD_CANDIDATES_MAX;

/// Two people do not stand nearer to each other than this, metres.
const SAME_PLACE_M: f32 = 0.3;

/// Candidates, best first.
pub(super) type Candidates = Vec<RgbdDetection, RGBD_CANDIDATES_MAX>;

/// Adds a candidate in the order of its score; the worst is given up when the list is full. True if one was given up.
pub(super) fn enlist(candidates: &mut Candidates, candidate: RgbdDetection) -> bool {
    let is_full = candidates.is_full();
    if is_full {
        if candidates.last().is_some_and(|last| last.score <= candidate.score) {
            return true;
        }
        candidates.pop();
    }
    let place = candidates.iter().position(|other| other.score > candidate.score);
    let place = place.unwrap_or(candidates.len());
    candidates.insert(place, candidate).is_err() || is_full
}

/// Whether two detections show the same person.
pub(super) fn is_same(a: &RgbdDetection, b: &RgbdDetection, overlap_max: f32) -> bool {
    overlap(a, b) >= overlap_max || a.position_in_base.distance(b.position_in_base) < SAME_PLACE_M
}

/// Intersection over union of the rectangles.
fn overlap(a: &RgbdDetection, b: &RgbdDetection) -> f32 {
    let side = |axis: usize| {
        let pick = |corner: &[u16; 2]| corner.get(axis).copied().map_or(0.0, f32::from);
        let shared = pick(&a.last_px).min(pick(&b.last_px)) - pick(&a.first_px).max(pick(&b.first_px)) + 1.0;
        let own = |one: &RgbdDetection| pick(&one.last_px) - pick(&one.first_px) + 1.0;
        (shared.max(0.0), own(a), own(b))
    };
    let ((sx, ax, bx), (sy, ay, by)) = (side(0), side(1));
    let shared = sx * sy;
    shared / (ax * ay + bx * by - shared).max(1.0)
}
