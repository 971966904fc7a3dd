//! First guesses of the mounting, linear in the unknowns (Hartley and Zisserman 2004, 7.1 and 8.1): they need not be exact.

use nalgebra::{
    Isometry3, Matrix3, Rotation3, SMatrix, SVector, Translation3, UnitQuaternion, Vector2, Vector3,
};

use super::pairs::PickedPair;

/// How the points lie in space.
pub struct Spread {
    /// Their middle.
    pub middle: Vector3<f64>,
    /// Axes, the longest first; right-handed.
    pub axes: Matrix3<f64>,
    /// Standard deviation along the axes, metres.
    pub lengths: [f64; 3],
}

impl Spread {
    /// Of at least one point.
    pub fn of(pairs: &[PickedPair]) -> Self {
        let count = pairs.len().max(1) as f64;
        let middle = pairs.iter().map(|pair| pair.point_in_lidar).sum::<Vector3<f64>>() / count;
        let mut scatter = Matrix3::zeros();
        for pair in pairs {
            let away = pair.point_in_lidar - middle;
            scatter += away * away.transpose() / count;
        }
        let eigen = scatter.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let column = |index: usize| eigen.eigenvectors.column(order[index]).into_owned();
        let (first, second) = (column(0), column(1));
        let axes = Matrix3::from_columns(&[first, second, first.cross(&second)]);
        Self { middle, axes, lengths: order.map(|index| eigen.eigenvalues[index].max(0.0).sqrt()) }
    }
}

/// The vector that a symmetric matrix shrinks most.
fn least<const N: usize>(matrix: SMatrix<f64, N, N>) -> SVector<f64, N>
where
    nalgebra::Const<N>: nalgebra::DimSub<nalgebra::U1>,
    nalgebra::DefaultAllocator:
        nalgebra::allocator::Allocator<nalgebra::DimDiff<nalgebra::Const<N>, nalgebra::U1>>,
{
    let eigen = matrix.symmetric_eigen();
    let mut best = 0;
    for index in 1..N {
        if eigen.eigenvalues[index] < eigen.eigenvalues[best] {
            best = index;
        }
    }
    eigen.eigenvectors.column(best).into_owned()
}

fn nearest_rotation(matrix: &Matrix3<f64>) -> Option<Rotation3<f64>> {
    let svd = matrix.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let sign = (u * v_t).determinant().signum();
    Some(Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t))
}

fn isometry(rotation: &Rotation3<f64>, translation: Vector3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(translation), UnitQuaternion::from_rotation_matrix(rotation))
}

/// By the direct linear transform of at least six points in space; `rays` are their directions at z = 1.
pub fn from_space(pairs: &[PickedPair], rays: &[Vector2<f64>], spread: &Spread) -> Option<Isometry3<f64>> {
    let scale = 1.0 / (spread.lengths.iter().map(|length| length * length).sum::<f64>().sqrt()).max(1.0e-6);
    let mut normal = SMatrix::<f64, 12, 12>::zeros();
    for (pair, ray) in pairs.iter().zip(rays) {
        let p = (pair.point_in_lidar - spread.middle) * scale;
        let (u, v) = (ray.x, ray.y);
        let rows = [
            [p.x, p.y, p.z, 1.0, 0.0, 0.0, 0.0, 0.0, -u * p.x, -u * p.y, -u * p.z, -u],
            [0.0, 0.0, 0.0, 0.0, p.x, p.y, p.z, 1.0, -v * p.x, -v * p.y, -v * p.z, -v],
        ];
        for row in rows {
            let row = SVector::<f64, 12>::from(row);
            normal += row * row.transpose();
        }
    }
    let found = least(normal);
    let matrix = Matrix3::from_fn(|row, column| found[4 * row + column]);
    let offset = Vector3::new(found[3], found[7], found[11]);
    // The sign is free: the points are before the camera.
    let sign = offset.z.signum();
    let (matrix, offset) = (matrix * sign, offset * sign);
    let stretch = libm::cbrt(matrix.determinant().abs());
    if stretch < 1.0e-12 {
        return None;
    }
    let rotation = nearest_rotation(&matrix)?;
    let translation = offset / (stretch * scale) - rotation * spread.middle;
    Some(isometry(&rotation, translation))
}

/// By the homography of at least four points on a plane.
pub fn from_plane(pairs: &[PickedPair], rays: &[Vector2<f64>], spread: &Spread) -> Option<Isometry3<f64>> {
    let scale = 1.0 / spread.lengths[0].max(1.0e-6);
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (pair, ray) in pairs.iter().zip(rays) {
        let p = spread.axes.transpose() * (pair.point_in_lidar - spread.middle) * scale;
        let (u, v) = (ray.x, ray.y);
        let rows = [
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -u * p.x, -u * p.y, -u],
            [0.0, 0.0, 0.0, p.x, p.y, 1.0, -v * p.x, -v * p.y, -v],
        ];
        for row in rows {
            let row = SVector::<f64, 9>::from(row);
            normal += row * row.transpose();
        }
    }
    let found = least(normal);
    let column = |index: usize| Vector3::new(found[index], found[3 + index], found[6 + index]);
    let (first, second, offset) = (column(0), column(1), column(2));
    let sign = offset.z.signum();
    let stretch = 0.5 * sign * (first.norm() + second.norm());
    if stretch.abs() < 1.0e-12 {
        return None;
    }
    let (first, second) = (first / stretch, second / stretch);
    let plane = nearest_rotation(&Matrix3::from_columns(&[first, second, first.cross(&second)]))?;
    let rotation = plane * Rotation3::from_matrix_unchecked(spread.axes.transpose());
    let translation = offset / (stretch * scale) - rotation * spread.middle;
    Some(isometry(&rotation, translation))
}
