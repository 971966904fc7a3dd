//! How uncertain a depth is, by camera: published models, because no two cameras err alike.
//!
//! The standard deviation grows with the square of the depth; what the camera rounds to is added in quadrature.
//! Source: book, Floor and dirt: Depth noise (Nguyen et al. 2012, Khoshelham and Elberink 2012, Fankhauser et al.
//! 2014).

use super::lanes::Lanes;

/// `σ_z = constant_m + growth_per_m · (z − nearest_m)²`, and steps of `step_per_m · z²`.
///
/// ```
/// use floorguard_perception::floor::DepthNoise;
///
/// // Nguyen et al. 2012: 1.2 mm at 0.4 m, and more with the square of what lies beyond.
/// assert!((DepthNoise::NGUYEN.axial_m(0.4) - 0.001_2).abs() < 1.0e-7);
/// assert!((DepthNoise::NGUYEN.axial_m(1.4) - 0.003_1).abs() < 1.0e-7);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthNoise {
    /// Least standard deviation, metres.
    pub constant_m: f32,
    /// Growth with the square of the depth, 1/m.
    pub growth_per_m: f32,
    /// Depth of the least standard deviation, metres.
    pub nearest_m: f32,
    /// Width of a depth step at 1 m, metres per square metre; 0 for a camera without visible steps.
    pub step_per_m: f32,
}

/// 1/√12: the standard deviation of rounding to a step of one.
const ROUNDING: f32 = 0.288_675_13;

impl DepthNoise {
    /// Kinect class and Xtion (Nguyen et al. 2012; steps of 2.85 mm at 1 m).
    pub const NGUYEN: Self =
        Self { constant_m: 0.001_2, growth_per_m: 0.001_9, nearest_m: 0.4, step_per_m: 0.002_85 };
    /// Kinect class (Khoshelham and Elberink 2012).
    pub const KHOSHELHAM: Self =
        Self { constant_m: 0.0, growth_per_m: 0.001_425, nearest_m: 0.0, step_per_m: 0.002_85 };
    /// Carmine 1.09, 0.2–2 m.
    pub const CARMINE: Self =
        Self { constant_m: 0.000_181, growth_per_m: 0.001_66, nearest_m: 0.1, step_per_m: 0.002_85 };
    /// RealSense D435, 0.2–3.25 m.
    pub const D435: Self =
        Self { constant_m: 0.000_611, growth_per_m: 0.003_587, nearest_m: 0.351_5, step_per_m: 0.0 };
    /// RealSense ZR300.
    pub const ZR300: Self = Self {
        constant_m: 0.002_418_09,
        growth_per_m: 0.006_625_47,
        nearest_m: 0.771_995_9,
        step_per_m: 0.0,
    };

    /// Standard deviation of a depth without the rounding to steps, metres.
    #[inline]
    #[must_use]
    pub fn axial_m(&self, depth_m: f32) -> f32 {
        let beyond = depth_m - self.nearest_m;
        self.constant_m + self.growth_per_m * beyond * beyond
    }

    /// Variance of a depth with the rounding to steps, m².
    #[inline]
    #[must_use]
    pub fn variance_m2(&self, depth_m: f32) -> f32 {
        let axial = self.axial_m(depth_m);
        let rounding = ROUNDING * self.step_per_m * depth_m * depth_m;
        axial * axial + rounding * rounding
    }
}

impl DepthNoise {
    /// [`Self::variance_m2`] of four depths.
    #[inline]
    pub(super) fn variances_m2(&self, depths: Lanes) -> Lanes {
        let beyond = depths + -self.nearest_m;
        let axial = beyond * beyond * self.growth_per_m + self.constant_m;
        let rounding = depths * depths * (ROUNDING * self.step_per_m);
        axial * axial + rounding * rounding
    }
}

impl Default for DepthNoise {
    fn default() -> Self {
        Self::NGUYEN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of the book, Floor and dirt: Depth noise, millimetres.
    #[test]
    fn published_values() {
        let depths = [0.5, 0.8, 1.0, 1.3, 2.0, 3.0];
        let table = [
            (DepthNoise::NGUYEN, [1.22, 1.50, 1.88, 2.74, 6.06, 14.04]),
            (DepthNoise::KHOSHELHAM, [0.36, 0.91, 1.43, 2.41, 5.70, 12.83]),
            (DepthNoise::D435, [0.69, 1.33, 2.12, 3.84, 10.36, 25.77]),
        ];
        for (model, expected_mm) in table {
            for (depth, expected) in depths.into_iter().zip(expected_mm) {
                let found = 1_000.0 * model.axial_m(depth);
                assert!((found - expected).abs() < 0.0051, "{depth} m: {found} mm, not {expected} mm");
            }
        }
    }

    /// "At 1.3 m 4.8 mm": the step of the book, Floor and dirt: Depth noise.
    #[test]
    fn rounding_is_added_in_quadrature() {
        let model = DepthNoise::NGUYEN;
        let step = model.step_per_m * 1.69;
        assert!((step - 0.0048).abs() < 5e-5);
        let added = model.variance_m2(1.3) - model.axial_m(1.3) * model.axial_m(1.3);
        assert!((added - step * step / 12.0).abs() < 1e-8);
    }
}
