//! Edges and flats of a sweep.

use floorguard_mapping::lidar_odometry::SweepReturn;
use nalgebra::Vector3;

use super::config::LegoLoamConfig;
use super::ground::ground;
use super::range_image::{Cell, RangeImage};
use super::segments::{Label, segments};
use super::selection::select;

/// A return that is laid onto others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// Metres in the sensor's frame at its time, or at its end after straightening.
    pub point: Vector3<f32>,
    /// Which laser, from the lowest.
    pub row: u8,
    /// When within the sweep, 0 to 1.
    pub time_share: f32,
}

/// Features of a sweep, by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// The two sharpest edges of each sector.
    pub sharp: Vec<Feature>,
    /// The twenty sharpest.
    pub less_sharp: Vec<Feature>,
    /// The four flattest returns on the ground.
    pub flat: Vec<Feature>,
    /// All that is no edge, thinned.
    pub less_flat: Vec<Feature>,
    /// Some returns of small segments.
    pub outliers: Vec<Feature>,
}

/// A return of a kept segment or of the ground, in its row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segmented {
    pub(super) feature: Feature,
    pub(super) range_m: f32,
    pub(super) column: usize,
    pub(super) is_ground: bool,
}

/// The segmented returns, row after row.
pub(super) struct SegmentedCloud {
    pub(super) returns: Vec<Segmented>,
    /// First and last index of each row that has five neighbours to both sides.
    pub(super) spans: Vec<[usize; 2]>,
    outliers: Vec<Feature>,
}

/// Of the ground, and of small segments, every fifth column is kept.
const EACH: usize = 5;
/// Neighbours to each side that the smoothness takes in.
pub(super) const SIDE: usize = 5;

impl Features {
    /// The features of a sweep.
    #[must_use]
    pub fn of(sweep: &[SweepReturn], config: &LegoLoamConfig) -> Self {
        let cloud = SegmentedCloud::new(sweep, config);
        let mut features = select(&cloud, config);
        features.outliers = cloud.outliers;
        features
    }
}

impl SegmentedCloud {
    pub(super) fn new(sweep: &[SweepReturn], config: &LegoLoamConfig) -> Self {
        let image = RangeImage::new(sweep, config);
        let is_ground = ground(&image, config);
        let labels = segments(&image, &is_ground, config);
        let mut cloud = Self { returns: Vec::new(), spans: Vec::new(), outliers: Vec::new() };
        for row in 0..image.rows {
            let first = cloud.returns.len();
            for column in 0..image.columns {
                let Some(cell) = image.at(row, column) else { continue };
                let index = row * image.columns + column;
                cloud.add(cell, [row, column], (labels[index], is_ground[index]), config);
            }
            cloud.spans.push([first + SIDE, cloud.returns.len().saturating_sub(SIDE + 1)]);
        }
        cloud
    }

    /// A single row.
    #[cfg(test)]
    pub(super) fn of(returns: Vec<Segmented>) -> Self {
        let spans = vec![[SIDE, returns.len() - SIDE - 1]];
        Self { returns, spans, outliers: Vec::new() }
    }

    fn add(
        &mut self,
        cell: &Cell,
        [row, column]: [usize; 2],
        (label, is_ground): (Label, bool),
        config: &LegoLoamConfig,
    ) {
        let feature = Feature { point: cell.point, row: row as u8, time_share: cell.time_share };
        if label == Label::Small {
            if row > config.ground_rows && column % EACH == 0 {
                self.outliers.push(feature);
            }
            return;
        }
        let is_between = column > SIDE && column < config.columns - SIDE;
        if is_ground && column % EACH != 0 && is_between {
            return;
        }
        self.returns.push(Segmented { feature, range_m: cell.range_m, column, is_ground });
    }
}

/// How much the ranges around the middle one bend: the square of the sum of differences, neither averaged nor divided by the
/// range as in the paper, since the program's thresholds are for this form.
#[must_use]
pub fn smoothness(ranges_m: &[f32; 2 * SIDE + 1]) -> f32 {
    let sum: f32 = ranges_m.iter().sum();
    let bend = sum - (2 * SIDE + 1) as f32 * ranges_m[SIDE];
    bend * bend
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothness_has_the_published_form() {
        let ranges = [2.0, 2.0, 2.0, 2.01, 2.02, 2.5, 2.02, 2.01, 2.0, 2.0, 2.0];
        assert!((smoothness(&ranges) - 24.4036).abs() < 1.0e-3, "{}", smoothness(&ranges));
        assert!(smoothness(&[3.0; 11]) < 1.0e-6);
    }
}
