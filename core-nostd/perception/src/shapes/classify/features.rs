//! The 71 features of the published detector, exactly as its code computes them. Source: book, People: Published
//! features.
//!
//! Two passes over the points, in the lidar's frame: sums and bounds first, then what depends on the mean and the
//! bounds. The published code rotates the cloud into its principal axes; none of the 71 values depends on the axes, only
//! on the eigenvalues, so nothing is rotated here.

use super::eigenvalues::eigenvalues3;
use floorguard_types::geometry::Point3;
use floorguard_types::number::{nearest_f32_of_f64, nearest_f64, saturating_usize_of_f64};

/// Dimensions of the vector.
pub const FEATURES: usize = 71;
/// The vector; index 0 holds dimension 1 of the publication.
pub type Features = [f32; FEATURES];

const SLICES: usize = 10;
const BINS: usize = 25;

/// First pass: sums and bounds.
#[derive(Clone, Copy, Debug)]
pub struct FeatureBuilder {
    count: u32,
    sums: [f64; 3],
    nearest_m2: f64,
    lowest_m: f64,
    highest_m: f64,
    intensity_sum: f64,
    intensity_min: f64,
    intensity_max: f64,
}

impl Default for FeatureBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl FeatureBuilder {
    /// No points yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            count: 0,
            sums: [0.0; 3],
            nearest_m2: f64::INFINITY,
            lowest_m: f64::INFINITY,
            highest_m: f64::NEG_INFINITY,
            intensity_sum: 0.0,
            intensity_min: f64::INFINITY,
            intensity_max: f64::NEG_INFINITY,
        }
    }

    /// Takes in a point of the lidar's frame with its reflectivity.
    pub fn add(&mut self, point: Point3, reflectivity: u8) {
        let [x, y, z] = coordinates(point);
        let intensity = f64::from(reflectivity);
        self.count = self.count.saturating_add(1);
        let [sum_x, sum_y, sum_z] = &mut self.sums;
        *sum_x += x;
        *sum_y += y;
        *sum_z += z;
        self.nearest_m2 = self.nearest_m2.min(x * x + y * y + z * z);
        self.lowest_m = self.lowest_m.min(z);
        self.highest_m = self.highest_m.max(z);
        self.intensity_sum += intensity;
        self.intensity_min = self.intensity_min.min(intensity);
        self.intensity_max = self.intensity_max.max(intensity);
    }

    /// Ends the first pass; `None` without a point.
    #[must_use]
    pub fn scatter_pass(self) -> Option<ScatterPass> {
        if self.count == 0 {
            return None;
        }
        let count = f64::from(self.count);
        Some(ScatterPass {
            mean: self.sums.map(|sum| sum / count),
            intensity_mean: self.intensity_sum / count,
            first: self,
            scatter: [0.0; 6],
            intensity_scatter: 0.0,
            slices: [Slice::EMPTY; SLICES],
            histogram: [0; BINS],
        })
    }
}

/// A tenth of the height.
#[derive(Clone, Copy, Debug)]
struct Slice {
    count: u32,
    lower: [f64; 2],
    upper: [f64; 2],
    sums: [f64; 3],
}

impl Slice {
    const EMPTY: Self =
        Self { count: 0, lower: [f64::INFINITY; 2], upper: [f64::NEG_INFINITY; 2], sums: [0.0; 3] };

    fn add(&mut self, [x, y, z]: [f64; 3]) {
        self.count = self.count.saturating_add(1);
        self.lower = [self.lower[0].min(x), self.lower[1].min(y)];
        self.upper = [self.upper[0].max(x), self.upper[1].max(y)];
        self.sums = [self.sums[0] + x, self.sums[1] + y, self.sums[2] + z];
    }
}

/// Second pass: what needs the mean and the bounds. Feed it the same points as the first.
#[derive(Clone, Copy, Debug)]
pub struct ScatterPass {
    first: FeatureBuilder,
    mean: [f64; 3],
    intensity_mean: f64,
    scatter: [f64; 6],
    intensity_scatter: f64,
    slices: [Slice; SLICES],
    histogram: [u32; BINS],
}

impl ScatterPass {
    /// Takes in a point again.
    pub fn add(&mut self, point: Point3, reflectivity: u8) {
        let position = coordinates(point);
        let [dx, dy, dz] = {
            let [x, y, z] = position;
            [x - self.mean[0], y - self.mean[1], z - self.mean[2]]
        };
        let products = [dx * dx, dx * dy, dx * dz, dy * dy, dy * dz, dz * dz];
        for (sum, product) in self.scatter.iter_mut().zip(products) {
            *sum += product;
        }
        let intensity = f64::from(reflectivity);
        self.intensity_scatter += (intensity - self.intensity_mean) * (intensity - self.intensity_mean);
        let slice_m = (self.first.highest_m - self.first.lowest_m) / nearest_f64(SLICES);
        if slice_m > 0.0 {
            let index = saturating_usize_of_f64((position[2] - self.first.lowest_m) / slice_m);
            if let Some(slice) = self.slices.get_mut(index.min(SLICES - 1)) {
                slice.add(position);
            }
        }
        let width = (self.first.intensity_max - self.first.intensity_min) / nearest_f64(BINS);
        // All of one brightness: the published code divides 0 by 0 and lands in the last bin.
        let bin = if width > 0.0 {
            saturating_usize_of_f64((intensity - self.first.intensity_min) / width)
        } else {
            BINS - 1
        };
        if let Some(count) = self.histogram.get_mut(bin.min(BINS - 1)) {
            *count = count.saturating_add(1);
        }
    }

    /// The vector. Dimensions 10, 11 and 13 are mathematically zero and exactly 0 here.
    #[must_use]
    pub fn features(&self) -> Features {
        let count = f64::from(self.first.count);
        let [l1, l2, l3] = eigenvalues3(self.scatter);
        let [x, y, z] = self.mean;
        let head = [
            count,
            self.first.nearest_m2,
            l1 / count + x * x,
            x * y,
            x * z,
            l2 / count + y * y,
            y * z,
            l3 / count + z * z,
            l2 + l3,
            0.0,
            0.0,
            l1 + l3,
            0.0,
            l1 + l2,
        ];
        let extents = self.slices.iter().flat_map(|slice| match slice.count {
            0 => [0.0; 2],
            _ => [slice.upper[0] - slice.lower[0], slice.upper[1] - slice.lower[1]],
        });
        let centroids = self.slices.iter().map(|slice| {
            let points = f64::from(slice.count.max(1));
            slice.sums.iter().map(|sum| (sum / points) * (sum / points)).sum::<f64>()
        });
        let histogram = self.histogram.iter().map(|count| f64::from(*count));
        let tail = [libm::sqrt(self.intensity_scatter / count), self.intensity_mean];
        let all = head.into_iter().chain(extents).chain(centroids).chain(histogram).chain(tail);
        let mut features = [0.0; FEATURES];
        for (feature, value) in features.iter_mut().zip(all) {
            *feature = nearest_f32_of_f64(value);
        }
        features
    }
}

fn coordinates(point: Point3) -> [f64; 3] {
    [f64::from(point.x_m), f64::from(point.y_m), f64::from(point.z_m)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLUSTER: [(f32, f32, f32, u8); 8] = [
        (5.0, 1.0, -0.8, 10),
        (5.1, 1.05, -0.5, 20),
        (5.0, 1.1, -0.2, 30),
        (5.2, 0.9, 0.1, 40),
        (5.05, 1.0, 0.3, 50),
        (5.1, 0.95, 0.5, 60),
        (5.0, 1.0, 0.7, 70),
        (5.15, 1.1, 0.8, 80),
    ];

    fn features_of(points: &[(f32, f32, f32, u8)]) -> Features {
        let mut first = FeatureBuilder::new();
        points.iter().for_each(|&(x, y, z, i)| first.add(Point3::new(x, y, z), i));
        let mut second = first.scatter_pass().expect("points");
        points.iter().for_each(|&(x, y, z, i)| second.add(Point3::new(x, y, z), i));
        second.features()
    }

    /// The test values of the book, People: Published features.
    #[test]
    fn features_equal_the_vector() {
        let mut wanted =
            std::vec![8.0, 26.25, 26.044_647, 5.138_438, 0.570_938, 1.031_070, 0.113_906, 0.015_533];
        wanted.extend([0.070_320, 0.0, 0.0, 2.335_193, 0.0, 2.359_487]);
        wanted.extend([0.0; 18]);
        wanted.extend([0.15, 0.1]);
        wanted.extend([26.64, 27.3625, 0.0, 26.25, 0.0, 27.86, 26.5925, 0.0, 27.1625, 27.420_625]);
        let ones = [0, 3, 7, 10, 14, 17, 21, 24];
        wanted.extend((0..25).map(|bin| if ones.contains(&bin) { 1.0 } else { 0.0 }));
        wanted.extend([22.912_878, 45.0]);
        assert_eq!(wanted.len(), FEATURES);
        for (index, (value, expected)) in features_of(&CLUSTER).iter().zip(wanted).enumerate() {
            let tolerance = 1.0e-6 * f64::abs(expected).max(1.0);
            assert!((f64::from(*value) - expected).abs() < tolerance, "{}: {value} {expected}", index + 1);
        }
    }

    #[test]
    fn order_does_not_matter() {
        let mut reversed = CLUSTER;
        reversed.reverse();
        for (a, b) in features_of(&CLUSTER).iter().zip(features_of(&reversed)) {
            assert!((a - b).abs() <= 1.0e-6 * a.abs().max(1.0));
        }
    }

    #[test]
    fn flat_uniform_cluster_has_no_slices() {
        let features = features_of(&[(2.0, 0.0, 0.5, 7), (2.0, 0.1, 0.5, 7), (2.0, 0.2, 0.5, 7)]);
        assert!(features[14..44].iter().all(|value| *value == 0.0));
        assert_eq!(features[68], 3.0);
        assert!(FeatureBuilder::new().scatter_pass().is_none());
    }
}
