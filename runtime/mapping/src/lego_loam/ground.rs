//! Ground: returns of neighbouring low lasers with a flat line between them.

use super::config::LegoLoamConfig;
use super::range_image::RangeImage;

/// Whether each cell is ground, row by row.
pub(super) fn ground(image: &RangeImage, config: &LegoLoamConfig) -> Vec<bool> {
    let mut is_ground = vec![false; image.rows * image.columns];
    for column in 0..image.columns {
        for row in 0..config.ground_rows {
            let (Some(low), Some(high)) = (image.at(row, column), image.at(row + 1, column)) else {
                continue;
            };
            let step = high.point - low.point;
            let rise_deg = libm::atan2f(step.z, libm::hypotf(step.x, step.y)).to_degrees();
            if rise_deg.abs() <= config.ground_deg {
                is_ground[row * image.columns + column] = true;
                is_ground[(row + 1) * image.columns + column] = true;
            }
        }
    }
    is_ground
}
