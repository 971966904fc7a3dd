//! Scaling of features, and how far a vector lies outside of what the model was trained on. Source: book, People:
//! Scaling.

/// Bounds of one training set. Constant tables on the target, read from a libsvm `.range` file on the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling<'a> {
    /// What the smallest training value maps to.
    pub lower: f32,
    /// What the largest training value maps to.
    pub upper: f32,
    /// Smallest and largest training value per dimension.
    pub ranges: &'a [(f32, f32)],
}

/// A scaled vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledFeatures<const DIMENSIONS: usize> {
    /// Values; nothing is clamped.
    pub values: [f32; DIMENSIONS],
    /// Largest magnitude. Above [`Self::EXTRAPOLATING`] the model has never seen anything like it and its probability
    /// must not be trusted.
    pub outlyingness: f32,
}

impl<const DIMENSIONS: usize> ScaledFeatures<DIMENSIONS> {
    /// Limit of [`Self::outlyingness`] (book, People: Scaling).
    pub const EXTRAPOLATING: f32 = 5.0;

    /// The model extrapolates.
    #[must_use]
    pub fn is_out_of_distribution(&self) -> bool {
        self.outlyingness.is_nan() || self.outlyingness > Self::EXTRAPOLATING
    }
}

impl Scaling<'_> {
    /// Scales a vector. Dimensions without a range, or with an empty one, stay as they are.
    #[must_use]
    pub fn apply<const DIMENSIONS: usize>(&self, raw: &[f32; DIMENSIONS]) -> ScaledFeatures<DIMENSIONS> {
        let mut values = *raw;
        for (value, (min, max)) in values.iter_mut().zip(self.ranges) {
            // The bounds of the training set map exactly to the bounds of the scale.
            *value = if min == max {
                *value
            } else if value == min {
                self.lower
            } else if value == max {
                self.upper
            } else {
                self.lower + (self.upper - self.lower) * (*value - min) / (max - min)
            };
        }
        let outlyingness = values.iter().fold(0.0_f32, |most, value| {
            if value.is_finite() { most.max(value.abs()) } else { f32::INFINITY }
        });
        ScaledFeatures { values, outlyingness }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_exact_and_overflow_is_reported() {
        let scaling =
            Scaling { lower: -1.0, upper: 1.0, ranges: &[(3.0, 7_077.0), (0.25, 1_302.49), (2.0, 2.0)] };
        let inside = scaling.apply(&[3.0, 1_302.49, 9.0]);
        assert_eq!(inside.values, [-1.0, 1.0, 9.0]);
        assert!(inside.is_out_of_distribution(), "an unscaled dimension counts too");
        assert!(!scaling.apply(&[100.0, 50.0, 2.0]).is_out_of_distribution());
        assert!(scaling.apply(&[100_000.0, 50.0, 2.0]).is_out_of_distribution());
        assert!(scaling.apply(&[f32::NAN, 50.0, 2.0]).is_out_of_distribution());
    }
}
