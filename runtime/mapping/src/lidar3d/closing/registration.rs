//! One place measured from another by planes: Gauss and Newton over the distances of points from the planes of a local map
//! (Chen and Medioni 1992), with the kernel of Geman and McClure 1987.

use floorguard_mapping::lidar_odometry::{
    Bucket, Level, Plane, Pose3, VoxelMap, VoxelMapConfig, symmetric_eigen,
};
use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

/// Planes around a place.
pub(super) struct LocalMap(VoxelMap<Box<[Bucket]>>);

/// Cubes of a local map: eight times as many.
const BUCKETS: usize = 1 << 12;
/// What planes of cubes do not explain, metres.
const NOISE_M: f32 = 0.01;
/// A distance of this many deviations has a quarter of the weight.
const KERNEL: f32 = 3.0;
/// The kernel of the first round is wider by this factor; that of each later one by the root of the one before.
const KERNEL_FIRST: f32 = 30.0;
const ROUNDS: usize = 30;
/// A round that moves by less ends it: radians and metres.
const STEP_LEAST: f64 = 1.0e-4;
/// Neighbouring points err alike: so many count as one.
const ALIKE: f64 = 10.0;
/// A direction with less than so many times the information of tilted planes is not measured.
const TIMES_NOISE_LEAST: f64 = 150.0;
/// No place is measured more exactly: radians and metres, one standard deviation.
const FLOOR_RAD: f64 = 1.0e-3;
const FLOOR_M: f64 = 1.0e-2;

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Of the points in the map.
    pub(super) pose: Pose3,
    /// Inverse covariance of rotation and place in the points' axes.
    pub(super) information: Matrix6<f64>,
    /// Share of the points that lie on planes.
    pub(super) share: f64,
    /// Root of their mean squared distance, metres.
    pub(super) misfit_m: f64,
}

struct Sums {
    information: Matrix6<f64>,
    gradient: Vector6<f64>,
    kernels: f64,
    squares_m2: f64,
    tilts: f64,
}

impl LocalMap {
    pub(super) fn new(points: impl Iterator<Item = Vector3<f32>>) -> Self {
        let storage = vec![Bucket::EMPTY; BUCKETS].into_boxed_slice();
        let mut map = VoxelMap::new(storage, VoxelMapConfig::default());
        points.for_each(|point| map.insert(&point, 0));
        Self(map)
    }

    /// Lays points onto the map from where they are supposed to be; `None` if they do not hold themselves there.
    pub(super) fn measure(&self, points: &[Vector3<f32>], start: &Pose3) -> Option<Measured> {
        let mut pose = *start;
        let mut widening = KERNEL_FIRST;
        for _ in 0..ROUNDS {
            let sums = self.sums(points, &pose, widening);
            let factor = (sums.information + Matrix6::from_diagonal_element(1.0e-3)).cholesky()?;
            let step = -factor.solve(&sums.gradient);
            let (turn, place) = (step.fixed_rows::<3>(0).into_owned(), step.fixed_rows::<3>(3).into_owned());
            pose = pose.moved(turn, place);
            if widening <= 1.0 && step.amax() < STEP_LEAST {
                break;
            }
            widening = libm::sqrtf(widening);
            if widening < 1.2 {
                widening = 1.0;
            }
        }
        let sums = self.sums(points, &pose, 1.0);
        let covariance = sums.covariance()?;
        Some(Measured {
            pose,
            information: covariance.try_inverse()?,
            share: sums.kernels / points.len().max(1) as f64,
            misfit_m: libm::sqrt(sums.squares_m2 / sums.kernels.max(1.0)),
        })
    }

    fn sums(&self, points: &[Vector3<f32>], pose: &Pose3, widening: f32) -> Sums {
        let rotation = pose.rotation.map(|part| part as f32);
        let back = rotation.transpose();
        let origin = pose.place_m.map(|part| part as f32);
        let kernel = (KERNEL * widening) * (KERNEL * widening);
        let mut sums = Sums {
            information: Matrix6::zeros(),
            gradient: Vector6::zeros(),
            kernels: 0.0,
            squares_m2: 0.0,
            tilts: 0.0,
        };
        for point in points {
            let place = rotation * point + origin;
            let Some(plane) = self.plane(&place) else { continue };
            let from_middle = place - plane.mean;
            let distance_m = plane.normal.dot(&from_middle);
            let variance = plane.variance + plane.tilt * from_middle.norm_squared() + NOISE_M * NOISE_M;
            let share = kernel / (kernel + distance_m * distance_m / variance);
            if share <= 0.1 {
                continue;
            }
            let weight = f64::from(share * share / variance);
            let normal = back * plane.normal;
            let turn = point.cross(&normal);
            let row = Vector6::new(turn.x, turn.y, turn.z, normal.x, normal.y, normal.z).map(f64::from);
            sums.information += row * row.transpose() * weight;
            sums.gradient += row * (weight * f64::from(distance_m));
            sums.kernels += f64::from(share * share);
            sums.squares_m2 += f64::from(share * share * distance_m * distance_m);
            sums.tilts += weight * f64::from(plane.tilt);
        }
        sums
    }

    fn plane(&self, place: &Vector3<f32>) -> Option<&Plane> {
        let at = |level| {
            let found = self.0.find(place, level)?;
            Some(self.0.plane(found)).filter(|plane| plane.is_known())
        };
        at(Level::Fine).or_else(|| at(Level::Coarse))
    }
}

impl Sums {
    /// Of rotation and place; directions of the place about which the planes say no more than noise count as not known.
    fn covariance(&self) -> Option<Matrix6<f64>> {
        let information = self.information / ALIKE + Matrix6::from_diagonal_element(1.0);
        let mut covariance = information.try_inverse()?;
        let place = self.information.fixed_view::<3, 3>(3, 3).into_owned();
        let scale = place.trace().max(1.0e-30);
        let parts = [place.m11, place.m12, place.m13, place.m22, place.m23, place.m33];
        let eigen = symmetric_eigen(parts.map(|part| (part / scale) as f32));
        for (value, direction) in eigen.values.iter().zip(eigen.vectors) {
            if f64::from(*value) * scale < TIMES_NOISE_LEAST * self.tilts {
                let direction = direction.map(f64::from);
                let mut block = covariance.fixed_view_mut::<3, 3>(3, 3);
                block += direction * direction.transpose();
            }
        }
        for (row, least) in [(0, FLOOR_RAD), (3, FLOOR_M)] {
            let mut block = covariance.fixed_view_mut::<3, 3>(row, row);
            block += Matrix3::from_diagonal_element(least * least);
        }
        Some(covariance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on walls, floor and ceiling of a room of 8 × 6 × 3 m with a pillar.
    fn room() -> Vec<Vector3<f32>> {
        let mut points = Vec::new();
        let mut sheet = |origin: [f32; 3], a: [f32; 3], b: [f32; 3]| {
            for i in 0..60 {
                for j in 0..60 {
                    let (s, t) = (i as f32 / 59.0, j as f32 / 59.0);
                    points.push(Vector3::from(origin) + Vector3::from(a) * s + Vector3::from(b) * t);
                }
            }
        };
        sheet([-4.0, -3.0, -1.0], [8.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
        sheet([-4.0, 3.0, -1.0], [8.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
        sheet([-4.0, -3.0, -1.0], [0.0, 6.0, 0.0], [0.0, 0.0, 3.0]);
        sheet([4.0, -3.0, -1.0], [0.0, 6.0, 0.0], [0.0, 0.0, 3.0]);
        sheet([-4.0, -3.0, -1.0], [8.0, 0.0, 0.0], [0.0, 6.0, 0.0]);
        points
    }

    #[test]
    fn place_is_measured_from_afar() {
        let map = LocalMap::new(room().into_iter());
        let truth = Pose3::identity().moved(Vector3::new(0.02, -0.01, 0.5), Vector3::new(0.8, -0.4, 0.05));
        let back = truth.inverse();
        let seen: Vec<_> = room()
            .iter()
            .map(|point| back.transform(&point.map(f64::from)).map(|value| value as f32))
            .collect();
        let start = truth.moved(Vector3::new(0.01, 0.01, -0.03), Vector3::new(0.15, 0.1, -0.1));
        let measured = map.measure(&seen, &start).unwrap();
        let off = truth.inverse().compose(&measured.pose);
        assert!(off.place_m.norm() < 2.0e-3 && off.rotation_vector().norm() < 5.0e-4, "{off:?}");
        assert!(measured.share > 0.9 && measured.misfit_m < 0.01, "{measured:?}");
    }

    #[test]
    fn direction_without_planes_is_not_measured() {
        let along: Vec<_> = room().into_iter().filter(|point| point.x.abs() < 3.9).collect();
        let map = LocalMap::new(along.iter().copied());
        let measured = map.measure(&along, &Pose3::identity()).unwrap();
        let covariance = measured.information.try_inverse().unwrap();
        assert!(covariance[(3, 3)] > 0.5 && covariance[(4, 4)] < 1.0e-3, "{covariance}");
    }
}
