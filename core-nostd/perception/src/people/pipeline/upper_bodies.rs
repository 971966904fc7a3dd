//! People who touch furniture: what stands out above it.

use super::candidates::detection;
use super::context::SweepContext;
use super::find_clusters::in_counts;
use super::state::PeoplePipelineOf;
use crate::clusters::{Cluster, Obstacles, RingProfile, SweepFrame, rings_of};
use crate::tracking::{DetectionOf, Surroundings};
use floorguard_types::number::truncating_u32;
use floorguard_types::profile::{Profile, Size};
use floorguard_types::sensing::{SweepColumnOf, SweepOf};

/// Above this height a desk, a trolley or a counter has ended and a torso has not, metres.
const UPPER_BODY_M: f32 = 1.05;
/// Farther away too few rings hit a torso alone, metres.
const UPPER_BODY_RANGE_M: f32 = 8.0;

impl<P: Profile> PeoplePipelineOf<P> {
    /// People who touch a desk or a trolley are one cluster with it. What stands out above it is grouped once more,
    /// on its own, where a nearby cluster is too wide for a person.
    pub(super) fn find_upper_bodies(&mut self, sweep: &SweepOf<P>, context: &SweepContext) {
        let too_wide = |cluster: &Cluster| {
            let [width_m, depth_m, height_m] = cluster.extent_m();
            let widest_m = width_m.max(depth_m);
            widest_m > self.candidate_limits.width_max_m
                && height_m > 0.3
                && cluster.nearest_m < UPPER_BODY_RANGE_M
        };
        if !self.clusters.iter().any(too_wide) {
            return;
        }
        self.clusterer.clear(&self.cluster_limits);
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        let mut obstacles = Obstacles::default();
        let mut profile = frames.still(&SweepColumnOf::<P>::UNKNOWN).profile(&self.angles);
        for (index, column) in sweep.used_columns().iter().enumerate() {
            obstacles.present = 0;
            // What stands that high is an obstacle among the first clusters, too.
            let before = self.clusterer.present_in(index);
            if before != 0 {
                if !frames.is_level() {
                    profile = frames.still(column).profile(&self.angles);
                }
                find_upper_obstacles((column, before), &profile, &mut obstacles);
            }
            self.clusterer.enter_column(&obstacles, &self.cluster_limits);
        }
        self.gather(sweep, &frames);
        for index in 0..self.clusterer.clusters.len().min(P::Clusters::N) {
            let Some(upper) = self.clusterer.clusters.get(index).copied() else { continue };
            if self.candidate_limits.admits_upper_body(&upper) {
                let detection = detection(&upper, context);
                let known =
                    self.detections.iter().any(|other| other.position.distance(detection.position) < 0.5);
                if !known {
                    let surroundings = Surroundings::PART;
                    self.propose(DetectionOf { surroundings, ..detection }, index, &upper, context);
                }
            }
        }
        self.describe_candidates(sweep, context);
    }
}

/// What of the obstacles of a column stands out above desks.
fn find_upper_obstacles<P: Profile>(
    (column, before): (&SweepColumnOf<P>, u16),
    profile: &RingProfile,
    obstacles: &mut Obstacles,
) {
    for ring in rings_of(before) {
        let (Some(raw), Some((along, rise, height_m)), Some(count)) =
            (column.range_raw.get(ring), profile.get(ring), obstacles.counts.get_mut(ring))
        else {
            continue;
        };
        let raw = f32::from(*raw);
        let (distance_m, height_m) = (raw * along, raw * rise + height_m);
        if height_m >= UPPER_BODY_M && distance_m < UPPER_BODY_RANGE_M {
            *count = in_counts(distance_m);
            obstacles.present |= 1_u16.wrapping_shl(truncating_u32(ring));
        }
    }
}
