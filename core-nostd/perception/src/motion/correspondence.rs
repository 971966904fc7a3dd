//! Which object of the sweep before is which of this one: reciprocal nearest neighbours. Source: book,
//! Motion: Correspondence.

use super::parameters::MotionParameters;
use floorguard_types::geometry::Point3;
use floorguard_types::number::truncating_u16;
use floorguard_types::profile::{List, ListOf, Size};

/// What the correspondence needs to know of an object, in a frame that does not move with the robot (or with both
/// sweeps brought into the same one).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionObject {
    /// Mean of its returns.
    pub centroid: Point3,
    /// Of the box around it, cubic metres.
    pub volume_m3: f32,
    /// Returns.
    pub points: u16,
}

/// Squared distance of two points, m².
pub(super) fn squared(a: Point3, b: Point3) -> f32 {
    let (x, y, z) = (a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
    x * x + y * y + z * z
}

/// The index and squared distance of the nearest centroid; the first of several equally near.
pub(super) fn nearest(objects: &[MotionObject], centroid: Point3) -> Option<(usize, f32)> {
    let mut best: Option<(usize, f32)> = None;
    for (index, object) in objects.iter().enumerate() {
        let distance2 = squared(object.centroid, centroid);
        if best.is_none_or(|(_, least2)| distance2 < least2) {
            best = Some((index, distance2));
        }
    }
    best.filter(|(_, distance2)| distance2.is_finite())
}

/// Predecessors of the objects of this sweep, one entry each. Brute force: at most 256² distances.
pub(super) fn correspond<S: Size>(
    before: &[MotionObject],
    now: &[MotionObject],
    elapsed_s: f32,
    parameters: &MotionParameters,
) -> ListOf<Option<u16>, S> {
    let gate_m = parameters.speed_max_mps * elapsed_s.max(0.0) + parameters.gate_m;
    let mut predecessors = ListOf::<Option<u16>, S>::EMPTY;
    for (index, object) in now.iter().enumerate().take(S::N) {
        let predecessor = nearest(before, object.centroid).filter(|(candidate, distance2)| {
            *distance2 <= gate_m * gate_m
                && before.get(*candidate).is_some_and(|other| {
                    nearest(now, other.centroid).is_some_and(|(back, _)| back == index)
                        && volumes_agree(object, other, libm::sqrtf(*distance2), parameters)
                })
        });
        // Same capacity: never full.
        let _ = predecessors.push(predecessor.map(|(candidate, _)| truncating_u16(candidate)));
    }
    predecessors
}

fn volumes_agree(a: &MotionObject, b: &MotionObject, distance_m: f32, parameters: &MotionParameters) -> bool {
    let sum = a.volume_m3 + b.volume_m3;
    if sum <= 0.0 {
        return distance_m < parameters.catch_up_m;
    }
    (a.volume_m3 - b.volume_m3).abs() < parameters.volume_change_max * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(x_m: f32, volume_m3: f32) -> MotionObject {
        MotionObject { centroid: Point3::new(x_m, 0.0, 0.0), volume_m3, points: 10 }
    }

    fn pairs(before: &[MotionObject], now: &[MotionObject]) -> std::vec::Vec<Option<u16>> {
        correspond::<floorguard_types::profile::Of<8>>(before, now, 0.1, &MotionParameters::PAPER)
            .iter()
            .copied()
            .collect()
    }

    #[test]
    fn only_mutual_near_similar_neighbours_match() {
        // Two new objects compete for the one old object: the nearer has it.
        assert_eq!(pairs(&[object(0.0, 1.0)], &[object(0.3, 1.0), object(0.1, 1.0)]), [None, Some(0)]);
        assert_eq!(pairs(&[object(0.0, 1.0)], &[object(0.1, 1.9)]), [None]);
        assert_eq!(pairs(&[object(0.0, 1.0)], &[object(0.1, 1.8)]), [Some(0)]);
        // 6 m/s · 0.1 s + 0.1 m.
        assert_eq!(pairs(&[object(0.0, 1.0)], &[object(0.69, 1.0)]), [Some(0)]);
        assert_eq!(pairs(&[object(0.0, 1.0)], &[object(0.71, 1.0)]), [None]);
        assert_eq!(pairs(&[], &[object(0.0, 1.0)]), [None]);
    }

    #[test]
    fn flat_objects_must_be_close() {
        assert_eq!(pairs(&[object(0.0, 0.0)], &[object(0.19, 0.0)]), [Some(0)]);
        assert_eq!(pairs(&[object(0.0, 0.0)], &[object(0.21, 0.0)]), [None]);
    }

    #[test]
    fn what_is_no_number_has_no_predecessor() {
        let mut broken = object(0.0, 1.0);
        broken.centroid.y_m = f32::NAN;
        assert_eq!(pairs(&[object(0.0, 1.0)], &[broken]), [None]);
        assert_eq!(pairs(&[broken], &[object(0.0, 1.0)]), [None]);
    }
}
