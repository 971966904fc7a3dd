//! Clusters exactly as FLOBOT's detector defines them: Euclidean components within nested rings. Source: book, People:
//! Published clusters.
//!
//! For comparison with published results, not for the robot: the split at ring borders is part of the definition. The
//! components are those of the definition, but found by index arithmetic on the range image: a point closer than the
//! tolerance must lie within an angle that the distance gives.

use core::f32::consts::PI;

use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::geometry::Point3;
use floorguard_types::number::{nearest_f32, saturating_usize, short_usize, truncating_u16};

/// Rings of the published detector.
pub const RINGS: usize = 14;
/// No cluster.
pub const UNGROUPED: u16 = u16::MAX;

/// Parameters of the published detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingLimits {
    /// Lowest height in the lidar's frame, metres, inclusive.
    pub z_min_m: f32,
    /// Highest height in the lidar's frame, metres, inclusive.
    pub z_max_m: f32,
    /// Vertical angle between beams, radians.
    pub beam_step_rad: f32,
}

impl Default for RingLimits {
    /// A VLP-16, 0.8 m above the floor.
    fn default() -> Self {
        Self { z_min_m: -0.8, z_max_m: 1.2, beam_step_rad: 2.0 * PI / 180.0 }
    }
}

/// Growth of the tolerance from ring to ring, metres.
const STEP_M: f32 = 0.1;

impl RingLimits {
    /// Tolerance within a ring, metres.
    #[must_use]
    pub fn tolerance_m(ring: usize) -> f32 {
        STEP_M * (nearest_f32(ring) + 1.0)
    }

    /// Outer radius of a ring: `floor(k·0.1 / (2·tan(Θ/2)))`.
    #[must_use]
    pub fn radius_m(&self, ring: usize) -> f32 {
        let gap_per_m = 2.0 * libm::tanf(self.beam_step_rad * 0.5);
        libm::floorf(Self::tolerance_m(ring) / gap_per_m.max(1.0e-3))
    }

    /// Ring of a point of the lidar's frame, by its distance in space; `None` at the origin, beyond the last ring, and
    /// for what is not a number.
    #[must_use]
    pub fn ring_of(&self, point: Point3) -> Option<usize> {
        let squared = point.x_m * point.x_m + point.y_m * point.y_m + point.z_m * point.z_m;
        if !(squared > 0.0 && squared.is_finite()) {
            return None;
        }
        (0..RINGS).find(|ring| {
            let radius_m = self.radius_m(*ring);
            squared <= radius_m * radius_m
        })
    }

    /// Groups the points of a sweep: column by column in order of azimuth, `SWEEP_RINGS` a column, evenly spaced around
    /// the circle; `None` where there is no return. Writes for each the index of the first point of its component, or
    /// [`UNGROUPED`]. Components of any size are kept. `labels` must be as long as `points`, at most 65,535; what is
    /// longer is left out.
    pub fn group(&self, points: &[Option<Point3>], labels: &mut [u16]) {
        labels.fill(UNGROUPED);
        let columns = points.len() / SWEEP_RINGS;
        for (index, (label, point)) in labels.iter_mut().zip(points).enumerate().take(usize::from(UNGROUPED))
        {
            if self.ring_in_slice(point).is_some() {
                *label = truncating_u16(index);
            }
        }
        for (index, point) in points.iter().enumerate().take(usize::from(UNGROUPED)) {
            let (Some(ring), Some(point)) = (self.ring_in_slice(point), point) else { continue };
            let tolerance_m = Self::tolerance_m(ring);
            for back in 0..=window(point, tolerance_m, columns).min(COLUMNS_BACK_MAX) {
                let column = (index / SWEEP_RINGS + columns).saturating_sub(back) % columns.max(1);
                for other in (0..SWEEP_RINGS).map(|laser| column * SWEEP_RINGS + laser) {
                    let near = points.get(other).copied().flatten().is_some_and(|other| {
                        closer(point, &other, tolerance_m) && self.ring_in_slice(&Some(other)) == Some(ring)
                    });
                    if near {
                        join(labels, index, other);
                    }
                }
            }
        }
        for index in 0..labels.len() {
            let root = root(labels, index);
            if let Some(label) = labels.get_mut(index) {
                *label = root;
            }
        }
    }

    fn ring_in_slice(&self, point: &Option<Point3>) -> Option<usize> {
        let point = (*point)?;
        if (self.z_min_m..=self.z_max_m).contains(&point.z_m) { self.ring_of(point) } else { None }
    }
}

/// Half a revolution of the longest sweep that 16-bit labels can number.
const COLUMNS_BACK_MAX: usize = short_usize(UNGROUPED) / SWEEP_RINGS / 2;

/// Columns to look back: a point closer than the tolerance lies within asin(tolerance / horizontal distance) of azimuth.
/// A tenth and two columns more allow for uneven spacing; at most half a revolution.
fn window(point: &Point3, tolerance_m: f32, columns: usize) -> usize {
    let horizontal_m = libm::sqrtf(point.x_m * point.x_m + point.y_m * point.y_m);
    let half = columns / 2;
    if horizontal_m <= tolerance_m {
        return half;
    }
    let angle_rad = libm::asinf(tolerance_m / horizontal_m);
    saturating_usize(angle_rad * 1.1 / (2.0 * PI) * nearest_f32(columns)).saturating_add(3).min(half)
}

/// Strictly closer than the tolerance (equality does not link).
fn closer(a: &Point3, b: &Point3, tolerance_m: f32) -> bool {
    let (x, y, z) = (a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
    x * x + y * y + z * z < tolerance_m * tolerance_m
}

/// Root of a set, halving the path. Parents have smaller indices, so a walk ends within as many steps as there are
/// labels.
fn root(labels: &mut [u16], index: usize) -> u16 {
    let mut current = index;
    for _ in 0..labels.len() {
        let Some(parent) = labels.get(current).copied() else { return UNGROUPED };
        if parent == UNGROUPED || usize::from(parent) == current {
            return parent;
        }
        let grandparent = labels.get(usize::from(parent)).copied().unwrap_or(parent);
        if let Some(label) = labels.get_mut(current) {
            *label = grandparent;
        }
        current = usize::from(grandparent);
    }
    UNGROUPED
}

fn join(labels: &mut [u16], a: usize, b: usize) {
    let (a, b) = (root(labels, a), root(labels, b));
    if let Some(label) = labels.get_mut(usize::from(a.max(b))).filter(|_| a != UNGROUPED && b != UNGROUPED) {
        *label = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of the book, People: Published clusters.
    #[test]
    fn rings_equal_the_vectors() {
        let limits = RingLimits::default();
        let radii: std::vec::Vec<_> = (0..RINGS).map(|ring| limits.radius_m(ring)).collect();
        assert_eq!(radii, [2.0, 5.0, 8.0, 11.0, 14.0, 17.0, 20.0, 22.0, 25.0, 28.0, 31.0, 34.0, 37.0, 40.0]);
        for ((x, y, z), ring) in [
            ((0.0, 0.0, 0.0), None),
            ((2.0, 0.0, 0.0), Some(0)),
            ((2.0001, 0.0, 0.0), Some(1)),
            ((3.0, 4.0, 0.0), Some(1)),
            ((4.0, 3.0, 0.01), Some(2)),
            ((10.0, 5.0, -0.7), Some(4)),
            ((0.0, 40.0, 0.0), Some(13)),
            ((0.0, 40.01, 0.0), None),
        ] {
            assert_eq!(limits.ring_of(Point3::new(x, y, z)), ring, "({x}, {y}, {z})");
        }
        assert_eq!(limits.ring_of(Point3::new(f32::NAN, 0.0, 0.0)), None);
        let mut coarse = limits;
        coarse.beam_step_rad = 1.25 * PI / 180.0;
        let widths: std::vec::Vec<_> =
            (1..RINGS).map(|ring| coarse.radius_m(ring) - coarse.radius_m(ring - 1)).collect();
        assert_eq!(widths, [5.0, 4.0, 5.0, 4.0, 5.0, 5.0, 4.0, 5.0, 4.0, 5.0, 5.0, 4.0, 5.0]);
    }

    /// The definition: link every pair of a ring that is closer than its tolerance, until nothing changes.
    fn defined(limits: &RingLimits, points: &[Option<Point3>]) -> std::vec::Vec<u16> {
        let mut labels: std::vec::Vec<u16> = (0..points.len() as u16).collect();
        let ring = |index: usize| limits.ring_in_slice(&points[index]);
        loop {
            let before = labels.clone();
            for a in 0..points.len() {
                for b in 0..a {
                    let (Some(p), Some(q)) = (points[a], points[b]) else { continue };
                    let linked = ring(a).filter(|_| ring(a) == ring(b));
                    if linked.is_some_and(|ring| closer(&p, &q, RingLimits::tolerance_m(ring))) {
                        let least = labels[a].min(labels[b]);
                        (labels[a], labels[b]) = (least, least);
                    }
                }
            }
            if before == labels {
                break;
            }
        }
        for (index, label) in labels.iter_mut().enumerate() {
            if ring(index).is_none() {
                *label = UNGROUPED;
            }
        }
        labels
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig::with_cases(48))]
        #[test]
        fn components_are_those_of_the_definition(
            ranges in proptest::collection::vec(0.0_f32..9.0, 40 * SWEEP_RINGS),
            walls in proptest::collection::vec(0.3_f32..8.0, 40),
        ) {
            let limits = RingLimits::default();
            let points: std::vec::Vec<_> = ranges.iter().enumerate().map(|(index, range)| {
                let (column, laser) = (index / SWEEP_RINGS, index % SWEEP_RINGS);
                // A third has no return, a third scatters, a third lies on walls.
                let range_m = match index % 3 { 0 => return None, 1 => *range, _ => walls[column] };
                let (sin, cos) = libm::sincosf(-(column as f32) / 40.0 * 2.0 * PI);
                let (up, out) = libm::sincosf((laser as f32 * 2.0 - 15.0) * PI / 180.0);
                Some(Point3::new(range_m * out * cos, range_m * out * sin, range_m * up))
            }).collect();
            let mut labels = std::vec![0_u16; points.len()];
            limits.group(&points, &mut labels);
            proptest::prop_assert_eq!(labels, defined(&limits, &points));
        }
    }
}
