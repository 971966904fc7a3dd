//! Reduced images of the floor: means of squares of pixels, with how much of each square is free floor.
//!
//! Two sizes are in use: half, where a pixel is the mean of four and its noise half, and quarter, where whatever is
//! smaller than a centimetre has become texture. A box filter is a sum over rows and then over columns, of values times
//! weights, so that what is no floor never leaks in.

use super::lab::LabTables;
use floorguard_types::capacities::FLOOR_IMAGE_COLUMNS_MAX;
use floorguard_types::number::{nearest_f32, truncating_u8};
use floorguard_types::sensing::ColorImage;

/// Columns of an image of half size.
pub(super) const HALF_COLUMNS_MAX: usize = FLOOR_IMAGE_COLUMNS_MAX / 2;
/// The widest reach of a box filter.
const REACH_MAX: usize = 2;

/// Three values, and the weight 0..=1 with which they count: 0 is no floor.
pub type Pixel = [f32; 4];

/// Lab at half size from squares of 2 × 2; of weight 0 where one of the four is no free floor.
pub(super) fn shrink(tables: &LabTables, (image, usable): (&ColorImage<'_>, &[bool]), half: &mut [Pixel]) {
    let width = image.width().max(1);
    let columns = width / 2;
    let pairs = image.pixels().chunks_exact(width.saturating_mul(2));
    let masks = usable.chunks_exact(width.saturating_mul(2));
    for ((pixels, mask), row) in pairs.zip(masks).zip(half.chunks_mut(columns.max(1))) {
        let ((upper, lower), (free_upper, free_lower)) = (pixels.split_at(width), mask.split_at(width));
        let quads = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        let frees = free_upper.as_chunks::<2>().0.iter().zip(free_lower.as_chunks::<2>().0);
        for (((upper, lower), (free_upper, free_lower)), slot) in quads.zip(frees).zip(row) {
            let ([[ar, ag, ab], [br, bg, bb]], [[cr, cg, cb], [dr, dg, db]]) = (*upper, *lower);
            // Four bytes and two for rounding fit 16 bits; a quarter of them fits a byte.
            let mean = |[a, b, c, d]: [u8; 4]| {
                let [a, b, c, d] = [u16::from(a), u16::from(b), u16::from(c), u16::from(d)];
                truncating_u8(a.wrapping_add(b).wrapping_add(c).wrapping_add(d).wrapping_add(2) >> 2)
            };
            let is_free = free_upper == &[true; 2] && free_lower == &[true; 2];
            let [l, a, b] =
                tables.lab([mean([ar, br, cr, dr]), mean([ag, bg, cg, dg]), mean([ab, bb, cb, db])]);
            *slot = [l, a, b, if is_free { 1.0 } else { 0.0 }];
        }
    }
}

/// Weighted means of squares of 2 × 2; the weight is that of the four together, 0..=1.
pub(super) fn halve(pixels: &[Pixel], columns: usize, output: &mut [Pixel]) {
    let columns = columns.max(1);
    let pairs = pixels.chunks_exact(columns.saturating_mul(2));
    for (pair, row) in pairs.zip(output.chunks_mut((columns / 2).max(1))) {
        let (upper, lower) = pair.split_at(columns.min(pair.len()));
        let quads = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        for (([a, b], [c, d]), slot) in quads.zip(row) {
            let mut sum = [0.0; 4];
            for pixel in [a, b, c, d] {
                add(&mut sum, pixel);
            }
            *slot = mean(sum, 4.0);
        }
    }
}

/// Weighted means of boxes of an odd number of pixels along each side, up to 5. The weight is the part of the box that
/// counts.
pub(super) fn box_mean<const SIDE: usize>(pixels: &[Pixel], columns: usize, output: &mut [Pixel]) {
    let reach = (SIDE / 2).min(REACH_MAX);
    let columns = columns.clamp(1, HALF_COLUMNS_MAX);
    for (row, output) in output.chunks_exact_mut(columns).enumerate() {
        // Beyond both ends stand pixels of weight 0.
        let mut sums = [[0.0_f32; 4]; HALF_COLUMNS_MAX + 2 * REACH_MAX];
        let above = row.min(reach);
        let rows = pixels.chunks_exact(columns).skip(row.saturating_sub(reach));
        for near in rows.take(above.saturating_add(reach).saturating_add(1)) {
            let (_, inner) = sums.split_at_mut(reach);
            for (sum, pixel) in inner.iter_mut().zip(near) {
                add(sum, pixel);
            }
        }
        for (window, slot) in sums.array_windows::<SIDE>().zip(output) {
            let mut total = [0.0; 4];
            for [x, y, z, weight] in window {
                let [tx, ty, tz, total_weight] = &mut total;
                (*tx, *ty, *tz, *total_weight) = (*tx + x, *ty + y, *tz + z, *total_weight + weight);
            }
            *slot = mean(total, nearest_f32(SIDE.saturating_mul(SIDE)));
        }
    }
}

/// The first channel of [`box_mean`] with a reach of one pixel, and NaN where nothing counts: for the last step, whose
/// pixels have one channel only.
pub(super) fn box_mean_of_first(pixels: &[Pixel], columns: usize, output: &mut [f32]) {
    let columns = columns.clamp(1, HALF_COLUMNS_MAX);
    for (row, output) in output.chunks_exact_mut(columns).enumerate() {
        let (mut sums, mut weights) = ([0.0_f32; HALF_COLUMNS_MAX + 2], [0.0_f32; HALF_COLUMNS_MAX + 2]);
        let rows = pixels.chunks_exact(columns).skip(row.saturating_sub(1));
        for near in rows.take(row.min(1).saturating_add(2)) {
            let ([_, sums @ ..], [_, weights @ ..]) = (&mut sums, &mut weights);
            for ((sum, total), [value, .., weight]) in sums.iter_mut().zip(weights).zip(near) {
                *sum += value * weight;
                *total += weight;
            }
        }
        for ((sums, weights), slot) in sums.array_windows::<3>().zip(weights.array_windows::<3>()).zip(output)
        {
            let ([a, b, c], [p, q, r]) = (sums, weights);
            // Zero over zero is NaN.
            *slot = (a + b + c) / (p + q + r);
        }
    }
}

#[inline]
fn add(sum: &mut Pixel, [x, y, z, weight]: &Pixel) {
    let [sx, sy, sz, total] = sum;
    *sx += x * weight;
    *sy += y * weight;
    *sz += z * weight;
    *total += weight;
}

/// The mean of a sum; weight 0 and zeros where nothing counts.
#[inline]
fn mean([x, y, z, weight]: Pixel, full: f32) -> Pixel {
    let inverse = if weight > 0.0 { 1.0 / weight } else { 0.0 };
    [x * inverse, y * inverse, z * inverse, weight / full]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_weighted_means() {
        let mut random = floorguard_types::random::Pcg32::new(2, 2);
        let (columns, rows) = (7_usize, 6_usize);
        let pixels: std::vec::Vec<Pixel> = (0..columns * rows)
            .map(|_| [random.normal(), random.normal(), random.normal(), f32::from(random.below(3) > 0)])
            .collect();
        let mut output = std::vec![[9.0; 4]; columns * rows];
        box_mean::<5>(&pixels, columns, &mut output);
        for (index, found) in output.iter().enumerate() {
            let near = pixels.iter().enumerate().filter(|(other, _)| {
                (other % columns).abs_diff(index % columns) <= 2
                    && (other / columns).abs_diff(index / columns) <= 2
            });
            let (sum, weight) = near
                .fold((0.0, 0.0), |(sum, weight), (_, pixel)| (sum + pixel[1] * pixel[3], weight + pixel[3]));
            assert!((found[1] - sum / weight).abs() < 1e-5 && (found[3] - weight / 25.0).abs() < 1e-6);
        }
        let (mut ones, mut firsts) = (std::vec![[9.0; 4]; columns * rows], std::vec![9.0; columns * rows]);
        box_mean::<3>(&pixels, columns, &mut ones);
        box_mean_of_first(&pixels, columns, &mut firsts);
        for ([mean, .., weight], found) in ones.iter().zip(firsts) {
            assert!((mean - found).abs() < 1e-6 || (*weight == 0.0 && found.is_nan()), "{mean} {found}");
        }
        let mut halved = std::vec![[9.0; 4]; 3 * 3];
        halve(&pixels, columns - 1, &mut halved);
        assert!(halved.iter().all(|pixel| (0.0..=1.0).contains(&pixel[3])));
    }
}
