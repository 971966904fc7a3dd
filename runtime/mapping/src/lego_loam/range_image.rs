//! Returns of a sweep as a picture of ranges.

use floorguard_mapping::lidar_odometry::SweepReturn;
use nalgebra::Vector3;

use super::config::LegoLoamConfig;

/// A return in its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) point: Vector3<f32>,
    pub(super) range_m: f32,
    /// When within the sweep, 0 to 1.
    pub(super) time_share: f32,
}

/// Rows from the lowest laser up; columns counter-clockwise from behind.
#[derive(Clone, Debug)]
pub(super) struct RangeImage {
    pub(super) rows: usize,
    pub(super) columns: usize,
    cells: Vec<Option<Cell>>,
}

impl RangeImage {
    /// A later return takes the place of an earlier one in the same cell.
    pub(super) fn new(sweep: &[SweepReturn], config: &LegoLoamConfig) -> Self {
        let mut image = Self {
            rows: config.rows,
            columns: config.columns,
            cells: vec![None; config.rows * config.columns],
        };
        for each in sweep {
            let point = each.point_in_sensor;
            if !point.iter().all(|value| value.is_finite()) {
                continue;
            }
            let Some(index) = image.cell_of(&point, config) else { continue };
            let range_m = libm::sqrtf(point.norm_squared());
            if range_m >= config.range_least_m {
                image.cells[index] = Some(Cell { point, range_m, time_share: each.time_share });
            }
        }
        image
    }

    fn cell_of(&self, point: &Vector3<f32>, config: &LegoLoamConfig) -> Option<usize> {
        let elevation_deg = libm::atan2f(point.z, libm::hypotf(point.x, point.y)).to_degrees();
        let row = libm::floorf((elevation_deg + config.bottom_deg) / config.row_deg);
        if !(0.0..self.rows as f32).contains(&row) {
            return None;
        }
        let azimuth_deg = libm::atan2f(point.x, point.y).to_degrees();
        let column_deg = 360.0 / self.columns as f32;
        let column = self.columns as i32 / 2 - libm::roundf((azimuth_deg - 90.0) / column_deg) as i32;
        let column = column.rem_euclid(self.columns as i32) as usize;
        Some(row as usize * self.columns + column)
    }

    /// What is in a cell.
    pub(super) fn at(&self, row: usize, column: usize) -> Option<&Cell> {
        self.cells.get(row * self.columns + column)?.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_where_the_program_has_them() {
        let config = LegoLoamConfig::default();
        let image = RangeImage::new(&[], &config);
        let cell = |x: f32, y: f32, z: f32| {
            let index = image.cell_of(&Vector3::new(x, y, z), &config).unwrap();
            [index / 1_800, index % 1_800]
        };
        // Ahead in the middle, to the left a quarter on, behind the seam.
        let ahead_right_left = [cell(2.0, 0.0, 0.0), cell(0.0, -2.0, 0.0), cell(0.0, 2.0, 0.0)];
        assert_eq!(ahead_right_left, [[7, 900], [7, 450], [7, 1350]]);
        assert_eq!(cell(-2.0, -0.001, 0.0)[1], 0);
        // The lowest laser is kept in its row; nothing lies below it, or above the highest.
        let low = -libm::tanf(15.0_f32.to_radians());
        assert_eq!(cell(1.0, 0.0, low)[0], 0);
        assert_eq!(cell(1.0, 0.0, -low)[0], 15);
        assert_eq!(image.cell_of(&Vector3::new(1.0, 0.0, -0.35), &config), None);
        assert_eq!(image.cell_of(&Vector3::new(1.0, 0.0, 0.35), &config), None);
    }

    #[test]
    fn near_returns_and_earlier_ones_are_left_out() {
        let each = |x: f32, time_share: f32| SweepReturn {
            point_in_sensor: Vector3::new(x, 0.0, 0.0),
            time_share,
            ring: 7,
        };
        let bad = SweepReturn { point_in_sensor: Vector3::new(f32::NAN, 1.0, 0.0), time_share: 0.0, ring: 7 };
        let image = RangeImage::new(
            &[each(3.0, 0.1), each(5.0, 0.2), each(0.9, 0.3), bad],
            &LegoLoamConfig::default(),
        );
        assert_eq!(image.at(7, 900).map(|cell| cell.range_m), Some(5.0));
        assert_eq!(image.cells.iter().flatten().count(), 1);
    }
}
