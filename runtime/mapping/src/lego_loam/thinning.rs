//! One return for each cube: the mean of those in it, as the voxel filter of the Point Cloud Library has it (Rusu and Cousins
//! 2011).

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::features::Feature;

/// What lies in a cube of a row.
#[derive(Clone, Copy, Default)]
struct Sums {
    place: Vector3<f32>,
    time: f32,
    count: f32,
}

/// The means, ordered by row and cube.
pub(super) fn thinned(features: &[Feature], edge_m: f32) -> Vec<Feature> {
    let mut cubes: BTreeMap<(u8, [i32; 3]), Sums> = BTreeMap::new();
    for feature in features {
        let cell = feature.point.map(|value| libm::floorf(value / edge_m) as i32);
        let sums = cubes.entry((feature.row, cell.into())).or_default();
        sums.place += feature.point;
        sums.time += feature.time_share;
        sums.count += 1.0;
    }
    let mean = |((row, _), Sums { place, time, count }): (_, Sums)| Feature {
        point: place / count,
        row,
        time_share: time / count,
    };
    cubes.into_iter().map(mean).collect()
}

/// The same for points alone.
pub(super) fn thinned_points(points: impl Iterator<Item = Vector3<f32>>, edge_m: f32) -> Vec<Vector3<f32>> {
    let mut cubes: BTreeMap<[i32; 3], (Vector3<f32>, f32)> = BTreeMap::new();
    for point in points {
        let cell = point.map(|value| libm::floorf(value / edge_m) as i32);
        let entry = cubes.entry(cell.into()).or_insert((Vector3::zeros(), 0.0));
        *entry = (entry.0 + point, entry.1 + 1.0);
    }
    cubes.into_values().map(|(sum, count)| sum / count).collect()
}
