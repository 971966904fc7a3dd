//! What a committee decides by: the shape of a segment, and what earlier scans showed at its place.

use super::features::{LEG_FEATURES, LegFeatures};

/// What earlier scans showed where a segment is now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaceEvidence {
    /// Share of the observations that had a return there, 0…1; mean of the segment's returns.
    pub stood: f32,
    /// Share of the observations that went through it, 0…1.
    pub seen_through: f32,
    /// Observations of it, 0…30.
    pub observations: f32,
}

/// Numbers of the vector: those of the shape, then three of the place.
pub const LEG_CUES: usize = LEG_FEATURES + 3;
/// The vector.
pub type LegCues = [f32; LEG_CUES];

/// Joins shape and place; the three numbers of a place of which nothing is known are 0.
#[must_use]
pub fn leg_cues(shape: &LegFeatures, place: Option<PlaceEvidence>) -> LegCues {
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = *shape;
    let PlaceEvidence { stood, seen_through, observations } = place.unwrap_or_default();
    [a, b, c, d, e, f, g, h, i, j, k, l, m, n, stood, seen_through, observations]
}
