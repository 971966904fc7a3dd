//! How likely a range scan is at a pose: the likelihood field.
//!
//! The end of every beam is looked up in the distance field of the map. A beam without a return says nothing here:
//! it neither confirms nor refutes a place (book, Cleaning: Likelihood field).

use floorguard_mapping::DistanceField;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::number::{exact_usize, nearest_f32, saturating_i32, saturating_u8, truncating_u32};

/// Parameters of the likelihood field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeModelConfig {
    /// Share of beams that hit what the map shows, z_hit.
    pub hit_share: f32,
    /// Share of beams that mean nothing, z_rand.
    pub random_share: f32,
    /// Deviation of a hit from the map, metres, > 0.
    pub hit_deviation_m: f32,
    /// Range of the sensor, metres, > 0.
    pub range_max_m: f32,
    /// So many beams count as one, b ≥ 1: neighbours err together. The few beams that are left before a wall then weigh
    /// little, and a single outlier among them does not move the robot.
    pub beams_as_one: f32,
    /// A beam this near to what the map shows is explained by it, metres: noise of the sensor and a cell of the map.
    pub explained_within_m: f32,
}

impl RangeModelConfig {
    /// The published robot: a depth camera used as a scanner (book, Cleaning: Likelihood field). Narrower than the
    /// 0.2 m of AMCL, for the sensor errs by 0.03 m and the map by half a pixel of 0.05 m; with a b as cautious as
    /// there: 3 instead of 6 lost the robot between furniture, with five times as many bumps and no shorter path.
    pub const XTION: Self = Self {
        hit_share: 0.95,
        random_share: 0.05,
        hit_deviation_m: 0.08,
        range_max_m: 4.0,
        beams_as_one: 6.0,
        explained_within_m: 0.12,
    };
    /// A safety scanner of 270°: beams 4.5° apart hit different objects, and a map of 5 cm is the larger
    /// error.
    pub const SAFETY_SCANNER: Self = Self {
        hit_share: 0.9,
        random_share: 0.1,
        hit_deviation_m: 0.08,
        range_max_m: 30.0,
        beams_as_one: 5.0,
        explained_within_m: 0.1,
    };
}

/// Fewer beams than these do not tell whether a pose is healthy.
pub const BEAMS_TO_JUDGE: usize = 10;

/// Logarithm of the likelihood for every stored distance, one table entry a centimetre.
///
/// ```
/// use floorguard_localisation::{RangeModel, RangeModelConfig};
///
/// let model = RangeModel::new(RangeModelConfig { hit_deviation_m: 0.2, ..RangeModelConfig::XTION });
/// assert!((model.likelihood(0.0) - 0.962_5).abs() < 1.0e-5);
/// assert!((model.likelihood(0.5) - 0.054_240).abs() < 1.0e-5);
/// ```
#[derive(Clone, Debug)]
pub struct RangeModel {
    log_likelihood: [f32; 256],
    beam_weight: f32,
    explained_limit_cm: u8,
}

impl RangeModel {
    /// Tabulates the model once; invalid parameters give a model that finds every pose equally likely.
    #[must_use]
    pub fn new(config: RangeModelConfig) -> Self {
        let deviation = config.hit_deviation_m.max(1e-3);
        let floor = config.random_share / config.range_max_m.max(1e-3);
        let mut log_likelihood = [0.0; 256];
        for (entry, centimetres) in log_likelihood.iter_mut().zip(0_u16..) {
            let distance = f32::from(centimetres) * 0.01;
            let gaussian = libm::expf(-0.5 * (distance / deviation) * (distance / deviation));
            let value = libm::logf((config.hit_share * gaussian + floor).max(1e-6));
            *entry = if value.is_finite() { value } else { 0.0 };
        }
        let explained_limit_cm = saturating_u8((config.explained_within_m * 100.0 + 0.5).clamp(1.0, 199.0));
        Self { log_likelihood, beam_weight: 1.0 / config.beams_as_one.max(1.0), explained_limit_cm }
    }

    /// Likelihood at a distance from the map, for tests and reports.
    #[must_use]
    pub fn likelihood(&self, distance_m: f32) -> f32 {
        let centimetres = saturating_u8((distance_m.max(0.0) * 100.0 + 0.5).min(255.0));
        self.log_likelihood.get(usize::from(centimetres)).map_or(1.0, |&value| libm::expf(value))
    }

    /// Logarithm of the likelihood of a whole scan at a pose in the map frame. No beams: 0 for every pose.
    #[inline]
    #[must_use]
    pub fn log_likelihood<S: AsRef<[u8]> + AsMut<[u8]>>(
        &self,
        field: &DistanceField<S>,
        pose_in_map: Pose2,
        hits_in_base: &[Point2],
    ) -> f32 {
        let lookup = Lookup::new(field, pose_in_map);
        let mut sum = 0.0;
        for &hit in hits_in_base {
            sum += self.log_likelihood.get(usize::from(lookup.centimetres(hit))).copied().unwrap_or(0.0);
        }
        sum * self.beam_weight
    }

    /// Share of the beams that end where the map shows something; the health of the localisation. `None` with fewer than
    /// [`BEAMS_TO_JUDGE`]: not known, because one or two outliers would decide.
    #[must_use]
    pub fn explained_share<S: AsRef<[u8]> + AsMut<[u8]>>(
        &self,
        field: &DistanceField<S>,
        pose_in_map: Pose2,
        hits_in_base: &[Point2],
    ) -> Option<f32> {
        let lookup = Lookup::new(field, pose_in_map);
        let explained =
            hits_in_base.iter().filter(|&&hit| lookup.centimetres(hit) <= self.explained_limit_cm);
        (hits_in_base.len() >= BEAMS_TO_JUDGE)
            .then(|| nearest_f32(explained.count()) / nearest_f32(hits_in_base.len()))
    }
}

/// The distance field seen from a pose, in cells, so that a beam costs four multiplications and one byte.
struct Lookup<'a> {
    values: &'a [u8],
    width: u32,
    height: u32,
    x: f32,
    y: f32,
    sin: f32,
    cos: f32,
}

/// Shifts a coordinate so that truncation is a floor for every cell down to −4,096.
const SHIFT: i32 = 4_096;

impl<'a> Lookup<'a> {
    #[inline]
    fn new<S: AsRef<[u8]> + AsMut<[u8]>>(field: &'a DistanceField<S>, pose_in_map: Pose2) -> Self {
        let geometry = field.geometry();
        let scale = geometry.cells_per_metre();
        let (sin, cos) = libm::sincosf(pose_in_map.heading_rad);
        Self {
            values: field.values(),
            width: u32::from(geometry.width()),
            height: u32::from(geometry.height()),
            x: (pose_in_map.x_m - geometry.origin_in_map().x_m) * scale + nearest_f32(SHIFT),
            y: (pose_in_map.y_m - geometry.origin_in_map().y_m) * scale + nearest_f32(SHIFT),
            sin: sin * scale,
            cos: cos * scale,
        }
    }

    /// Stored distance at the end of a beam; outside the map nothing explains it.
    #[inline]
    fn centimetres(&self, hit: Point2) -> u8 {
        let column = saturating_i32(self.x + self.cos * hit.x_m - self.sin * hit.y_m);
        let row = saturating_i32(self.y + self.sin * hit.x_m + self.cos * hit.y_m);
        let column = truncating_u32(column.wrapping_sub(SHIFT));
        let row = truncating_u32(row.wrapping_sub(SHIFT));
        if column >= self.width || row >= self.height {
            return 200;
        }
        // Both below 2¹⁶: the product fits.
        let index = row.wrapping_mul(self.width).wrapping_add(column);
        self.values.get(exact_usize(index)).copied().unwrap_or(200)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping::GridCoordinates;
    use floorguard_mapping::{Grid, GridGeometry, fill_distances};
    use std::vec;

    /// The test values of the book, Cleaning: Likelihood field.
    #[test]
    fn golden_likelihoods() {
        let model = RangeModel::new(RangeModelConfig { hit_deviation_m: 0.2, ..RangeModelConfig::XTION });
        for (distance, expected) in
            [(0.0, 0.962_5), (0.1, 0.850_872), (0.2, 0.588_704), (0.5, 0.054_240), (2.0, 0.012_5)]
        {
            assert!((model.likelihood(distance) - expected).abs() < 1e-5, "{distance}");
        }
    }

    #[test]
    fn the_right_place_explains_the_scan_best() {
        let geometry = GridGeometry::new(100, 100, 0.05, Point2::new(-1.0, -1.0)).unwrap();
        let mut field = Grid::new(geometry, vec![0_u8; 10_000]).unwrap();
        let mut scratch = Grid::new(geometry, vec![0_u8; 10_000]).unwrap();
        fill_distances(&mut field, &mut scratch, |i| {
            let GridCoordinates { column, row } = geometry.coordinates(i);
            column == 80 || row == 90
        });
        let model = RangeModel::new(RangeModelConfig::XTION);
        let pose = Pose2::new(1.0, 1.0, 0.4);
        let hits: std::vec::Vec<Point2> = (0..20)
            .map(|i| pose.inverse().transform(Point2::new(3.025, 0.5 + 0.1 * i as f32)))
            .chain((0..20).map(|i| pose.inverse().transform(Point2::new(0.1 * i as f32, 3.525))))
            .collect();
        let here = model.log_likelihood(&field, pose, &hits);
        for other in [Pose2::new(1.2, 1.0, 0.4), Pose2::new(1.0, 0.8, 0.4), Pose2::new(1.0, 1.0, 0.5)] {
            assert!(model.log_likelihood(&field, other, &hits) < here);
        }
        assert_eq!(model.explained_share(&field, pose, &hits), Some(1.0));
        assert!(model.explained_share(&field, Pose2::new(0.0, 0.0, 1.4), &hits).unwrap() < 0.5);
        assert_eq!(model.explained_share(&field, pose, &hits[..9]), None);
        // One outlier before a wall: a third of a beam that stands alone, and health is not judged by it.
        let outlier = [Point2::new(0.4, 0.0)];
        let loss =
            model.log_likelihood(&field, pose, &outlier) - model.log_likelihood(&field, pose, &hits[..1]);
        assert!(loss < 0.0 && loss > -1.5, "{loss}");
        assert_eq!(model.log_likelihood(&field, Pose2::new(f32::NAN, 0.0, 0.0), &[]), 0.0);
    }
}
