//! Upper bodies: regions → crops at three sizes → heads → silhouette → one detection each.

use heapless::Vec;

use super::contour::heads;
use super::crop::{Crop, CropPlace, HEAD_IN_CROP};
use super::detection::{RgbdCounters, RgbdDetection, RgbdKind, turned_covariance};
use super::floor_frame::{CameraMount, FloorFrame};
use super::matching::{Fit, coarse_fit, fine_fit};
use super::parameters::RgbdParameters;
use super::regions::{Region, Regions};
use super::silhouette::{SILHOUETTE_SIDE, Silhouette, SilhouetteShape};
use super::suppression::{Candidates, enlist, is_same};
use floorguard_types::capacities::RGBD_HEADS_MAX;
use floorguard_types::number::{nearest_f32, saturating_u16};
use floorguard_types::sensing::DepthImage;

/// From the surface that the camera sees to the middle of a body, metres.
const HALF_BODY_M: f32 = 0.12;
/// What a body's depth and pose add to the place, standard deviation along and across the view, metres.
const POSE_M: [f32; 2] = [0.07, 0.05];
/// Bodies for which the size of the silhouette is drawn, metres.
const BODY_M: [f32; 2] = [1.1, 1.95];
/// Below this height a body has a child's proportions, metres.
const CHILD_M: f32 = 1.35;
/// Fewest pixels of a region, of those that are examined.
const PIXELS_MIN: u32 = 60;

/// Working memory of the search.
#[derive(Clone, Debug)]
pub(super) struct UpperBodies {
    /// From the front and from the side.
    adults: [Silhouette; 2],
    children: [Silhouette; 2],
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

impl Default for UpperBodies {
    fn default() -> Self {
        let draw = |shapes: [SilhouetteShape; 2]| shapes.map(|shape| Silhouette::new(&shape));
        Self {
            adults: draw([SilhouetteShape::ADULT_FRONT, SilhouetteShape::ADULT_SIDE]),
            children: draw([SilhouetteShape::CHILD_FRONT, SilhouetteShape::CHILD_SIDE]),
            crop: Crop::default(),
            candidates: Candidates::new(),
        }
    }
}

impl UpperBodies {
    /// Finds the people of all regions; best first.
    pub(super) fn search_all(
        &mut self,
        scene: &Scene<'_>,
        regions: &Regions,
        counters: &mut RgbdCounters,
    ) -> &[RgbdDetection] {
        self.candidates.clear();
        let rules = scene.parameters.upper_body;
        let [top_min, _] = rules.top_m;
        for region in &regions.found {
            counters.regions = counters.regions.saturating_add(1);
            if region.pixels < PIXELS_MIN {
                counters.out_of_view = counters.out_of_view.saturating_add(1);
            } else if !(region.top_m > top_min && region.top_m < rules.structure_m + 0.05) {
                counters.wrong_top = counters.wrong_top.saturating_add(1);
            } else {
                self.search(scene, (region, regions), counters);
            }
        }
        self.suppress(rules.overlap_max, counters);
        &self.candidates
    }

    /// Finds the heads in the outline of one region and tries each at its own size.
    fn search(
        &mut self,
        scene: &Scene<'_>,
        (region, regions): (&Region, &Regions),
        counters: &mut RgbdCounters,
    ) {
        let rules = scene.parameters.upper_body;
        let Some(place) = CropPlace::around(region, &scene.frame, body_m(region.top_m)) else {
            counters.out_of_view = counters.out_of_view.saturating_add(1);
            return;
        };
        self.crop.cut(&place, (&scene.image, &scene.frame), (region, regions), &rules);
        let heads = heads(&self.crop, place.size, &mut counters.dropped);
        let mut tops: Vec<([f32; 2], f32), RGBD_HEADS_MAX> = Vec::new();
        for head in &heads {
            let top = place.pixel(nearest_f32(head.0) + 0.5, nearest_f32(head.1));
            match self.crop.head_depth_m(*head) {
                // There are at most as many tops as heads: a push cannot fail.
                Some(depth_m) => drop(tops.push((top, depth_m))),
                None => counters.unseen = counters.unseen.saturating_add(1),
            }
        }
        for top in &tops {
            counters.heads = counters.heads.saturating_add(1);
            match self.try_head(scene, (region, regions), *top) {
                None => counters.unseen = counters.unseen.saturating_add(1),
                Some(detection) => {
                    let [top_min, top_max] = rules.top_m;
                    let stands = detection.top_m > top_min && detection.top_m < top_max;
                    if detection.score >= rules.score_max || !stands {
                        counters.no_silhouette = counters.no_silhouette.saturating_add(1);
                    } else if enlist(&mut self.candidates, detection) {
                        counters.dropped = counters.dropped.saturating_add(1);
                    }
                }
            }
        }
    }

    /// The best fit of the silhouette at one head, over a few sizes around the one that its height suggests.
    fn try_head(
        &mut self,
        scene: &Scene<'_>,
        of: (&Region, &Regions),
        (top, depth_m): ([f32; 2], f32),
    ) -> Option<RgbdDetection> {
        let rules = scene.parameters.upper_body;
        let [u, v] = top;
        let height_m = body_m(scene.frame.point(u, v, depth_m).height_m);
        let place = CropPlace::at_head(top, &scene.frame, (depth_m, height_m))?;
        self.crop.cut(&place, (&scene.image, &scene.frame), of, &rules);
        let silhouettes = if height_m < CHILD_M { &self.children } else { &self.adults };
        let coarse = silhouettes.iter().filter_map(|silhouette| {
            coarse_fit(&self.crop, silhouette, HEAD_IN_CROP).map(|fit| (fit, silhouette))
        });
        let (coarse, silhouette) = coarse.min_by(|(a, _), (b, _)| a.score.total_cmp(&b.score))?;
        let mut best: Option<(Fit, CropPlace)> = None;
        for scale in rules.scales {
            let place = CropPlace::at_head(top, &scene.frame, (depth_m, height_m * scale))?;
            self.crop.cut(&place, (&scene.image, &scene.frame), of, &rules);
            if let Some(fit) = fine_fit(&self.crop, silhouette, coarse.corner)
                && best.is_none_or(|(best, _)| fit.score < best.score)
            {
                best = Some((fit, place));
            }
        }
        best.map(|(fit, place)| detection(scene, &place, &fit, silhouette.head_row()))
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

/// A body's height within what silhouettes are drawn for, metres.
fn body_m(top_m: f32) -> f32 {
    let [least, most] = BODY_M;
    top_m.clamp(least, most)
}

/// Place, doubt and belief of a fit; the head begins in row `head_row` of the silhouette.
fn detection(scene: &Scene<'_>, place: &CropPlace, fit: &Fit, head_row: f32) -> RgbdDetection {
    let rules = scene.parameters.upper_body;
    let side = nearest_f32(SILHOUETTE_SIDE);
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
    let pixel = |value: f32| saturating_u16(value.clamp(0.0, f32::from(u16::MAX)));
    RgbdDetection {
        kind: RgbdKind::UpperBody,
        position_in_base: foot.in_base(scene.mount),
        covariance_m2: turned_covariance(along_m2, across_m2, bearing),
        distance_m: foot.range_m(),
        top_m,
        confidence: 1.0 / (1.0 + libm::expf((fit.score - even) / width.max(1.0e-3))),
        score: fit.score,
        differences: fit.differences,
        seen_share: fit.seen_share,
        first_px: [pixel(left), pixel(top)],
        last_px: [pixel(right), pixel(bottom)],
    }
}
