//! The silhouette of head and shoulders: a parametric model of ours, in shares of the body's height.
//!
//! An ellipse for the head, a neck, and shoulders that round off into a torso, drawn from anthropometric proportions into
//! a square of one third of the body's height (the size that algorithms B.2 uses). Depth is relative to the torso's
//! surface: a body is rounder than a board.

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
    /// A person in everyday clothes: head 9 × 13 % of the height, shoulders 26 % wide (Drillis and Contini 1966, with
    /// 2 cm of cloth on each side).
    pub const PERSON: Self = Self {
        side: 1.0 / 3.0,
        above_head: 0.058,
        head: [0.05, 0.065],
        neck: 0.036,
        shoulder_drop: 0.148,
        shoulders: 0.142,
        slope: 0.09,
        torso_depth: 0.07,
    };

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

/// The silhouette as the matcher uses it: depth relative to the middle of the torso, 0 beside the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Silhouette {
    rows: [[f32; SILHOUETTE_SIDE]; SILHOUETTE_SIDE],
    body: u32,
    head_row: f32,
}

/// Distance at which the roundness of the body is drawn, in parts of the body's height: about 3 m.
const DISTANCE: f32 = 1.8;

impl Silhouette {
    /// Draws a shape.
    #[must_use]
    pub fn new(shape: &SilhouetteShape) -> Self {
        let mut rows = [[0.0; SILHOUETTE_SIDE]; SILHOUETTE_SIDE];
        let (mut body, pixel) = (0_u32, shape.side / SILHOUETTE_SIDE as f32);
        for (row, values) in rows.iter_mut().enumerate() {
            let half = shape.half_width((row as f32 + 0.5) * pixel - shape.above_head);
            for (column, value) in values.iter_mut().enumerate() {
                let beside = (column as f32 + 0.5 - 0.5 * SILHOUETTE_SIDE as f32) * pixel;
                if beside.abs() < half {
                    let round = 1.0 - libm::sqrtf(1.0 - (beside / half) * (beside / half));
                    *value = 1.0 + round * shape.torso_depth / DISTANCE;
                    body = body.saturating_add(1);
                }
            }
        }
        Self { rows, body, head_row: shape.above_head / pixel }
    }

    /// Row by row from the top.
    #[must_use]
    pub const fn rows(&self) -> &[[f32; SILHOUETTE_SIDE]; SILHOUETTE_SIDE] {
        &self.rows
    }

    /// Pixels of the body.
    #[must_use]
    pub const fn body(&self) -> u32 {
        self.body
    }

    /// Row in which the head begins.
    #[must_use]
    pub const fn head_row(&self) -> f32 {
        self.head_row
    }
}

impl Default for Silhouette {
    fn default() -> Self {
        Self::new(&SilhouetteShape::PERSON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_a_neck_and_shoulders_in_mirror_symmetry() {
        let silhouette = Silhouette::default();
        let widths = silhouette.rows().map(|row| row.iter().filter(|value| **value > 0.0).count());
        let head = *widths[5..16].iter().max().unwrap();
        let neck = *widths[15..18].iter().min().unwrap();
        assert_eq!(widths[..5], [0; 5]);
        assert!(neck < head && head * 2 < widths[29], "{widths:?}");
        assert!(widths[18..].windows(2).all(|pair| pair[0] <= pair[1]), "{widths:?}");
        for row in silhouette.rows() {
            let mut mirrored = *row;
            mirrored.reverse();
            assert!(row.iter().zip(mirrored).all(|(a, b)| (a - b).abs() < 1e-6));
        }
        let share = silhouette.body() as f32 / 900.0;
        assert!((0.35..0.55).contains(&share), "{share}");
    }
}
