//! Which objects in the band are shaped like a leg, and the colours of each.
//!
//! Source: book, Depth people: Leg candidates.

use super::band::BandPart;
use super::floor_frame::{FloorFrame, FloorPoint};
use super::parameters::RgbdParameters;
use floorguard_types::number::nearest_f32;
use floorguard_types::sensing::{ColorImage, DepthImage};

/// Colours of the histogram: four steps each of red, green and blue.
pub(super) const COLOURS: usize = 64;
/// Fewest pixels of a leg among those that are examined.
const PIXELS_MIN: u32 = 12;
/// A leg goes on above the band: its visible part ends at most this far below the band's upper border, metres.
const UPPER_GAP_M: f32 = 0.06;
/// Pixels of a leg lie within this of its box, metres.
const BOX_MARGIN_M: f32 = 0.01;

/// An object of the shape of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegCandidate {
    /// Metres to the right of the camera's foot point and ahead of it.
    pub place_m: [f32; 2],
    /// Width along the wider axis of the floor, metres.
    pub width_m: f32,
    /// Heights above the floor of its lowest and highest visible return, metres.
    pub heights_m: [f32; 2],
    /// Mean depth, metres.
    pub depth_m: f32,
    /// Corner of its rectangle in the picture.
    pub first_px: [u16; 2],
    /// Opposite corner, included.
    pub last_px: [u16; 2],
    /// Share of each colour; zero without a colour picture.
    pub(super) colours: [f32; COLOURS],
}

impl LegCandidate {
    /// An object as a leg; `None` where the rules say no. `last_row` is the picture's last row.
    pub(super) fn of(part: &BandPart, parameters: &RgbdParameters, last_row: u16) -> Option<Self> {
        let rules = parameters.legs;
        let ([lr, la, lowest], [hr, ha, highest]) = (part.low_m, part.high_m);
        let [right_sum, ahead_sum, depth_sum] = part.sums_m;
        let count = nearest_f32(part.pixels.max(1));
        let depth_m = depth_sum / count;
        // The extent along the view has the depth's noise in it.
        let spread = 4.0 * libm::sqrtf(parameters.noise.variance_m2(depth_m));
        let (across, along) = (hr - lr, ha - la);
        let [narrow, wide] = rules.width_m;
        let [_, band_top] = rules.band_m;
        let [_, bottom_row] = part.last_px;
        let cut_below = bottom_row.saturating_add(2) >= last_row;
        let fits = across >= narrow && across <= wide && along <= wide + spread;
        let upright = highest - lowest >= across.min(band_top * 0.5);
        let stands = lowest <= rules.foot_max_m || cut_below;
        let goes_on = highest >= band_top - UPPER_GAP_M;
        let is_leg = part.pixels >= PIXELS_MIN && fits && upright && stands && goes_on;
        is_leg.then(|| Self {
            place_m: [right_sum / count, ahead_sum / count],
            width_m: across,
            heights_m: [lowest, highest],
            depth_m,
            first_px: part.first_px,
            last_px: part.last_px,
            colours: [0.0; COLOURS],
        })
    }

    /// Counts the colours of its pixels.
    pub(super) fn colour(
        &mut self,
        (depth, colour): (&DepthImage<'_>, &ColorImage<'_>),
        frame: &FloorFrame,
        part: &BandPart,
    ) {
        let ([left, top], [right, bottom]) = (part.first_px.map(usize::from), part.last_px.map(usize::from));
        let mut count = 0.0_f32;
        let rows = depth.rows().zip(colour.rows()).enumerate().skip(top).take(bottom.saturating_sub(top) + 1);
        for (row, (depths, pixels)) in rows {
            let rays = frame.row(row);
            let line = depths.iter().zip(pixels).enumerate().skip(left).take(right.saturating_sub(left) + 1);
            for (column, (depth, [red, green, blue])) in line {
                let point = rays.point(column, f32::from(*depth) * 0.001);
                if !is_within(&point, part) {
                    continue;
                }
                let bin = usize::from(red / 64) + 4 * usize::from(green / 64) + 16 * usize::from(blue / 64);
                if let Some(share) = self.colours.get_mut(bin) {
                    *share += 1.0;
                    count += 1.0;
                }
            }
        }
        for share in &mut self.colours {
            *share /= count.max(1.0);
        }
    }

    /// Cosine of the angle between two histograms within 0..=1; 1 where neither has a colour, 0 where one has none.
    pub(super) fn likeness(&self, other: &Self) -> f32 {
        let product =
            |a: &[f32; COLOURS], b: &[f32; COLOURS]| -> f32 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (own, others) = (product(&self.colours, &self.colours), product(&other.colours, &other.colours));
        if own <= 0.0 && others <= 0.0 {
            return 1.0;
        }
        let norm = libm::sqrtf(own * others);
        if norm > 0.0 { (product(&self.colours, &other.colours) / norm).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Distance to another one on the floor, metres.
    pub(super) fn distance_m(&self, other: &Self) -> f32 {
        let ([a, b], [c, d]) = (self.place_m, other.place_m);
        libm::hypotf(a - c, b - d)
    }
}

fn is_within(point: &FloorPoint, part: &BandPart) -> bool {
    let place = [point.right_m, point.ahead_m, point.height_m];
    let inside =
        |((value, low), high): ((f32, f32), f32)| (low - BOX_MARGIN_M..=high + BOX_MARGIN_M).contains(&value);
    place.into_iter().zip(part.low_m).zip(part.high_m).all(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leg(colours: &[(usize, f32)]) -> LegCandidate {
        let mut leg = LegCandidate {
            place_m: [0.0; 2],
            width_m: 0.1,
            heights_m: [0.05, 0.4],
            depth_m: 2.0,
            first_px: [0; 2],
            last_px: [0; 2],
            colours: [0.0; COLOURS],
        };
        for (bin, share) in colours {
            leg.colours[*bin] = *share;
        }
        leg
    }

    #[test]
    fn likeness_is_the_cosine_of_the_histograms() {
        let (blue, mixed, none) = (leg(&[(48, 1.0)]), leg(&[(48, 0.6), (0, 0.8)]), leg(&[]));
        assert_eq!(blue.likeness(&blue), 1.0);
        assert!((blue.likeness(&mixed) - 0.6).abs() < 1e-6);
        assert_eq!(blue.likeness(&leg(&[(3, 1.0)])), 0.0);
        assert_eq!(blue.likeness(&none), 0.0);
        assert_eq!(none.likeness(&none), 1.0);
    }
}
