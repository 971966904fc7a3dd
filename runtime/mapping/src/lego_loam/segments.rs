//! Segments: neighbours of the range image that lie on one surface.

use std::collections::VecDeque;

use super::config::LegoLoamConfig;
use super::range_image::RangeImage;

/// What a cell belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Label {
    /// Ground, or without a return.
    None,
    /// A segment that is kept.
    Kept,
    /// One that is too small.
    Small,
}

/// The label of each cell, row by row. Each cell is visited once.
pub(super) fn segments(image: &RangeImage, is_ground: &[bool], config: &LegoLoamConfig) -> Vec<Label> {
    let cells = image.rows * image.columns;
    let mut labels = vec![Label::None; cells];
    let mut is_open: Vec<bool> = (0..cells)
        .map(|cell| !is_ground[cell] && image.at(cell / image.columns, cell % image.columns).is_some())
        .collect();
    let mut queue = VecDeque::new();
    for start in 0..cells {
        if !is_open[start] {
            continue;
        }
        is_open[start] = false;
        queue.push_back(start);
        let mut members = vec![start];
        // As in the program, the row of the first return counts once another return of it joins.
        let mut has_row = vec![false; image.rows];
        while let Some(cell) = queue.pop_front() {
            for (next, along_row) in neighbours(cell, image).into_iter().flatten() {
                if is_open[next] && is_one_surface([cell, next], along_row, image, config) {
                    is_open[next] = false;
                    has_row[next / image.columns] = true;
                    members.push(next);
                    queue.push_back(next);
                }
            }
        }
        let rows = has_row.iter().filter(|has| **has).count();
        let is_kept = members.len() >= config.segment_points
            || (members.len() >= config.small_segment_points && rows >= config.small_segment_rows);
        let label = if is_kept { Label::Kept } else { Label::Small };
        members.into_iter().for_each(|cell| labels[cell] = label);
    }
    labels
}

/// Above and below, left and right; the columns close to a ring, the rows do not. With whether both are in one row.
fn neighbours(cell: usize, image: &RangeImage) -> [Option<(usize, bool)>; 4] {
    let (row, column) = (cell / image.columns, cell % image.columns);
    let in_row = |column: usize| Some((row * image.columns + column, true));
    [
        row.checked_sub(1).map(|row| (row * image.columns + column, false)),
        in_row((column + 1) % image.columns),
        in_row((column + image.columns - 1) % image.columns),
        (row + 1 < image.rows).then(|| ((row + 1) * image.columns + column, false)),
    ]
}

/// The line between two neighbours stands steeply enough against the view (Bogoslavskyi and Stachniss 2016).
fn is_one_surface([a, b]: [usize; 2], along_row: bool, image: &RangeImage, config: &LegoLoamConfig) -> bool {
    let range = |cell: usize| image.at(cell / image.columns, cell % image.columns).map(|cell| cell.range_m);
    let (Some(one), Some(other)) = (range(a), range(b)) else { return false };
    let (far, near) = (one.max(other), one.min(other));
    let step_deg = if along_row { 360.0 / image.columns as f32 } else { config.row_deg };
    let (sin, cos) = libm::sincosf(step_deg.to_radians());
    libm::atan2f(near * sin, far - near * cos).to_degrees() > config.segment_deg
}

#[cfg(test)]
mod tests {
    use floorguard_mapping::lidar_odometry::SweepReturn;
    use nalgebra::Vector3;

    use super::*;

    /// A wall across the seam behind the sensor, and a post two metres before it, `width` columns wide on `rows` rows.
    fn labels(width: i32, rows: i32) -> Vec<Label> {
        let mut sweep = Vec::new();
        for row in 0..rows.max(4) {
            for column in -40..40 {
                let angle = std::f32::consts::PI + (column as f32 * 0.2).to_radians();
                let is_post = row < rows && (10..10 + width).contains(&column);
                let range = if is_post { 3.0 } else { 5.0 };
                let elevation = (2.0 * row as f32 + 1.0).to_radians();
                let (sin, cos) = libm::sincosf(angle);
                let along = range * libm::cosf(elevation);
                let point = Vector3::new(along * cos, along * sin, range * libm::sinf(elevation));
                sweep.push(SweepReturn { point_in_sensor: point, time_share: 0.0, ring: 0 });
            }
        }
        let config = LegoLoamConfig::default();
        let image = RangeImage::new(&sweep, &config);
        segments(&image, &ground_free(&image), &config)
    }

    fn ground_free(image: &RangeImage) -> Vec<bool> {
        vec![false; image.rows * image.columns]
    }

    fn count(labels: &[Label], label: Label) -> usize {
        labels.iter().filter(|other| **other == label).count()
    }

    #[test]
    fn segments_go_across_the_seam() {
        // A post of six columns on four rows is kept; one of two columns on two rows is not.
        let wide = labels(6, 4);
        assert_eq!((count(&wide, Label::Kept), count(&wide, Label::Small)), (4 * 80, 0));
        let small = labels(2, 2);
        assert_eq!((count(&small, Label::Kept), count(&small, Label::Small)), (4 * 80 - 4, 4));
    }
}
