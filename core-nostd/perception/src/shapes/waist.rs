//! Shapes that no body has: between two broad parts a narrower one than any neck, as of a tripod with an instrument on it.

use super::shape::ShapeVector;

/// The narrowest part is at most so broad, metres, a beam's breadth included. A neck has 0.11 m, and the slice of 0.3 m that it lies
/// in has the shoulders or the face of its owner, too.
const NARROW_MAX_M: f32 = 0.15;
/// The parts above and below are at least so broad, metres, and by so much broader.
const BROAD_MIN_M: f32 = 0.2;
const BROADER: f32 = 1.5;
/// The lowest slice that may be the narrow one: legs are narrow between foot and hip when seen from the side.
const LOWEST: usize = 3;
/// Slices of the vector.
const SLICES: usize = 6;

/// Between two broad slices lies a narrow one, above the hip. What nearer objects hide in part has no such shape of its own.
pub(crate) fn has_waist(shape: &ShapeVector, is_occluded: bool) -> bool {
    let widths = shape.get(LOWEST - 1..SLICES).unwrap_or_default();
    let is_waist = |three: &[f32]| match three {
        // A slice without returns is called -1.
        [below, narrow, above] => {
            let broad_m = below.min(*above);
            *narrow > 0.0 && *narrow <= NARROW_MAX_M && broad_m >= BROAD_MIN_M && broad_m >= BROADER * narrow
        }
        _ => false,
    };
    !is_occluded && widths.windows(3).any(is_waist)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::shape::SHAPE_FEATURES;

    fn shape(widths: [f32; 6]) -> ShapeVector {
        let mut shape = [0.0; SHAPE_FEATURES];
        shape[..6].copy_from_slice(&widths);
        shape
    }

    /// Widths of foot, knee, hip, belly, chest and head: two tripods of a recorded hall, then people.
    #[test]
    fn tripods_have_waists_and_people_have_none() {
        assert!(has_waist(&shape([-1.0, 0.51, 0.46, 0.28, 0.14, 0.29]), false));
        assert!(has_waist(&shape([-1.0, -1.0, -1.0, 0.26, 0.06, 0.24]), false));
        for (who, widths) in [
            ("from the front", [0.32, 0.30, 0.40, 0.44, 0.46, 0.19]),
            ("from the side", [0.28, 0.13, 0.22, 0.24, 0.25, 0.20]),
            ("small, with a broad hat", [0.30, 0.28, 0.36, 0.40, 0.18, 0.30]),
            ("a leg that hides the other", [0.28, 0.12, 0.30, 0.36, 0.42, 0.18]),
            ("a child", [0.22, 0.20, 0.26, 0.15, -1.0, -1.0]),
        ] {
            assert!(!has_waist(&shape(widths), false), "{who}");
        }
        assert!(!has_waist(&shape([-1.0, 0.51, 0.46, 0.28, 0.14, 0.29]), true), "partly hidden");
    }
}
