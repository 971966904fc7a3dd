//! Which clusters of a sweep go to the tracker.

use super::context::SweepContext;
use super::state::PeoplePipelineOf;
use crate::clusters::Cluster;
use crate::people::splits::SEEDS_MAX;
use crate::shapes::shape::{Heights, ShapeBuilder};
use crate::tracking::{AppearanceOf, DetectionOf, Surroundings};
use floorguard_types::geometry::Point2;
use floorguard_types::profile::{List, Profile, Size};

/// Measurement noise of a cluster's centre, metres (book, People: Candidates), and its growth per metre of distance.
const SIGMA_M: f32 = 0.1;
const SIGMA_PER_M: f32 = 0.004;
/// The middle of what is left of somebody half hidden is not the middle of the body, and wanders with what hides it.
const OCCLUDED: f32 = 1.3;

impl<P: Profile> PeoplePipelineOf<P> {
    #[inline(never)]
    pub(super) fn find_candidates(&mut self, context: &SweepContext) {
        self.detections.clear();
        self.candidate_shapes.clear();
        let sensor_height_m = context.sensor_in_base.translation.z_m;
        for index in 0..self.clusters.len().min(P::Clusters::N) {
            let Some(cluster) = self.clusters.get(index).copied() else { continue };
            if !self.splits.is_shared(index) && self.candidate_limits.admits(&cluster, sensor_height_m) {
                self.propose(detection(&cluster, context), index, &cluster, context);
            }
        }
        for index in 0..SEEDS_MAX {
            let Some((cluster, part)) = self.splits.part(index) else { continue };
            if self.candidate_limits.admits(&part, sensor_height_m) {
                let slot = self.propose(detection(&part, context), cluster, &part, context);
                self.splits.assign(index, slot);
            }
        }
    }

    /// Slot of the new candidate. Full: the farthest candidate is dropped first.
    pub(super) fn propose(
        &mut self,
        detection: DetectionOf<P>,
        index: usize,
        cluster: &Cluster,
        context: &SweepContext,
    ) -> Option<usize> {
        self.counters.candidates = self.counters.candidates.saturating_add(1);
        let mut slot = self.detections.len();
        if slot >= self.tracker.detections_max() || self.detections.push(detection).is_err() {
            self.counters.dropped_candidates = self.counters.dropped_candidates.saturating_add(1);
            let others = self.detections.iter_mut().enumerate();
            let farthest = others.max_by(|(_, a), (_, b)| a.distance_m.total_cmp(&b.distance_m));
            let (row, worse) = farthest.filter(|(_, other)| other.distance_m > detection.distance_m)?;
            *worse = detection;
            slot = row;
        }
        let heights = Heights { bottom_m: cluster.lower.z_m, top_m: cluster.upper.z_m };
        let builder = ShapeBuilder::new(context.sensor_in_base.translation, cluster.centroid, heights);
        self.candidate_shapes.set(slot, index, builder, cluster);
        Some(slot)
    }
}

/// A cluster as a measurement for the tracker; nobody has looked at its shape yet.
pub(super) fn detection<P: Profile>(cluster: &Cluster, context: &SweepContext) -> DetectionOf<P> {
    let centre = Point2::new(cluster.centroid.x_m, cluster.centroid.y_m);
    DetectionOf {
        position: context.base_in_odom.transform(centre),
        distance_m: cluster.nearest_m,
        sigma_m: (SIGMA_M + SIGMA_PER_M * cluster.nearest_m) * if cluster.occluded { OCCLUDED } else { 1.0 },
        likeness: 0.5,
        points: cluster.points,
        moving: None,
        surroundings: Surroundings::OPEN,
        appearance: AppearanceOf::UNKNOWN,
    }
}
