//! The second look: all returns of the candidates, for their shapes.

use super::context::SweepContext;
use super::state::PeoplePipelineOf;
use crate::clusters::{ColumnFrame, NONE, SweepFrame, rings_of};
use crate::shapes::person_model::{person_log_odds, probability};
use crate::shapes::waist::has_waist;
use crate::tracking::Surroundings;
use floorguard_types::number::truncating_u32;
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
        let (gap_m, unit_m) = (self.cluster_limits.gap_m, f32::from(sweep.range_unit_mm.max(1)) * 1.0e-3);
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        for (index, column) in sweep.used_columns().iter().enumerate().filter(|(_, column)| column.measured) {
            let Some(labels) = self.clusterer.labels_of(index) else { continue };
            let mut frame: Option<ColumnFrame> = None;
            let mut known = (NONE, None);
            let present = self.clusterer.present_in(index);
            for ring in rings_of(present) {
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
                let above = ring.saturating_add(1);
                if let Some(angle_above) = self.angles.rings.get(above)
                    && present & 1_u16.wrapping_shl(truncating_u32(above)) == 0
                {
                    let raw_above = column.range_raw.get(above).copied().unwrap_or(0);
                    let goes_on =
                        is_same_surface([*raw, raw_above], [angle.1, angle_above.1], gap_m / unit_m);
                    self.candidate_shapes.add_top(slot, point.z_m, goes_on);
                }
            }
        }
        let detections = &mut self.detections;
        let sensor_m = context.sensor_in_base.translation.z_m;
        self.candidate_shapes.finish(|found| {
            if let Some(detection) = detections.get_mut(found.slot) {
                detection.likeness = probability(person_log_odds(found.shape));
                detection.appearance = { found.shades }
                    .appearance((found.top_m, found.is_occluded), (sensor_m, detection.distance_m));
                if has_waist(found.shape, found.is_occluded) {
                    detection.surroundings = detection.surroundings.and(Surroundings::WAIST);
                }
                if found.goes_on_above {
                    detection.surroundings = detection.surroundings.and(Surroundings::ABOVE);
                }
            }
        });
    }
}

/// Two returns of neighbouring rings, of which the upper one is no obstacle because it is too high: at about the same
/// distance they are one surface. Counts of range, and the cosines of the elevations.
fn is_same_surface([lower, upper]: [u16; 2], [lower_cos, upper_cos]: [f32; 2], gap: f32) -> bool {
    upper != 0 && (f32::from(lower) * lower_cos - f32::from(upper) * upper_cos).abs() <= gap
}

#[cfg(test)]
mod tests {
    use super::super::vlp16_tests::{SENSOR_M, seen};
    use super::*;

    /// Where the object stands, and the wall behind it.
    const OBJECT_M: f32 = 6.0;
    const WALL_M: f32 = 6.35;

    /// What surrounds an object 0.45 m broad that is so high, 0.35 m before a wall that is higher than any lidar sees.
    fn surroundings(height_m: f32) -> std::vec::Vec<Surroundings> {
        let (pipeline, _) = seen(|bearing, elevation| {
            let left_m = OBJECT_M * libm::tanf(bearing);
            let at_object_m = SENSOR_M + OBJECT_M / libm::cosf(bearing) * libm::tanf(elevation);
            let is_object = left_m.abs() < 0.225 && at_object_m < height_m;
            let distance_m = if is_object { OBJECT_M } else { WALL_M } / libm::cosf(bearing);
            let above_floor_m = SENSOR_M + distance_m * libm::tanf(elevation);
            if above_floor_m > 0.0 { distance_m / libm::cosf(elevation) } else { 0.0 }
        });
        pipeline.detections().iter().map(|detection| detection.surroundings).collect()
    }

    #[test]
    fn pillar_goes_on_above_person_before_wall_ends() {
        assert_eq!(surroundings(3.0), [Surroundings::ABOVE]);
        for height_m in [1.2, 1.6, 1.8, 1.95] {
            assert_eq!(surroundings(height_m), [Surroundings::OPEN], "{height_m} m tall");
        }
    }
}
