//! Many removal boxes at once: which of them can hold a point is looked up by its square of the floor.

use floorguard_mapping::people_removal::RemovalBox;
use floorguard_types::geometry::Point3;

/// Boxes by squares of the floor.
#[derive(Clone, Debug)]
pub struct BoxIndex {
    boxes: Vec<RemovalBox>,
    corner_m: [f32; 2],
    per_m: f32,
    columns: usize,
    rows: usize,
    /// For each square the range of its numbers in `numbers`.
    starts: Vec<u32>,
    numbers: Vec<u32>,
}

/// Edge of a square, metres; doubled until there are few enough squares.
const SQUARE_M: f32 = 0.5;
const SQUARES_MAX: f32 = 4.0e6;

impl BoxIndex {
    /// An index; boxes with numbers that are not finite are left out. Cost: the squares and boxes once.
    #[must_use]
    pub fn new(boxes: &[RemovalBox]) -> Self {
        let finite = |point: Point3| point.x_m.is_finite() && point.y_m.is_finite() && point.z_m.is_finite();
        let boxes: Vec<RemovalBox> = boxes
            .iter()
            .copied()
            .filter(|each| finite(each.lowest_in_map) && finite(each.highest_in_map))
            .collect();
        let low = |of: fn(&RemovalBox) -> f32| boxes.iter().map(of).fold(f32::INFINITY, f32::min);
        let high = |of: fn(&RemovalBox) -> f32| boxes.iter().map(of).fold(f32::NEG_INFINITY, f32::max);
        let corner_m = [low(|each| each.lowest_in_map.x_m), low(|each| each.lowest_in_map.y_m)];
        let extent_m = [
            (high(|each| each.highest_in_map.x_m) - corner_m[0]).max(0.0),
            (high(|each| each.highest_in_map.y_m) - corner_m[1]).max(0.0),
        ];
        let mut edge_m = SQUARE_M;
        while (extent_m[0] / edge_m + 1.0) * (extent_m[1] / edge_m + 1.0) > SQUARES_MAX {
            edge_m *= 2.0;
        }
        let count = |extent_m: f32| if boxes.is_empty() { 0 } else { (extent_m / edge_m) as usize + 1 };
        let (columns, rows) = (count(extent_m[0]), count(extent_m[1]));
        let mut index = Self {
            boxes,
            corner_m,
            per_m: 1.0 / edge_m,
            columns,
            rows,
            starts: Vec::new(),
            numbers: Vec::new(),
        };
        index.fill();
        index
    }

    fn fill(&mut self) {
        let mut squares: Vec<Vec<u32>> = vec![Vec::new(); self.columns * self.rows];
        for (number, each) in self.boxes.iter().enumerate() {
            let axis =
                |value: f32, axis: usize| ((value - self.corner_m[axis]) * self.per_m).max(0.0) as usize;
            let (low, high) = (each.lowest_in_map, each.highest_in_map);
            for row in axis(low.y_m, 1)..=axis(high.y_m, 1).min(self.rows.saturating_sub(1)) {
                for column in axis(low.x_m, 0)..=axis(high.x_m, 0).min(self.columns.saturating_sub(1)) {
                    squares[row * self.columns + column].push(number as u32);
                }
            }
        }
        for square in squares {
            self.starts.push(self.numbers.len() as u32);
            self.numbers.extend(square);
        }
        self.starts.push(self.numbers.len() as u32);
    }

    /// Whether a point of the map lies in any box. Cost: the boxes over its square.
    ///
    /// ```
    /// use floorguard_mapping::people_removal::{RemovalBox, RemovalSize};
    /// use floorguard_mapping_host::clean::BoxIndex;
    /// use floorguard_types::geometry::Point3;
    ///
    /// let around = |x_m| RemovalBox::around(Point3::new(x_m, 0.0, 1.0), 0.0, RemovalSize::default());
    /// let index = BoxIndex::new(&[around(1.0), around(7.0)]);
    /// assert!(index.contains(Point3::new(7.4, 0.3, 0.5)));
    /// assert!(!index.contains(Point3::new(4.0, 0.3, 0.5)));
    /// assert!(!BoxIndex::new(&[]).contains(Point3::new(0.0, 0.0, 0.5)));
    /// ```
    #[inline]
    #[must_use]
    pub fn contains(&self, point: Point3) -> bool {
        let column = (point.x_m - self.corner_m[0]) * self.per_m;
        let row = (point.y_m - self.corner_m[1]) * self.per_m;
        // Also false for a NaN.
        let is_inside = column >= 0.0 && row >= 0.0 && column < self.columns as f32 && row < self.rows as f32;
        if !is_inside {
            return false;
        }
        let square = row as usize * self.columns + column as usize;
        let range = self.starts[square] as usize..self.starts[square + 1] as usize;
        self.numbers[range].iter().any(|number| self.boxes[*number as usize].contains(point))
    }
}
