//! Features of a sweep against those of the key frames around it: all six numbers of the pose.

use floorguard_mapping::lidar_odometry::Pose3;
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};

use super::config::LegoLoamConfig;
use super::features::Feature;
use super::neighbours::{NEIGHBOURS, PointIndex};
use super::thinning::thinned_points;

/// Rounds at most.
const ROUNDS: usize = 10;
/// Fewer correspondences do not move the pose.
const CORRESPONDENCES_LEAST: usize = 50;
/// An eigenvalue of the equations below this is no information.
const EIGENVALUE_LEAST: f64 = 100.0;
/// Points that the map must have: edges and surfaces.
const MAP_LEAST: [usize; 2] = [10, 100];
/// Points lie on a line if the largest eigenvalue is so many times the second.
const LINE_RATIO: f64 = 3.0;
/// Points lie on a plane if each is this near, metres.
const PLANE_M: f64 = 0.2;
const WEIGHT_FALL: f64 = 0.9;
const WEIGHT_LEAST: f64 = 0.1;
/// A round that moves by less ends it: radians and metres.
const STOP_RAD: f64 = 0.05 * std::f64::consts::PI / 180.0;
const STOP_M: f64 = 0.0005;
/// Key frames of the map are at least this far apart, metres.
const KEY_DENSITY_M: f32 = 1.0;

type Points = Vec<Vector3<f32>>;

/// Features of a sweep at its end, in the sensor's frame.
#[derive(Clone, Debug, Default)]
pub(super) struct SweepFeatures {
    pub(super) edges: Points,
    /// Less flat returns, and outliers.
    pub(super) surfaces: Points,
}

impl SweepFeatures {
    /// Thinned as the map is.
    pub(super) fn new(
        edges: &[Feature],
        (surfaces, outliers): (&[Feature], &[Feature]),
        config: &LegoLoamConfig,
    ) -> Self {
        let places = |features: &[Feature]| features.iter().map(|each| each.point).collect::<Points>();
        let thin = |points: Points, edge_m| thinned_points(points.into_iter(), edge_m);
        let surfaces = thin(places(surfaces), config.surface_m);
        let outliers = thin(places(outliers), config.surface_m);
        Self {
            edges: thin(places(edges), config.corner_m),
            surfaces: thin([surfaces, outliers].concat(), config.surface_m),
        }
    }
}

/// A sweep that stays.
#[derive(Clone, Debug)]
struct KeyFrame {
    pose: Pose3,
    features: SweepFeatures,
}

/// The key frames, and the map of those around.
#[derive(Clone, Debug, Default)]
pub(super) struct Mapping {
    keys: Vec<KeyFrame>,
    /// Key frames that the map was made of.
    mapped: Vec<usize>,
    edges: PointIndex,
    surfaces: PointIndex,
}

/// One correspondence.
struct Row {
    derivative: Vector6<f64>,
    distance_m: f64,
}

impl Mapping {
    /// The pose that fits the map, from where the sensor is supposed to be. The first sweep is the map.
    pub(super) fn push(&mut self, features: SweepFeatures, start: Pose3, config: &LegoLoamConfig) -> Pose3 {
        self.surround(&start, config);
        let is_mapped = self.edges.len() > MAP_LEAST[0] && self.surfaces.len() > MAP_LEAST[1];
        let pose = if is_mapped { self.fit(&features, start) } else { start };
        let is_far = |key: &KeyFrame| (key.pose.place_m - pose.place_m).norm() >= config.key_m;
        if self.keys.last().is_none_or(is_far) {
            self.keys.push(KeyFrame { pose, features });
        }
        pose
    }

    /// Number of key frames.
    pub(super) fn keys(&self) -> usize {
        self.keys.len()
    }

    /// Makes the map of the key frames around, if they are others than before.
    fn surround(&mut self, here: &Pose3, config: &LegoLoamConfig) {
        let mut taken = std::collections::BTreeSet::new();
        let mut near = Vec::new();
        // The newest of each metre.
        for (index, key) in self.keys.iter().enumerate().rev() {
            let place = key.pose.place_m.map(|value| value as f32);
            let cell: [i32; 3] = place.map(|value| libm::floorf(value / KEY_DENSITY_M) as i32).into();
            if (key.pose.place_m - here.place_m).norm() < config.surrounding_m && taken.insert(cell) {
                near.push(index);
            }
        }
        near.sort_unstable();
        if near == self.mapped {
            return;
        }
        let gather = |pick: fn(&SweepFeatures) -> &Points, edge_m: f32| {
            let points = near.iter().flat_map(|index| {
                let key = &self.keys[*index];
                let rotation = key.pose.rotation.map(|part| part as f32);
                let origin = key.pose.place_m.map(|part| part as f32);
                pick(&key.features).iter().map(move |point| rotation * point + origin)
            });
            PointIndex::new(&thinned_points(points, edge_m))
        };
        self.edges = gather(|features| &features.edges, config.corner_m);
        self.surfaces = gather(|features| &features.surfaces, config.surface_m);
        self.mapped = near;
    }

    fn fit(&self, features: &SweepFeatures, start: Pose3) -> Pose3 {
        let mut pose = start;
        let mut projection: Option<Matrix6<f64>> = None;
        for _ in 0..ROUNDS {
            let edges = features.edges.iter().filter_map(|point| self.edge_row(point, &pose));
            let surfaces = features.surfaces.iter().filter_map(|point| self.surface_row(point, &pose));
            let (mut matrix, mut gradient, mut count) = (Matrix6::zeros(), Vector6::zeros(), 0);
            for row in edges.chain(surfaces) {
                matrix += row.derivative * row.derivative.transpose();
                gradient += row.derivative * row.distance_m;
                count += 1;
            }
            if count < CORRESPONDENCES_LEAST {
                return pose;
            }
            let Some(inverse) = matrix.try_inverse() else { return pose };
            let by = *projection.get_or_insert_with(|| informed(&matrix)) * -(inverse * gradient);
            let (turn, step) = (by.fixed_rows::<3>(0).into_owned(), by.fixed_rows::<3>(3).into_owned());
            // The turn is about the map's axes at the sensor, the step along them.
            let turned = Pose3::identity().moved(turn, Vector3::zeros());
            let rotated = turned.compose(&Pose3 { rotation: pose.rotation, place_m: Vector3::zeros() });
            pose = Pose3 { rotation: rotated.rotation, place_m: pose.place_m + step };
            if turn.norm() < STOP_RAD && step.norm() < STOP_M {
                break;
            }
        }
        pose
    }

    fn edge_row(&self, point: &Vector3<f32>, pose: &Pose3) -> Option<Row> {
        let point = point.map(f64::from);
        let (turned, place) = (pose.rotation * point, pose.transform(&point));
        let near = self.edges.nearest(&place.map(|value| value as f32))?.map(|point| point.map(f64::from));
        let mean = near.iter().sum::<Vector3<f64>>() / NEIGHBOURS as f64;
        let spread: Matrix3<f64> = near.iter().map(|point| (point - mean) * (point - mean).transpose()).sum();
        let eigen = (spread / NEIGHBOURS as f64).symmetric_eigen();
        let mut values: [f64; 3] = eigen.eigenvalues.into();
        let largest = eigen.eigenvalues.imax();
        values.sort_by(f64::total_cmp);
        if values[2] <= LINE_RATIO * values[1] {
            return None;
        }
        let along = eigen.eigenvectors.column(largest).into_owned();
        let across = (place - mean) - along * along.dot(&(place - mean));
        let distance_m = libm::sqrt(across.norm_squared());
        let direction = across.try_normalize(1.0e-9)?;
        row((turned, direction), distance_m, 1.0 - WEIGHT_FALL * distance_m)
    }

    fn surface_row(&self, point: &Vector3<f32>, pose: &Pose3) -> Option<Row> {
        let point = point.map(f64::from);
        let (turned, place) = (pose.rotation * point, pose.transform(&point));
        let near = self.surfaces.nearest(&place.map(|value| value as f32))?.map(|point| point.map(f64::from));
        // The plane n·p = −1, about a point nearby so that it does not matter where the map begins.
        let origin = near[0] + Vector3::repeat(10.0);
        let points = SMatrix::<f64, NEIGHBOURS, 3>::from_fn(|row, column| (near[row] - origin)[column]);
        let squares = points.transpose() * points;
        let normal =
            squares.try_inverse()? * (points.transpose() * SMatrix::<f64, NEIGHBOURS, 1>::repeat(-1.0));
        let length = libm::sqrt(normal.norm_squared());
        let (normal, offset) = (normal / length, 1.0 / length);
        let distance_of = |place: &Vector3<f64>| normal.dot(&(place - origin)) + offset;
        if near.iter().any(|place| distance_of(place).abs() > PLANE_M) {
            return None;
        }
        let distance_m = distance_of(&place);
        let view_m = libm::sqrt(libm::sqrt(point.norm_squared()).max(1.0e-6));
        row((turned, normal), distance_m, 1.0 - WEIGHT_FALL * distance_m.abs() / view_m)
    }
}

/// As published, the weight scales row and distance.
fn row((turned, direction): (Vector3<f64>, Vector3<f64>), distance_m: f64, weight: f64) -> Option<Row> {
    if weight.is_nan() || weight <= WEIGHT_LEAST {
        return None;
    }
    let turn = turned.cross(&direction);
    let derivative = Vector6::new(turn.x, turn.y, turn.z, direction.x, direction.y, direction.z) * weight;
    Some(Row { derivative, distance_m: distance_m * weight })
}

/// Keeps the directions whose eigenvalue is large enough (Zhang et al. 2016).
fn informed(matrix: &Matrix6<f64>) -> Matrix6<f64> {
    let eigen = matrix.symmetric_eigen();
    let mut projection = Matrix6::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value >= EIGENVALUE_LEAST {
            projection += vector * vector.transpose();
        }
    }
    projection
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surfaces() -> Points {
        let mut points = Vec::new();
        for i in 0..60 {
            for j in 0..30 {
                let (s, t) = (i as f32 * 0.2 - 6.0, j as f32 * 0.2 - 3.0);
                points.extend([
                    Vector3::new(s, t, -0.8),
                    Vector3::new(s, 3.0, 0.4 * t + 0.4),
                    Vector3::new(6.0, t, 0.5),
                ]);
                points.push(Vector3::new(6.0, t, 0.1 * (i % 20) as f32));
            }
        }
        points
    }

    fn edges() -> Points {
        let post = |x: f32, y: f32| (0..20).map(move |step| Vector3::new(x, y, 0.21 * step as f32 - 0.8));
        [post(4.0, 1.0), post(-3.0, 2.0), post(1.0, -2.5), post(-5.0, -2.0)].into_iter().flatten().collect()
    }

    #[test]
    fn pose_is_found_within_a_centimetre() {
        let config = LegoLoamConfig::default();
        let mut mapping = Mapping::default();
        let all = SweepFeatures { edges: edges(), surfaces: surfaces() };
        mapping.push(all, Pose3::identity(), &config);
        let truth = Pose3::identity().moved(Vector3::new(0.01, -0.01, 0.05), Vector3::new(0.4, 0.1, 0.02));
        let back = truth.inverse();
        let seen = |points: Points| -> Points {
            let moved =
                |point: &Vector3<f32>| back.transform(&point.map(f64::from)).map(|value| value as f32);
            points.iter().map(moved).collect()
        };
        let start = truth.moved(Vector3::new(-0.005, 0.005, 0.02), Vector3::new(0.06, -0.05, 0.03));
        let pose =
            mapping.push(SweepFeatures { edges: seen(edges()), surfaces: seen(surfaces()) }, start, &config);
        let off = truth.inverse().compose(&pose);
        assert!(off.place_m.norm() < 0.01 && off.rotation_vector().norm() < 0.003, "{off:?}");
        assert_eq!(mapping.keys(), 2, "0.4 m from the first");
    }
}
