//! Which clusters may be people: the published volume (Yan et al. 2020a, section 4.1), made honest about distance
//! and about the floor.

use crate::clusters::Cluster;

/// The volume that a person can fill, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CandidateLimits {
    /// Narrowest; a leg alone is narrower.
    pub width_min_m: f32,
    /// Widest in either direction of the floor.
    pub width_max_m: f32,
    /// Lowest visible height. Far away only a few rings hit.
    pub height_min_m: f32,
    /// Tallest.
    pub height_max_m: f32,
    /// The lowest return may hang this high above the floor before a cluster is no walker, when its lower part is in
    /// view.
    pub bottom_max_m: f32,
    /// The top must reach this high: bags and bins do not.
    pub top_min_m: f32,
}

impl CandidateLimits {
    /// Widths and heights after Yan et al. 2020a; bottom and top are ours, for adults and children from 0.8 m.
    pub const DEFAULT: Self = Self {
        width_min_m: 0.1,
        width_max_m: 1.0,
        height_min_m: 0.4,
        height_max_m: 2.0,
        bottom_max_m: 0.7,
        top_min_m: 0.8,
    };
}

impl Default for CandidateLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Vertical distance between two rings per metre of range: 2°.
const RING_STEP: f32 = 0.035;

impl CandidateLimits {
    /// Whether a cluster may be a person. `sensor_height_m` tells how much of a body is in view at this distance.
    #[must_use]
    pub fn admits(&self, cluster: &Cluster, sensor_height_m: f32) -> bool {
        let [width_m, depth_m, height_m] = cluster.extent_m();
        let spacing_m = RING_STEP * cluster.nearest_m;
        // The beams look 15° down and up: nearer than this, feet or head are out of view.
        let view_bottom_m = (sensor_height_m - 0.268 * cluster.nearest_m).max(0.0);
        let view_top_m = sensor_height_m + 0.268 * cluster.nearest_m;
        let widest_m = width_m.max(depth_m);
        let fits = (self.width_min_m..=self.width_max_m).contains(&widest_m) && height_m <= self.height_max_m;
        let stands = cluster.lower.z_m <= self.bottom_max_m + view_bottom_m + spacing_m;
        let visible_top_m = self.top_min_m.min(view_top_m - spacing_m);
        let reaches =
            cluster.upper.z_m >= visible_top_m - 0.05 && cluster.upper.z_m <= self.height_max_m + 0.1;
        let tall = height_m >= self.height_min_m.min((view_top_m - view_bottom_m) * 0.5);
        fits && stands && reaches && tall
    }

    /// Whether a cluster of returns above the height of desks may be head and torso.
    #[must_use]
    pub fn admits_upper_body(&self, cluster: &Cluster) -> bool {
        let [width_m, depth_m, height_m] = cluster.extent_m();
        let widest_m = width_m.max(depth_m);
        let fits = (0.15..=UPPER_BODY_WIDTH_MAX_M).contains(&widest_m);
        let enough = cluster.points >= UPPER_BODY_POINTS_MIN && height_m >= UPPER_BODY_HEIGHT_MIN_M;
        fits && enough && cluster.upper.z_m <= self.height_max_m
    }
}

/// A pair of shoulders with arms, metres.
const UPPER_BODY_WIDTH_MAX_M: f32 = 0.8;
/// Returns that make a torso.
const UPPER_BODY_POINTS_MIN: u16 = 12;
/// At least two rings at 3 m.
const UPPER_BODY_HEIGHT_MIN_M: f32 = 0.08;
