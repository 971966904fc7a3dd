//! Where heads may be: the highest places of a region's upper outline.
//!
//! Source: book, Depth people: Head candidates. The opening with a cross is here a rule for the first pixel of a
//! column: it has body below it and beside it.

use heapless::Vec;

use super::crop::{Crop, CropPixel};
use floorguard_types::capacities::{RGBD_CROP_COLUMNS, RGBD_CROP_ROWS, RGBD_HEADS_MAX};
use floorguard_types::number::{nearest_f32, saturating_usize};

/// A head may be here: column and row in the crop.
pub(super) type HeadPlace = (usize, usize);

/// Half of the smoothing kernel: σ = 3 pixels, 7 taps that sum to one.
const KERNEL: [f32; 4] = [0.175_401_2, 0.165_921_6, 0.140_446_3, 0.106_386_8];
/// Heads are not nearer to each other than this, pixels of the crop: a third of a head.
const APART: usize = 4;

/// Local maxima of the outline, from the left; `dropped` counts those beyond the capacity.
pub(super) fn heads(crop: &Crop, size: [usize; 2], dropped: &mut u32) -> Vec<HeadPlace, RGBD_HEADS_MAX> {
    let [columns, rows] = size;
    let mut outline = [0.0_f32; RGBD_CROP_COLUMNS];
    for (column, height) in outline.iter_mut().enumerate().take(columns) {
        let first = (0..rows.min(RGBD_CROP_ROWS)).find(|row| is_solid(crop, column, *row));
        *height = first.map_or(0.0, |row| nearest_f32(rows.saturating_sub(row)));
    }
    let smooth = smoothed(&outline, columns);
    let mut found: Vec<HeadPlace, RGBD_HEADS_MAX> = Vec::new();
    let mut rising_since = 0;
    let mut rises = false;
    for (column, pair) in smooth.windows(2).enumerate().take(columns) {
        let &[here, next] = pair else { continue };
        if next > here + 0.01 {
            rises = true;
            rising_since = column.saturating_add(1);
        } else if next < here - 0.01 && rises {
            rises = false;
            // The middle of a flat top.
            let middle = rising_since.saturating_add(column) / 2;
            let height = smooth.get(middle).copied().unwrap_or(0.0);
            let is_new = found.last().is_none_or(|(last, _)| middle > last.saturating_add(APART));
            let head = (middle, rows.saturating_sub(saturating_usize(height + 0.5)));
            if height > 0.0 && is_new && found.push(head).is_err() {
                *dropped = dropped.saturating_add(1);
            }
        }
    }
    found
}

/// Body with body below and at one side.
fn is_solid(crop: &Crop, column: usize, row: usize) -> bool {
    let is_body = |column: usize, row: usize| matches!(crop.get(column, row), CropPixel::Body(_));
    let left = column.checked_sub(1).is_some_and(|left| is_body(left, row));
    is_body(column, row)
        && is_body(column, row.saturating_add(1))
        && (left || is_body(column.saturating_add(1), row))
}

/// Edges are repeated.
fn smoothed(outline: &[f32; RGBD_CROP_COLUMNS], columns: usize) -> [f32; RGBD_CROP_COLUMNS] {
    let mut smooth = [0.0; RGBD_CROP_COLUMNS];
    let last = columns.saturating_sub(1);
    let at = |column: usize| outline.get(column.min(last)).copied().unwrap_or(0.0);
    for (column, out) in smooth.iter_mut().enumerate().take(columns) {
        for (offset, tap) in KERNEL.iter().enumerate() {
            let both = at(column.saturating_add(offset)) + at(column.saturating_sub(offset));
            *out += if offset == 0 { tap * 0.5 * both } else { tap * both };
        }
    }
    smooth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_sums_to_one() {
        let sum = KERNEL[0] + 2.0 * KERNEL[1..].iter().sum::<f32>();
        assert!((sum - 1.0).abs() < 2e-3, "{sum}");
    }
}
