//! The published accuracy tables, and their judge: elevations of a box's cells against its true distance.

use floorguard_mapping::sliding_window::{CellContent, Face, WindowPoint};

/// Mean and standard deviation of a box's elevations, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Metres.
    pub mean: f64,
    /// Of all cells, metres.
    pub deviation: f64,
}

/// Cells at three resolutions, metres.
pub const RESOLUTIONS: [f64; 3] = [0.025, 0.05, 0.1];
/// Distances of the box, metres.
pub const DISTANCES: [f64; 2] = [1.0, 1.5];

/// Table 1 of Dalmedico et al. 2019: means of three scans, by resolution and distance.
pub const TABLE_ONE: [[Spread; 2]; 3] = [
    [Spread { mean: 1.022, deviation: 0.0466 }, Spread { mean: 1.5292, deviation: 0.0357 }],
    [Spread { mean: 1.0339, deviation: 0.0667 }, Spread { mean: 1.5413, deviation: 0.0465 }],
    [Spread { mean: 1.0689, deviation: 0.1014 }, Spread { mean: 1.5667, deviation: 0.0795 }],
];

/// Table 2 of Dalmedico et al. 2019, at 0.05 m and 1 m. The printed deviation of the front grid (0.1014) is that of the 0.1 m
/// row of Table 1; that of its 0.05 m row stands here.
pub const TABLE_TWO: [(Face, Spread); 3] = [
    (Face::Front, Spread { mean: 1.0339, deviation: 0.0667 }),
    (Face::Right, Spread { mean: 1.0417, deviation: 0.0460 }),
    (Face::Left, Spread { mean: 1.0250, deviation: 0.0337 }),
];

/// How far a mean may be from the published one, metres.
pub const TOLERANCE: f64 = 0.02;
/// With the nearest point in each cell the mean error is at most this part of the published one.
pub const NEAREST_PART: f64 = 0.5;

/// The box: half of its width, lower and upper end, metres.
const HALF_WIDTH: f64 = 0.2;
const HEIGHTS: [f64; 2] = [0.1, 0.5];

/// Normals of the grids, degrees.
fn normal(face: Face) -> f64 {
    match face {
        Face::Front => 0.0,
        Face::Left => 75.0_f64.to_radians(),
        Face::Right => -75.0_f64.to_radians(),
    }
}

/// Elevations of the cells that belong to the box in a grid whose cells have an edge.
#[must_use]
pub fn box_elevations(points: &[WindowPoint], face: Face, resolution: f64) -> Vec<f64> {
    let columns = (6.2 / resolution).round() as usize;
    let (sin, cos) = normal(face).sin_cos();
    let of_box = |one: &&WindowPoint| {
        let along = ((one.index % columns) as f64 + 0.5) * resolution - 3.1;
        let up = ((one.index / columns) as f64 + 0.5) * resolution;
        one.face == face
            && one.content == CellContent::Surface
            && along.abs() <= HALF_WIDTH
            && (HEIGHTS[0]..=HEIGHTS[1]).contains(&up)
    };
    let elevation = |one: &WindowPoint| f64::from(one.point.x_m) * cos + f64::from(one.point.y_m) * sin;
    points.iter().filter(of_box).map(elevation).collect()
}

/// Cells that the box covers in a grid.
#[must_use]
pub fn box_cells(resolution: f64) -> usize {
    let along = (2.0 * HALF_WIDTH / resolution).round() as usize;
    along * ((HEIGHTS[1] - HEIGHTS[0]) / resolution).round() as usize
}

/// Mean and population deviation; NaN without a value.
#[must_use]
pub fn spread(values: &[f64]) -> Spread {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    Spread { mean, deviation }
}

/// The mean of several scans.
#[must_use]
pub fn mean_spread(scans: &[Spread]) -> Spread {
    let mean = |of: fn(&Spread) -> f64| scans.iter().map(of).sum::<f64>() / scans.len() as f64;
    Spread { mean: mean(|one| one.mean), deviation: mean(|one| one.deviation) }
}

/// By resolution and distance.
pub type Table = [[Spread; 2]; 3];

/// As published: every mean within 2 cm of Table 1, and the error grows with the cell.
#[must_use]
pub fn is_as_published(table: &Table) -> bool {
    let near = |(row, published): (&[Spread; 2], &[Spread; 2])| {
        row.iter().zip(published).all(|(one, published)| (one.mean - published.mean).abs() <= TOLERANCE)
    };
    let grows =
        |distance: usize| table.windows(2).all(|rows| rows[0][distance].mean < rows[1][distance].mean);
    table.iter().zip(&TABLE_ONE).all(near) && grows(0) && grows(1)
}

/// Table 2: all grids together as far from the published mean as Table 1 may be, and no farther apart than published.
#[must_use]
pub fn is_alike(sides: &[Spread; 3]) -> bool {
    let published = TABLE_TWO.map(|(_, one)| one.mean);
    let found = sides.map(|one| one.mean);
    let mean = |values: &[f64; 3]| values.iter().sum::<f64>() / 3.0;
    let apart = |values: &[f64; 3]| {
        values.iter().copied().fold(f64::MIN, f64::max) - values.iter().copied().fold(f64::MAX, f64::min)
    };
    (mean(&found) - mean(&published)).abs() <= TOLERANCE && apart(&found) <= apart(&published)
}

/// Better than published: at most half of the error everywhere.
#[must_use]
pub fn is_half_of_published(table: &Table) -> bool {
    let halved = |(row, published): (&[Spread; 2], &[Spread; 2])| {
        let errors = row.iter().zip(published).zip(DISTANCES);
        errors.into_iter().all(|((one, published), truth)| {
            (one.mean - truth).abs() <= NEAREST_PART * (published.mean - truth)
        })
    };
    table.iter().zip(&TABLE_ONE).all(halved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Point3;

    /// A box in a window, cell by cell, with an error.
    fn drawn(resolution: f64, error: impl Fn(usize) -> f64) -> Vec<WindowPoint> {
        let (columns, rows) = ((6.2 / resolution).round() as usize, (2.4 / resolution).round() as usize);
        let point = |index: usize| WindowPoint {
            face: Face::Front,
            index,
            content: CellContent::Surface,
            point: Point3::new(
                (1.0 + error(index)) as f32,
                (((index % columns) as f64 + 0.5) * resolution - 3.1) as f32,
                (((index / columns) as f64 + 0.5) * resolution) as f32,
            ),
        };
        (0..columns * rows).map(point).collect()
    }

    #[test]
    fn only_cells_of_the_box_count() {
        for resolution in RESOLUTIONS {
            let elevations = box_elevations(&drawn(resolution, |_| 0.02), Face::Front, resolution);
            assert_eq!(elevations.len(), box_cells(resolution));
            let found = spread(&elevations);
            assert!((found.mean - 1.02).abs() < 1e-6 && found.deviation < 1e-6);
            assert!(box_elevations(&drawn(resolution, |_| 0.02), Face::Left, resolution).is_empty());
        }
        assert_eq!(spread(&[1.0, 3.0]), Spread { mean: 2.0, deviation: 1.0 });
        assert!(spread(&[]).mean.is_nan());
    }

    /// A judge that cannot say no is none.
    #[test]
    fn refuses_corrupted_tables() {
        assert!(is_as_published(&TABLE_ONE));
        assert!(!is_half_of_published(&TABLE_ONE));
        let shifted = TABLE_ONE.map(|row| row.map(|one| Spread { mean: one.mean + 0.021, ..one }));
        assert!(!is_as_published(&shifted), "2.1 cm too far");
        let mut flat = TABLE_ONE;
        flat[2][0].mean = flat[1][0].mean - 0.001;
        assert!(!is_as_published(&flat), "the error falls with the cell");
        let mut empty = TABLE_ONE;
        empty[1][1].mean = f64::NAN;
        assert!(!is_as_published(&empty), "no cell of the box");
        let exact = DISTANCES.map(|mean| Spread { mean, deviation: 0.0 });
        assert!(is_half_of_published(&[exact; 3]) && !is_as_published(&[exact; 3]));
        let sides = TABLE_TWO.map(|(_, one)| one);
        assert!(is_alike(&sides));
        let [front, right, left] = sides;
        assert!(!is_alike(&[front, right, Spread { mean: left.mean - 0.01, ..left }]), "one grid is off");
        assert!(!is_alike(&sides.map(|one| Spread { mean: one.mean + 0.021, ..one })));
        let near = DISTANCES.map(|mean| Spread { mean: mean - 0.02, deviation: 0.0 });
        assert!(!is_half_of_published(&[near; 3]), "2 cm too near");
    }
}
