//! Weighted least squares with three unknowns: sums of a symmetric 3 × 3 system and its solution.

/// The upper triangle of `Σ w a aᵀ` and `Σ w a b`, for rows `a · x ≈ b`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NormalEquations {
    matrix: [f32; 6],
    right: [f32; 3],
}

/// Smallest pivot relative to its diagonal element that still is a system (book, Conventions: Small systems).
const PIVOT_FLOOR: f32 = 1.0e-6;

impl NormalEquations {
    /// Adds one row.
    #[inline]
    pub fn add(&mut self, weight: f32, a: [f32; 3], b: f32) {
        let [x, y, z] = a;
        let (wx, wy, wz) = (weight * x, weight * y, weight * z);
        let products = [wx * x, wx * y, wx * z, wy * y, wy * z, wz * z];
        for (sum, product) in self.matrix.iter_mut().zip(products) {
            *sum += product;
        }
        for (sum, product) in self.right.iter_mut().zip([wx * b, wy * b, wz * b]) {
            *sum += product;
        }
    }

    /// From sums of the upper triangle and of the right side, as [`Self::add`] makes them.
    pub(super) const fn of_sums(matrix: [f32; 6], right: [f32; 3]) -> Self {
        Self { matrix, right }
    }

    /// The solution by `L D Lᵀ`; `None` where the rows do not determine it.
    #[must_use]
    pub fn solve(&self) -> Option<[f32; 3]> {
        let [a, b, c, d, e, f] = self.matrix;
        let [p, q, r] = self.right;
        let usable =
            |pivot: f32, diagonal: f32| pivot.is_finite() && diagonal > 0.0 && pivot > PIVOT_FLOOR * diagonal;
        if !usable(a, a) {
            return None;
        }
        let (l21, l31) = (b / a, c / a);
        let d2 = d - l21 * b;
        if !usable(d2, d) {
            return None;
        }
        let l32 = (e - l21 * c) / d2;
        let d3 = f - l31 * c - l32 * (e - l21 * c);
        if !usable(d3, f) {
            return None;
        }
        let y2 = q - l21 * p;
        let z = (r - l31 * p - l32 * y2) / d3;
        let y = y2 / d2 - l32 * z;
        let x = p / a - l21 * y - l31 * z;
        [x, y, z].iter().all(|value| value.is_finite()).then_some([x, y, z])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovers_the_unknowns_of_an_exact_system() {
        let mut system = NormalEquations::default();
        let truth = [0.3, -1.2, 2.0];
        for step in 0..20_u8 {
            let t = f32::from(step);
            let row = [1.0, t * 0.1, t * t * 0.01];
            system.add(1.0 + t, row, crate::floor::plane::dot(row, truth));
        }
        let found = system.solve().unwrap();
        assert!(found.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}");
    }

    #[test]
    fn rows_along_a_line_determine_nothing() {
        let mut system = NormalEquations::default();
        for step in 0..9_u8 {
            let t = f32::from(step);
            system.add(1.0, [1.0, t, 2.0 * t], t);
        }
        assert_eq!(system.solve(), None);
        assert_eq!(NormalEquations::default().solve(), None);
        system.add(f32::NAN, [1.0, 0.0, 5.0], 1.0);
        assert_eq!(system.solve(), None);
    }
}
