//! Eigenvalues of a symmetric 3 × 3 matrix, in closed form: no iteration, no vectors.

use core::f64::consts::PI;

/// Eigenvalues of `[xx, xy, xz, yy, yz, zz]`, descending. Trigonometric solution of the characteristic cubic of the
/// matrix with its mean removed (Smith 1961). Double precision, because the smallest of three very different
/// values is a difference.
///
/// ```
/// use floorguard_perception::people::classify::eigenvalues3;
///
/// // The scatter of a flat object that is long along x, and of a ball.
/// let [first, second, third] = eigenvalues3([3.0, 0.0, 0.0, 1.0, 0.0, 0.5]);
/// assert!((first - 3.0).abs() + (second - 1.0).abs() + (third - 0.5).abs() < 1.0e-9);
/// assert_eq!(eigenvalues3([2.0, 0.0, 0.0, 2.0, 0.0, 2.0]), [2.0; 3]);
/// ```
#[must_use]
pub fn eigenvalues3([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [f64; 3] {
    let mean = (xx + yy + zz) / 3.0;
    let off = xy * xy + xz * xz + yz * yz;
    let (dx, dy, dz) = (xx - mean, yy - mean, zz - mean);
    let spread = (dx * dx + dy * dy + dz * dz + 2.0 * off) / 6.0;
    // Also catches a NaN.
    if !(spread > 0.0 && spread.is_finite()) {
        return [mean; 3];
    }
    let scale = libm::sqrt(spread);
    let determinant = dx * (dy * dz - yz * yz) - xy * (xy * dz - yz * xz) + xz * (xy * yz - dy * xz);
    let ratio = (determinant / (2.0 * scale * spread)).clamp(-1.0, 1.0);
    let angle = libm::acos(ratio) / 3.0;
    let largest = mean + 2.0 * scale * libm::cos(angle);
    let smallest = mean + 2.0 * scale * libm::cos(angle + 2.0 * PI / 3.0);
    [largest, 3.0 * mean - largest - smallest, smallest]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonals_come_out_sorted() {
        let [a, b, c] = eigenvalues3([1.0, 0.0, 0.0, 5.0, 0.0, 3.0]);
        assert!((a - 5.0).abs() < 1e-12 && (b - 3.0).abs() < 1e-12 && (c - 1.0).abs() < 1e-12);
        assert_eq!(eigenvalues3([0.0; 6]), [0.0; 3]);
        assert_eq!(eigenvalues3([2.0, 0.0, 0.0, 2.0, 0.0, 2.0]), [2.0; 3]);
    }

    proptest::proptest! {
        /// Trace, sum of principal minors and determinant are those of the matrix.
        #[test]
        fn invariants_hold(m in proptest::array::uniform6(-10.0_f64..10.0)) {
            let [xx, xy, xz, yy, yz, zz] = m;
            let [a, b, c] = eigenvalues3(m);
            let minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
            let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
            proptest::prop_assert!(a >= b - 1e-9 && b >= c - 1e-9);
            proptest::prop_assert!((a + b + c - xx - yy - zz).abs() < 1e-9);
            proptest::prop_assert!((a * b + b * c + a * c - minors).abs() < 1e-7);
            proptest::prop_assert!((a * b * c - determinant).abs() < 1e-6);
        }
    }
}
