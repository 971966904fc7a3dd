//! Upper bodies: regions → crops at three sizes → heads → silhouette → one detection each.

use super::contour::heads;
use super::crop::{Crop, CropPlace};
use super::detection::{RgbdCounters, RgbdDetection, RgbdKind, turned_covariance};
use super::floor_frame::{CameraMount, FloorFrame};
use super::matching::{Fit, best_fit};
use super::parameters::RgbdParameters;
use super::regions::{Region, Regions};
use super::silhouette::{SILHOUETTE_SIDE, Silhouette};
use super::suppression::{Candidates, insert, is_same};
use crate::sensing::DepthImage;

/// From the surface that the camera sees to the middle of a body, metres.
const HALF_BODY_M: f32 = 0.12;
/// What a body's depth and pose add to the place, standard deviation along and across the view, metres.
const POSE_M: [f32; 2] = [0.07, 0.05];
/// Bodies for which the size of the silhouette is drawn, metres.
const BODY_M: [f32; 2] = [1.1, 1.95];
/// Fewest pixels of a region, of those that are looked at.
const PIXELS_MIN: u32 = 60;

/// Working memory of the search.
#[derive(Clone, Debug, Default)]
pub(super) struct UpperBodies {
    silhouette: Silhouette,
    crop: Crop,
    candidates: Candidates,
}

/// One picture with everything that places it.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub image: DepthImage<'a>,
    pub frame: FloorFrame,
    pub mount: CameraMount,
    pub parameters: RgbdParameters,
}

impl UpperBodies {
    /// Finds the people of all regions; best first.
    pub(super) fn find(
        &mut self,
        scene: &Scene<'_>,
        regions: &Regions,
        counters: &mut RgbdCounters,
    ) -> &[RgbdDetection] {
        self.candidates.clear();
        let rules = scene.parameters.upper_body;
        let [top_min, top_max] = rules.top_m;
        for region in &regions.found {
            counters.regions = counters.regions.saturating_add(1);
            if region.pixels < PIXELS_MIN {
                counters.out_of_view = counters.out_of_view.saturating_add(1);
            } else if !(region.top_m > top_min && region.top_m < rules.structure_m + 0.05) {
                counters.wrong_top = counters.wrong_top.saturating_add(1);
            } else {
                let body_m = region.top_m.clamp(BODY_M[0], BODY_M[1].min(top_max));
                for scale in rules.scales {
                    self.search(scene, (region, regions), body_m * scale, counters);
                }
            }
        }
        self.suppress(rules.overlap_max, counters);
        &self.candidates
    }

    /// Tries all heads of one region at one size.
    fn search(
        &mut self,
        scene: &Scene<'_>,
        (region, regions): (&Region, &Regions),
        body_m: f32,
        counters: &mut RgbdCounters,
    ) {
        let rules = scene.parameters.upper_body;
        let Some(place) = CropPlace::around(region, &scene.frame, body_m) else {
            counters.out_of_view = counters.out_of_view.saturating_add(1);
            return;
        };
        self.crop.fill(&place, (&scene.image, &scene.frame), (region, regions), &rules);
        for head in heads(&self.crop, place.size, &mut counters.dropped) {
            counters.heads = counters.heads.saturating_add(1);
            let Some(fit) = best_fit(&self.crop, &self.silhouette, head) else {
                counters.unseen = counters.unseen.saturating_add(1);
                continue;
            };
            let detection = detection(scene, &place, &fit, self.silhouette.head_row());
            let [top_min, top_max] = rules.top_m;
            if fit.score >= rules.score_max || !(detection.top_m > top_min && detection.top_m < top_max) {
                counters.no_silhouette = counters.no_silhouette.saturating_add(1);
            } else if insert(&mut self.candidates, detection) {
                counters.dropped = counters.dropped.saturating_add(1);
            }
        }
    }

    /// Keeps the best of everybody; the list is sorted by score.
    fn suppress(&mut self, overlap_max: f32, counters: &mut RgbdCounters) {
        let mut kept = Candidates::new();
        for candidate in &self.candidates {
            if kept.iter().any(|better| is_same(better, candidate, overlap_max)) {
                counters.suppressed = counters.suppressed.saturating_add(1);
            } else if kept.push(*candidate).is_err() {
                counters.dropped = counters.dropped.saturating_add(1);
            }
        }
        self.candidates = kept;
    }
}

/// Place, doubt and belief of a fit; the head begins in row `head_row` of the silhouette.
fn detection(scene: &Scene<'_>, place: &CropPlace, fit: &Fit, head_row: f32) -> RgbdDetection {
    let rules = scene.parameters.upper_body;
    let side = SILHOUETTE_SIDE as f32;
    let (column, row) = (f32::from(fit.corner.0), f32::from(fit.corner.1));
    let [left, top] = place.pixel(column, row);
    let [right, bottom] = place.pixel(column + side, row + side);
    let [middle, head] = place.pixel(column + 0.5 * side, row + head_row);
    let mut foot = scene.frame.point(middle, 0.5 * (top + bottom), fit.depth_m);
    let range_m = foot.range_m().max(0.1);
    // The middle of the body lies behind its surface, farther along the line of sight.
    let farther = 1.0 + HALF_BODY_M / range_m;
    foot.right_m *= farther;
    foot.ahead_m *= farther;
    let top_m = scene.frame.point(middle, head, fit.depth_m).height_m;
    let [fx, _] = scene.frame.camera().focal_px();
    let [pose_along, pose_across] = POSE_M;
    // The silhouette is placed to a pixel of the crop.
    let step_m = place.ratio * fit.depth_m / fx;
    let along_m2 = scene.parameters.noise.variance_m2(fit.depth_m) + pose_along * pose_along;
    let across_m2 = step_m * step_m + pose_across * pose_across;
    let bearing = libm::atan2f(-foot.right_m, foot.ahead_m) + scene.mount.heading_rad;
    let [even, width] = rules.score_even;
    let pixel = |value: f32| value.clamp(0.0, f32::from(u16::MAX)) as u16;
    RgbdDetection {
        kind: RgbdKind::UpperBody,
        position_in_base: foot.in_base(scene.mount),
        covariance_m2: turned_covariance(along_m2, across_m2, bearing),
        distance_m: foot.range_m(),
        top_m,
        confidence: 1.0 / (1.0 + libm::expf((fit.score - even) / width.max(1.0e-3))),
        score: fit.score,
        seen_share: fit.seen_share,
        first_px: [pixel(left), pixel(top)],
        last_px: [pixel(right), pixel(bottom)],
    }
}
