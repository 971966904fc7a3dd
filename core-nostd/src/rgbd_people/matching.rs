//! How well the silhouette fits at a place of a crop.
//!
//! Source: algorithms B.2 step 9 e to g. Unknown pixels are left out where the silhouette has body, and count as fitting
//! where it has none: what is not seen can neither make a person nor refuse one.

use super::contour::HeadPlace;
use super::crop::{Crop, CropPixel};
use super::silhouette::{SILHOUETTE_SIDE, Silhouette};

/// Body pixels in the middle of the silhouette without which there is nothing to compare with, of 100.
const MIDDLE_MIN: u32 = 40;
/// Part of the silhouette's body that must have a depth.
const SEEN_MIN: f32 = 0.6;
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
    /// Depth of the body, metres.
    pub depth_m: f32,
    /// Column and row of the silhouette's corner in the crop.
    pub corner: (i16, i16),
    /// Part of the silhouette's body with a depth.
    pub seen_share: f32,
}

/// The best fit around a head, or why there is none: nothing to judge.
pub(super) fn best_fit(crop: &Crop, silhouette: &Silhouette, head: HeadPlace) -> Option<Fit> {
    let half = i16::try_from(SILHOUETTE_SIDE / 2).unwrap_or(0);
    let column = i16::try_from(head.0).ok()?.saturating_sub(half);
    let row = i16::try_from(head.1).ok()?.saturating_sub(silhouette.head_row() as i16);
    let coarse = best_of(crop, silhouette, (column, row), (&COARSE_ACROSS, &COARSE_DOWN))?;
    best_of(crop, silhouette, coarse.corner, (&FINE, &FINE)).or(Some(coarse))
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
    let (mut sum, mut count, mut seen) = (0.0_f32, 0_u32, 0_u32);
    for (values, line) in silhouette.rows().iter().zip(crop.window(column, row)) {
        for (value, pixel) in values.iter().zip(line) {
            let is_body = *value > 0.0;
            let difference = match pixel {
                CropPixel::Unknown if is_body => continue,
                CropPixel::Unknown => 0.0,
                CropPixel::Behind => *value,
                CropPixel::Body(depth_mm) => {
                    // Somebody else nearer or farther is no part of this body.
                    let depth = f32::from(*depth_mm);
                    let is_same = (depth - middle_mm).abs() < SAME_BODY_M * 1_000.0;
                    if is_same { *value - depth / middle_mm } else { *value }
                }
            };
            seen = seen.saturating_add(u32::from(is_body));
            count = count.saturating_add(1);
            sum += difference * difference;
        }
    }
    let seen_share = seen as f32 / silhouette.body().max(1) as f32;
    let enough = seen_share >= SEEN_MIN && count > 0;
    enough.then(|| Fit { score: sum / count as f32, depth_m: middle_mm * 0.001, corner, seen_share })
}

/// Depth of the middle block of 10 × 10 pixels: mean, then mean of what is near the mean. The published code takes the
/// median, holes included, and skips whoever has holes there.
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
        (count >= MIDDLE_MIN).then(|| sum / count as f32)
    };
    let mean = mean_near(0.0, f32::INFINITY)?;
    mean_near(mean, SAME_BODY_M * 1_000.0)
}
