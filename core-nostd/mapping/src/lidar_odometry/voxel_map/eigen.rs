//! Eigenvalues and eigenvectors of a symmetric 3×3 matrix by cyclic Jacobi rotations (Golub et al. 2013, section 8.5).

use nalgebra::{Matrix3, Vector3};

/// Rounds over the three pairs of axes; four suffice for single precision.
const ROUNDS: u32 = 6;

/// Ascending eigenvalues and their unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen3 {
    /// Ascending.
    pub values: [f32; 3],
    /// In the order of the values.
    pub vectors: [Vector3<f32>; 3],
}

/// Of the upper triangle xx, xy, xz, yy, yz, zz. Cost: at most 18 rotations.
#[must_use]
pub fn symmetric_eigen([xx, xy, xz, yy, yz, zz]: [f32; 6]) -> Eigen3 {
    let mut m = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let mut v = Matrix3::<f32>::identity();
    let small = 1.0e-12 * m.trace() * m.trace();
    for _ in 0..ROUNDS {
        if m.m12 * m.m12 + m.m13 * m.m13 + m.m23 * m.m23 <= small {
            break;
        }
        let (c, s) = rotation(m.m11, m.m22, m.m12);
        turn(&mut m, &mut v, Matrix3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0));
        let (c, s) = rotation(m.m11, m.m33, m.m13);
        turn(&mut m, &mut v, Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c));
        let (c, s) = rotation(m.m22, m.m33, m.m23);
        turn(&mut m, &mut v, Matrix3::new(1.0, 0.0, 0.0, 0.0, c, s, 0.0, -s, c));
    }
    let column = |i: usize| v.column(i).into_owned();
    let mut pairs = [(m.m11, column(0)), (m.m22, column(1)), (m.m33, column(2))];
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    Eigen3 { values: pairs.map(|pair| pair.0), vectors: pairs.map(|pair| pair.1) }
}

/// Cosine and sine of the rotation that makes the entry `apq` vanish.
fn rotation(app: f32, aqq: f32, apq: f32) -> (f32, f32) {
    if apq == 0.0 {
        return (1.0, 0.0);
    }
    let tau = (aqq - app) / (2.0 * apq);
    let root = libm::sqrtf(1.0 + tau * tau);
    let t = if tau >= 0.0 { 1.0 / (tau + root) } else { 1.0 / (tau - root) };
    let c = 1.0 / libm::sqrtf(1.0 + t * t);
    (c, t * c)
}

fn turn(m: &mut Matrix3<f32>, v: &mut Matrix3<f32>, by: Matrix3<f32>) {
    *m = by.transpose() * *m * by;
    *v *= by;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_solver_of_nalgebra() {
        for seed in 0..50_u16 {
            let part = |k: u16| libm::sinf(f32::from(seed * 7 + k) * 1.7);
            let root = Matrix3::from_fn(|i, j| part((3 * i + j) as u16));
            let m = root * root.transpose();
            let ours = symmetric_eigen([m.m11, m.m12, m.m13, m.m22, m.m23, m.m33]);
            let mut theirs: std::vec::Vec<f32> = m.symmetric_eigen().eigenvalues.iter().copied().collect();
            theirs.sort_by(f32::total_cmp);
            for ((value, vector), other) in ours.values.iter().zip(&ours.vectors).zip(&theirs) {
                assert!((value - other).abs() < 1.0e-4, "{ours:?} {theirs:?}");
                assert!((m * vector - vector * *value).norm() < 1.0e-4);
            }
        }
    }
}
