//! The second look: all returns of the candidates, for their shapes.

use super::context::SweepContext;
use super::state::PeoplePipelineOf;
use crate::clusters::{ColumnFrame, NONE, SweepFrame, rings_of};
use crate::shapes::person_model::{person_log_odds, probability};
use floorguard_types::profile::{Profile, Table};
use floorguard_types::sensing::SweepOf;

impl<P: Profile> PeoplePipelineOf<P> {
    /// Gathers the shape of the new candidates and asks the classifier.
    // Not inlined, here and below: each frame is gone before the next one comes.
    #[inline(never)]
    pub(super) fn describe_candidates(&mut self, sweep: &SweepOf<P>, context: &SweepContext) {
        if !self.candidate_shapes.begin() {
            return;
        }
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        for (index, column) in sweep.used_columns().iter().enumerate().filter(|(_, column)| column.measured) {
            let Some(labels) = self.clusterer.labels_of(index) else { continue };
            let mut frame: Option<ColumnFrame> = None;
            let mut known = (NONE, None);
            for ring in rings_of(self.clusterer.present_in(index)) {
                let (Some(label), Some(raw), Some(angle)) =
                    (labels.get(ring), column.range_raw.get(ring), self.angles.rings.get(ring))
                else {
                    continue;
                };
                // Neighbours mostly belong to the same cluster: it is looked up once.
                if *label != known.0 {
                    let cluster = self.clusterer.cluster_of_label(*label);
                    let slot =
                        cluster.and_then(|cluster| Some((cluster, self.candidate_shapes.slot(cluster)?)));
                    known = (*label, slot);
                }
                let Some((cluster, mut slot)) = known.1 else { continue };
                let point = frame.get_or_insert_with(|| frames.column(column)).point(*raw, *angle);
                if self.splits.is_shared(cluster) {
                    let Some(share) = self.splits.slot(cluster, point) else { continue };
                    slot = share;
                }
                self.candidate_shapes.add(slot, point, (ring, column.reflectivity.get(ring)));
            }
        }
        let detections = &mut self.detections;
        let sensor_m = context.sensor_in_base.translation.z_m;
        self.candidate_shapes.finish(|slot, shape, shades, (top_m, occluded)| {
            if let Some(detection) = detections.get_mut(slot) {
                detection.likeness = probability(person_log_odds(shape));
                detection.appearance = shades.appearance((top_m, occluded), (sensor_m, detection.distance_m));
            }
        });
    }
}
