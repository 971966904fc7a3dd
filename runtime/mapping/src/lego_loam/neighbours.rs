//! The nearest points of a map.

use std::collections::HashMap;

use nalgebra::Vector3;

/// Neighbours that a feature is laid onto.
pub(super) const NEIGHBOURS: usize = 5;
/// The farthest of them is at most this far away, metres; also the edge of a cell.
const WITHIN_M: f32 = 1.0;

/// Points by cells of a metre.
#[derive(Clone, Debug, Default)]
pub(super) struct PointIndex {
    cells: HashMap<[i32; 3], Vec<Vector3<f32>>>,
    count: usize,
}

fn cell_of(point: &Vector3<f32>) -> [i32; 3] {
    point.map(|value| libm::floorf(value / WITHIN_M) as i32).into()
}

impl PointIndex {
    pub(super) fn new(points: &[Vector3<f32>]) -> Self {
        let mut index = Self { cells: HashMap::new(), count: points.len() };
        for point in points {
            index.cells.entry(cell_of(point)).or_default().push(*point);
        }
        index
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The five nearest points, if all are within a metre.
    pub(super) fn nearest(&self, point: &Vector3<f32>) -> Option<[Vector3<f32>; NEIGHBOURS]> {
        let [x, y, z] = cell_of(point);
        let mut best = [(WITHIN_M * WITHIN_M, Vector3::zeros()); NEIGHBOURS];
        let mut found = 0;
        for key in (0..27).map(|cell| [x + cell % 3 - 1, y + cell / 3 % 3 - 1, z + cell / 9 - 1]) {
            for other in self.cells.get(&key).into_iter().flatten() {
                let square = (other - point).norm_squared();
                if square < best[NEIGHBOURS - 1].0 {
                    found += 1;
                    let place = best.partition_point(|(nearer, _)| *nearer <= square);
                    best[place..].rotate_right(1);
                    best[place] = (square, *other);
                }
            }
        }
        (found >= NEIGHBOURS).then(|| best.map(|(_, point)| point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_nearest_are_those_of_a_plain_search() {
        let number = |seed: u32| libm::sinf(seed as f32 * 12.9898) * 1.5;
        let points: Vec<_> =
            (0..400).map(|i| Vector3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2))).collect();
        let index = PointIndex::new(&points);
        let mut found = 0;
        for seed in 0..60 {
            let here = Vector3::new(number(5_000 + seed), number(6_000 + seed), number(7_000 + seed));
            let mut squares: Vec<f32> = points.iter().map(|point| (point - here).norm_squared()).collect();
            squares.sort_by(f32::total_cmp);
            let nearest = index.nearest(&here);
            assert_eq!(nearest.is_some(), squares[4] < 1.0, "{squares:?}");
            for (point, square) in nearest.into_iter().flatten().zip(&squares) {
                assert!(((point - here).norm_squared() - square).abs() < 1.0e-6);
            }
            found += usize::from(nearest.is_some());
        }
        assert!(found > 10);
    }
}
