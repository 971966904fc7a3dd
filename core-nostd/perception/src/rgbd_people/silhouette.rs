//! The silhouette of head and shoulders: a parametric model of ours, in shares of the body's height.
//!
//! An ellipse for the head, a neck, and shoulders that round off into a torso, drawn from anthropometric proportions into
//! a square of one third of the body's height (the size of the published template). Depth is relative to the torso's
//! surface: a body is rounder than a board.

use floorguard_types::number::nearest_f32;

/// Pixels along each side of the silhouette.
pub const SILHOUETTE_SIDE: usize = 30;

/// Proportions of a body, in parts of its height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SilhouetteShape {
    /// Side of the square.
    pub side: f32,
    /// From the upper side of the square to the top of the head.
    pub above_head: f32,
    /// Half of the head's width and height.
    pub head: [f32; 2],
    /// Half of the neck's width.
    pub neck: f32,
    /// From the top of the head to the top of the shoulders.
    pub shoulder_drop: f32,
    /// Half of the width over the shoulders.
    pub shoulders: f32,
    /// From the top of the shoulders to where they have their whole width.
    pub slope: f32,
    /// Half of the depth of the torso.
    pub torso_depth: f32,
}

impl SilhouetteShape {
    /// An adult from the front: head with hair 11 × 13 % of the height, shoulders 27 % wide (Drillis and Contini 1966, with
    /// a centimetre of cloth on each side).
    pub const ADULT_FRONT: Self = Self {
        side: 1.0 / 3.0,
        above_head: 0.058,
        head: [0.055, 0.065],
        neck: 0.038,
        shoulder_drop: 0.148,
        shoulders: 0.135,
        slope: 0.08,
        torso_depth: 0.07,
    };
    /// An adult from the side: the chest is 16 to 18 % deep.
    pub const ADULT_SIDE: Self = Self { shoulders: 0.088, torso_depth: 0.12, ..Self::ADULT_FRONT };
    /// A child from the front: the head is hardly smaller than an adult's, the rest is.
    pub const CHILD_FRONT: Self =
        Self { head: [0.085, 0.095], neck: 0.05, shoulder_drop: 0.185, ..Self::ADULT_FRONT };
    /// A child from the side.
    pub const CHILD_SIDE: Self = Self { shoulders: 0.1, torso_depth: 0.12, ..Self::CHILD_FRONT };

    /// Half of the width of the body at a distance below the top of the head, in parts of the height; 0 above it.
    fn half_width(&self, below_top: f32) -> f32 {
        let [head_width, head_height] = self.head;
        let from_middle = (below_top - head_height) / head_height;
        let head = if from_middle.abs() < 1.0 {
            head_width * libm::sqrtf(1.0 - from_middle * from_middle)
        } else {
            0.0
        };
        let neck =
            if (head_height..self.shoulder_drop + self.slope).contains(&below_top) { self.neck } else { 0.0 };
        // A quarter of an ellipse from the neck to the outer end of the shoulder.
        let down = ((below_top - self.shoulder_drop) / self.slope).clamp(0.0, 1.0);
        let shoulders = self.shoulders * libm::sqrtf(1.0 - (1.0 - down) * (1.0 - down));
        head.max(neck).max(shoulders)
    }
}

/// What a pixel of the silhouette stands for. Each area counts as a whole, so that a box, which is right in most pixels,
/// cannot make up for the head that it does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    /// Head and neck.
    Head,
    /// Shoulders and chest.
    Torso,
    /// Left of the head and above its left half, over the shoulder: nothing of the body is here.
    LeftOfHead,
    /// The same on the right.
    RightOfHead,
    /// Beside the shoulders.
    BesideTorso,
}

/// Areas.
pub const AREAS: usize = 5;

impl Area {
    /// Its place in lists.
    pub(super) const fn index(self) -> usize {
        match self {
            Self::Head => 0,
            Self::Torso => 1,
            Self::LeftOfHead => 2,
            Self::RightOfHead => 3,
            Self::BesideTorso => 4,
        }
    }
}

/// One pixel of the silhouette.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SilhouettePixel {
    /// Depth relative to the middle of the torso; 0 beside the body.
    pub depth: f32,
    /// What it stands for.
    pub area: Area,
}

/// The silhouette as the matcher uses it.
#[derive(Clone, Debug, PartialEq)]
pub struct Silhouette {
    rows: [[SilhouettePixel; SILHOUETTE_SIDE]; SILHOUETTE_SIDE],
    sizes: [u32; AREAS],
    head_row: f32,
}

/// Distance at which the roundness of the body is drawn, in parts of the body's height: about 3 m.
const DISTANCE: f32 = 1.8;

impl Silhouette {
    /// Draws a shape.
    #[must_use]
    pub fn new(shape: &SilhouetteShape) -> Self {
        let nothing = SilhouettePixel { depth: 0.0, area: Area::BesideTorso };
        let mut rows = [[nothing; SILHOUETTE_SIDE]; SILHOUETTE_SIDE];
        let (mut sizes, pixel) = ([0_u32; AREAS], shape.side / nearest_f32(SILHOUETTE_SIDE));
        for (row, values) in rows.iter_mut().enumerate() {
            let below_top = (nearest_f32(row) + 0.5) * pixel - shape.above_head;
            let half = shape.half_width(below_top);
            for (column, value) in values.iter_mut().enumerate() {
                let beside = ((nearest_f32(column) + 0.5 - 0.5 * nearest_f32(SILHOUETTE_SIDE)) * pixel).abs();
                let is_body = beside < half;
                let above_shoulders = below_top < shape.shoulder_drop;
                if is_body {
                    let round = 1.0 - libm::sqrtf(1.0 - (beside / half) * (beside / half));
                    value.depth = 1.0 + round * shape.torso_depth / DISTANCE;
                }
                let is_left = column < SILHOUETTE_SIDE / 2;
                value.area = match (is_body, above_shoulders && beside < shape.shoulders, is_left) {
                    (true, _, _) if above_shoulders => Area::Head,
                    (true, _, _) => Area::Torso,
                    (false, true, true) => Area::LeftOfHead,
                    (false, true, false) => Area::RightOfHead,
                    (false, false, _) => Area::BesideTorso,
                };
                if let Some(size) = sizes.get_mut(value.area.index()) {
                    *size = size.saturating_add(1);
                }
            }
        }
        Self { rows, sizes, head_row: shape.above_head / pixel }
    }

    /// Row by row from the top.
    #[must_use]
    pub const fn rows(&self) -> &[[SilhouettePixel; SILHOUETTE_SIDE]; SILHOUETTE_SIDE] {
        &self.rows
    }

    /// Pixels of each area.
    pub(super) const fn sizes(&self) -> [u32; AREAS] {
        self.sizes
    }

    /// Row in which the head begins.
    #[must_use]
    pub const fn head_row(&self) -> f32 {
        self.head_row
    }
}

impl Default for Silhouette {
    fn default() -> Self {
        Self::new(&SilhouetteShape::ADULT_FRONT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn head_neck_and_shoulders_are_symmetric() {
        let silhouette = Silhouette::default();
        let is_body = |pixel: &SilhouettePixel| pixel.depth > 0.0;
        let widths = silhouette.rows().map(|row| row.iter().filter(|pixel| is_body(pixel)).count());
        let head = *widths[5..16].iter().max().unwrap();
        let neck = *widths[15..18].iter().min().unwrap();
        assert_eq!(widths[..5], [0; 5]);
        assert!(neck < head && head * 2 < widths[29], "{widths:?}");
        assert!(widths[18..].windows(2).all(|pair| pair[0] <= pair[1]), "{widths:?}");
        for row in silhouette.rows() {
            let mut mirrored = *row;
            mirrored.reverse();
            assert!(row.iter().zip(mirrored).all(|(a, b)| (a.depth - b.depth).abs() < 1e-6));
        }
        let [head, torso, left, right, _] = silhouette.sizes();
        assert!(head > 60 && left > 60 && left == right, "{head} {left} {right}");
        let share = (head + torso) as f32 / 900.0;
        assert!((0.35..0.55).contains(&share), "{share}");
    }
}
