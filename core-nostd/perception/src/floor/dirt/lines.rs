//! Gaps between tiles and planks: thin, long, and darker or lighter than both sides.
//!
//! A thin line vanishes when the image is closed or opened with a rectangle that is wider; a long one changes across and
//! not along, which the smaller eigenvalue of the structure tensor tells. Crumbs are thin too, but change both ways, and
//! so that eigenvalue is the texture by which they are found.

use super::pixels::{HALF_COLUMNS_MAX, Pixel};
use crate::floor::root::{lesser, nearest, square_root};
use floorguard_types::number::{nearest_f32, saturating_u8, truncating_u8};

/// Pixels to each side, and up and down, of the rectangle: 7 × 5 at half size closes gaps of up to 6 pixels across, a
/// centimetre at 1 m, and of up to 4 along the line of sight, where a camera that looks ahead sees a spill foreshortened.
const REACH: [usize; 2] = [3, 2];
/// Half width of the box over which the tensor was averaged, pixels.
const CROSSING: usize = 6;
/// A pixel that is no free floor.
pub(super) const NO_FLOOR: u8 = 0;
/// Free floor.
pub(super) const FLOOR: u8 = 1;
/// A gap.
pub(super) const LINE: u8 = 2;
/// Least contrast of a line, steps of 255: 2.5 Lab units.
const CONTRAST_MIN: f32 = 6.4;
/// A line's change along it is at most this part of that across it.
const ALONG_MAX: f32 = 0.25;
/// Every so many pixels one says what the floor's own grain is.
const SAMPLED: usize = 3;
/// Sobel's operator answers 8 to a slope of 1.
const SOBEL: f32 = 1.0 / 8.0;

/// Eigenvalues of a symmetric matrix `xx, yy, xy`, the larger first.
#[inline]
pub(super) fn eigenvalues([xx, yy, xy, _]: Pixel) -> [f32; 2] {
    let (sum, difference) = (xx + yy, xx - yy);
    let root = square_root(difference * difference + 4.0 * xy * xy);
    [0.5 * (sum + root), (0.5 * (sum - root)).max(0.0)]
}

/// Products of the slopes of lightness, xx, yy, xy, by Sobel's operator; of weight 0 where a neighbour is no floor.
pub(super) fn tensor(half: &[Pixel], columns: usize, output: &mut [Pixel]) {
    let columns = columns.max(1);
    output.fill([0.0; 4]);
    let rows = || half.chunks_exact(columns);
    let triples = rows().zip(rows().skip(1)).zip(rows().skip(2));
    for (((above, own), below), output) in triples.zip(output.chunks_exact_mut(columns).skip(1)) {
        let windows = above.windows(3).zip(own.windows(3)).zip(below.windows(3));
        for (((above, own), below), slot) in windows.zip(output.iter_mut().skip(1)) {
            let ([a, b, c], [d, _, f], [g, h, i]) = (above, own, below) else { continue };
            let [[a, .., wa], [b, .., wb], [c, .., wc], [d, .., wd]] = [a, b, c, d];
            let [[f, .., wf], [g, .., wg], [h, .., wh], [i, .., wi]] = [f, g, h, i];
            let x = SOBEL * (c - a + 2.0 * (f - d) + i - g);
            let y = SOBEL * (g - a + 2.0 * (h - b) + i - c);
            *slot = [x * x, y * y, x * y, wa * wb * wc * wd * wf * wg * wh * wi];
        }
    }
}

/// Images of a byte a pixel at half size: the answer and scratch.
pub(super) struct Bytes<'a> {
    /// What each pixel is.
    pub(super) class: &'a mut [u8],
    pub(super) light: &'a mut [u8],
    pub(super) one: &'a mut [u8],
    pub(super) two: &'a mut [u8],
}

/// Says of each pixel what it is: [`NO_FLOOR`], [`FLOOR`] or [`LINE`]. `tensor` is the structure tensor at quarter
/// size, averaged over boxes.
pub(super) fn classify(half: &[Pixel], columns: usize, tensor: &[Pixel], bytes: &mut Bytes<'_>) {
    let columns = columns.clamp(1, HALF_COLUMNS_MAX);
    let Bytes { class, light, one, two } = bytes;
    lightness(half, columns, light);
    extreme::<true>(light, columns, REACH, (one, two));
    extreme::<false>(two, columns, REACH, (one, class));
    for (closed, own) in class.iter_mut().zip(light.iter()) {
        *closed = closed.saturating_sub(*own);
    }
    extreme::<false>(light, columns, REACH, (one, two));
    // The opened image comes out in `light`'s place: the lightness itself is in `half` still.
    extreme::<true>(two, columns, REACH, (one, light));
    for ((contrast, opened), [own, .., weight]) in class.iter_mut().zip(light.iter()).zip(half) {
        let own = if *weight > 0.0 { byte(*own) } else { *opened };
        *contrast = (*contrast).max(own.saturating_sub(*opened));
    }
    let limit = limit(class);
    let quarter_columns = (columns / 2).max(1);
    let rows = class.chunks_exact(columns).zip(two.chunks_exact_mut(columns));
    for (row, (contrast, marks)) in rows.enumerate() {
        let line = tensor.chunks_exact(quarter_columns).nth(row / 2).unwrap_or(&[]);
        marks.fill(0);
        for (column, (contrast, mark)) in contrast.iter().zip(marks).enumerate() {
            if *contrast > limit {
                let [across, along] = eigenvalues(line.get(column / 2).copied().unwrap_or_default());
                *mark = u8::from(along < ALONG_MAX * across);
            }
        }
    }
    // Where lines cross, the image changes both ways: what stands out that near to a line is of it.
    extreme::<true>(two, columns, [CROSSING; 2], (one, light));
    for ((mark, near), contrast) in two.iter_mut().zip(light.iter()).zip(class.iter()) {
        *mark = u8::from(*near > 0 && *contrast > limit);
    }
    // Blurred edges of a line belong to it.
    extreme::<true>(two, columns, [1; 2], (one, light));
    for ((class, mark), [.., weight]) in class.iter_mut().zip(light.iter()).zip(half) {
        *class = if *weight == 0.0 {
            NO_FLOOR
        } else if *mark > 0 {
            LINE
        } else {
            FLOOR
        };
    }
}

/// Lightness 0…100 in 255 steps.
#[inline]
fn byte(light: f32) -> u8 {
    truncating_u8(nearest(lesser(light * 2.55, 255.0)))
}

/// Lightness as bytes; where no floor is, that of the pixel before, so that the border of the floor is no edge.
fn lightness(half: &[Pixel], columns: usize, light: &mut [u8]) {
    for (row, light) in half.chunks_exact(columns).zip(light.chunks_exact_mut(columns)) {
        row.iter().zip(light.iter_mut()).for_each(|([own, ..], slot)| *slot = byte(*own));
        if row.iter().all(|[.., weight]| *weight > 0.0) {
            continue;
        }
        let mut last = row.iter().find(|[.., weight]| *weight > 0.0).map_or(0, |[light, ..]| byte(*light));
        for ([light, .., weight], slot) in row.iter().zip(light) {
            if *weight > 0.0 {
                last = byte(*light);
            }
            *slot = last;
        }
    }
}

/// Largest or smallest value of the rectangle around each pixel, first across and then down.
fn extreme<const LARGEST: bool>(
    input: &[u8],
    columns: usize,
    [reach_across, reach]: [usize; 2],
    (across, output): (&mut [u8], &mut [u8]),
) {
    let take = |slot: &mut u8, value: &u8| {
        *slot = if LARGEST { (*slot).max(*value) } else { (*slot).min(*value) };
    };
    for (row, slots) in input.chunks_exact(columns).zip(across.chunks_exact_mut(columns)) {
        slots.iter_mut().zip(row).for_each(|(slot, value)| *slot = *value);
        for shift in 1..=reach_across.min(CROSSING) {
            slots.iter_mut().zip(row.iter().skip(shift)).for_each(|(slot, value)| take(slot, value));
            slots.iter_mut().skip(shift).zip(row).for_each(|(slot, value)| take(slot, value));
        }
    }
    for (row, slots) in output.chunks_exact_mut(columns).enumerate() {
        let first = row.saturating_sub(reach);
        let count = row.saturating_sub(first).saturating_add(reach).saturating_add(1);
        slots.fill(if LARGEST { 0 } else { 255 });
        for near in across.chunks_exact(columns).skip(first).take(count) {
            slots.iter_mut().zip(near).for_each(|(slot, value)| take(slot, value));
        }
    }
}

/// The contrast from which on a thin object stands out of the floor's own grain.
fn limit(contrasts: &[u8]) -> u8 {
    let mut counts = [0_u32; 256];
    let mut total = 0_u32;
    for contrast in contrasts.iter().step_by(SAMPLED) {
        if let Some(slot) = counts.get_mut(usize::from(*contrast)) {
            *slot = slot.saturating_add(1);
            total = total.saturating_add(1);
        }
    }
    let mut below = 0_u32;
    let median = counts.iter().position(|count| {
        below = below.saturating_add(*count);
        below > total / 2
    });
    // Three standard deviations of 1.4826 medians each.
    let grain = 4.45 * nearest_f32(median.unwrap_or(0));
    saturating_u8((grain + CONTRAST_MIN).min(255.0))
}

#[cfg(test)]
mod tests {
    use super::super::pixels::{box_mean, halve};
    use super::*;

    /// A gap right through, and a blot and a flat puddle of the same darkness: only the gap is a line.
    #[test]
    fn gaps_are_lines_and_blots_are_not() {
        // 80 columns are the capacity of the smallest profile.
        let (columns, rows) = (80_usize, 64_usize);
        assert!(columns <= HALF_COLUMNS_MAX);
        let gap = |x: usize, _: usize| x.abs_diff(30) < 2;
        let blot = |x: usize, y: usize| x.abs_diff(70) < 6 && y.abs_diff(30) < 6;
        let crumb = |x: usize, y: usize| x.abs_diff(50) < 2 && y.abs_diff(20) < 2;
        // A puddle far ahead: foreshortened, long across and thin along the line of sight.
        let puddle = |x: usize, y: usize| x.abs_diff(55) < 8 && y.abs_diff(46) < 3;
        let half: std::vec::Vec<Pixel> = (0..columns * rows)
            .map(|index| {
                let (x, y) = (index % columns, index / columns);
                let is_dark = gap(x, y) || blot(x, y) || crumb(x, y) || puddle(x, y);
                let light = if is_dark { 30.0 } else { 60.0 };
                [light, 0.0, 0.0, if y < 60 { 1.0 } else { 0.0 }]
            })
            .collect();
        let mut slopes = half.clone();
        tensor(&half, columns, &mut slopes);
        let quarter = columns / 2 * (rows / 2);
        let (mut small, mut smooth) = (std::vec![[0.0; 4]; quarter], std::vec![[0.0; 4]; quarter]);
        halve(&slopes, columns, &mut small);
        box_mean::<5>(&small, columns / 2, &mut smooth);
        let mut images = std::vec![std::vec![0_u8; half.len()]; 4];
        let [class, light, one, two] = &mut images[..] else { panic!("four") };
        classify(&half, columns, &smooth, &mut Bytes { class, light, one, two });
        for (index, class) in images[0].iter().enumerate() {
            let (x, y) = (index % columns, index / columns);
            let expected = match (y < 60, gap(x, y)) {
                (false, _) => NO_FLOOR,
                (true, true) => LINE,
                (true, false) if x.abs_diff(30) < 3 => continue,
                (true, false) => FLOOR,
            };
            assert_eq!(*class, expected, "{x} {y}");
        }
    }
}
