//! How well the silhouette fits at a place of a crop.
//!
//! Source: book, Depth people: Matching. Unknown pixels are left out where the silhouette has body, and count as
//! fitting where it has none: what is not seen can neither make a person nor refuse one.

use super::contour::HeadPlace;
use super::crop::{Crop, CropPixel};
use super::silhouette::{AREAS, Area, SILHOUETTE_SIDE, Silhouette};
use floorguard_types::number::{nearest_f32, saturating_i16};

/// Body pixels in the middle of the silhouette without which there is nothing to compare with, of 100.
const MIDDLE_MIN: u32 = 40;
/// Parts of the silhouette's head and torso that must have a depth.
const SEEN_MIN: [f32; 2] = [0.6, 0.5];
/// Part of each side of the head that must lie in the picture.
const INSIDE_MIN: f32 = 0.5;
/// How much head, torso, the worse and the better side of the head and the sides of the torso count. In the proportions of
/// a logistic regression over simulated rooms: what tells people from boxes is the room beside the head.
const WEIGHTS: [f32; AREAS] = [0.05, 0.23, 0.43, 0.14, 0.15];
/// Depths farther from the middle than this belong to somebody else, metres.
const SAME_BODY_M: f32 = 0.35;
/// Places around a head that are tried, pixels of the crop: first coarse, then around the best.
const COARSE_ACROSS: [i16; 7] = [0, -3, 3, -6, 6, -9, 9];
const COARSE_DOWN: [i16; 3] = [0, -3, 3];
const FINE: [i16; 3] = [-1, 0, 1];

/// The best place of the silhouette for one head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fit {
    /// Mean squared difference; lower is better.
    pub score: f32,
    /// Mean squared difference of each area.
    pub differences: [f32; AREAS],
    /// Depth of the body, metres.
    pub depth_m: f32,
    /// Column and row of the silhouette's corner in the crop.
    pub corner: (i16, i16),
    /// Part of the silhouette's body with a depth.
    pub seen_share: f32,
}

/// The best fit around a head, coarsely; `None` where there is nothing to judge.
pub(super) fn coarse_fit(crop: &Crop, silhouette: &Silhouette, head: HeadPlace) -> Option<Fit> {
    let half = i16::try_from(SILHOUETTE_SIDE / 2).unwrap_or(0);
    let column = i16::try_from(head.0).ok()?.saturating_sub(half);
    let row = i16::try_from(head.1).ok()?.saturating_sub(saturating_i16(silhouette.head_row()));
    best_of(crop, silhouette, (column, row), (&COARSE_ACROSS, &COARSE_DOWN))
}

/// The best fit around a place of the silhouette.
pub(super) fn fine_fit(crop: &Crop, silhouette: &Silhouette, corner: (i16, i16)) -> Option<Fit> {
    best_of(crop, silhouette, corner, (&FINE, &FINE))
}

fn best_of(
    crop: &Crop,
    silhouette: &Silhouette,
    (column, row): (i16, i16),
    (across, down): (&[i16], &[i16]),
) -> Option<Fit> {
    let mut best: Option<Fit> = None;
    for dx in across {
        for dy in down {
            let corner = (column.saturating_add(*dx), row.saturating_add(*dy));
            if let Some(fit) = fit_at(crop, silhouette, corner)
                && best.is_none_or(|best| fit.score < best.score)
            {
                best = Some(fit);
            }
        }
    }
    best
}

/// The fit at one place; `None` outside of the crop or without enough depth.
fn fit_at(crop: &Crop, silhouette: &Silhouette, corner: (i16, i16)) -> Option<Fit> {
    let column = usize::try_from(corner.0).ok()?;
    let row = usize::try_from(corner.1).ok()?;
    let middle_mm = middle_depth_mm(crop, column, row)?;
    let (mut sums, mut counts) = ([0.0_f32; AREAS], [0_u32; AREAS]);
    for (values, line) in silhouette.rows().iter().zip(crop.window(column, row)) {
        for (value, pixel) in values.iter().zip(line) {
            let is_body = matches!(value.area, Area::Head | Area::Torso);
            let difference = match pixel {
                CropPixel::Outside => continue,
                CropPixel::Unknown if is_body => continue,
                CropPixel::Unknown => 0.0,
                CropPixel::Behind => value.depth,
                CropPixel::Body(depth_mm) => {
                    // Somebody else nearer or farther is no part of this body.
                    let depth = f32::from(*depth_mm);
                    let is_same = (depth - middle_mm).abs() < SAME_BODY_M * 1_000.0;
                    if is_same { value.depth - depth / middle_mm } else { value.depth }
                }
            };
            let area = value.area.index();
            if let (Some(sum), Some(count)) = (sums.get_mut(area), counts.get_mut(area)) {
                *sum += difference * difference;
                *count = count.saturating_add(1);
            }
        }
    }
    let [head, torso, left, right, _] = counts;
    let [head_size, torso_size, side_size, ..] = silhouette.sizes();
    let share = |count: u32, size: u32| nearest_f32(count) / nearest_f32(size.max(1));
    let (head_share, torso_share) = (share(head, head_size), share(torso, torso_size));
    let mut differences = [0.0_f32; AREAS];
    for ((difference, sum), count) in differences.iter_mut().zip(sums).zip(counts) {
        *difference = sum / nearest_f32(count.max(1));
    }
    let [head_wrong, torso_wrong, left_wrong, right_wrong, beside_wrong] = differences;
    let worse_first =
        [head_wrong, torso_wrong, left_wrong.max(right_wrong), left_wrong.min(right_wrong), beside_wrong];
    let score = worse_first.iter().zip(WEIGHTS).map(|(wrong, weight)| wrong * weight).sum();
    // Both sides of the head must lie in the picture: half a head at its border may be anything.
    let inside = share(left.min(right), side_size) >= INSIDE_MIN;
    let enough = inside && head_share >= SEEN_MIN[0] && torso_share >= SEEN_MIN[1];
    enough.then(|| Fit {
        score,
        differences,
        depth_m: middle_mm * 0.001,
        corner,
        seen_share: share(head.saturating_add(torso), head_size.saturating_add(torso_size)),
    })
}

/// Depth of the middle block of 10 × 10 pixels: mean, then mean of what is near the mean. The published code takes the
/// median, holes included, and skips people with holes there.
fn middle_depth_mm(crop: &Crop, column: usize, row: usize) -> Option<f32> {
    let mean_near = |around: f32, within: f32| {
        let (mut sum, mut count) = (0.0_f32, 0_u32);
        for line in crop.window(column.saturating_add(10), row.saturating_add(12)).take(10) {
            for pixel in line.iter().take(10) {
                if let CropPixel::Body(depth_mm) = pixel
                    && (f32::from(*depth_mm) - around).abs() < within
                {
                    sum += f32::from(*depth_mm);
                    count = count.saturating_add(1);
                }
            }
        }
        (count >= MIDDLE_MIN).then(|| sum / nearest_f32(count))
    };
    let mean = mean_near(0.0, f32::INFINITY)?;
    mean_near(mean, SAME_BODY_M * 1_000.0)
}
