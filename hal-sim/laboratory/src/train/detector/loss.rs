//! What a picture's grids should be, and how far they are from it.

use super::convolution::Planes;
use super::network::{CELL, STRIDES, sigmoid};
use super::pictures::LabelledPerson;

/// People up to these heights belong to the grids of steps 8 and 16, pixels; higher ones to the last.
const HEIGHTS_PX: [f32; 2] = [40.0, 80.0];
/// A cell is a person's where its middle lies within this many steps of the person's middle.
const NEAR_STEPS: f32 = 0.8;
/// Weight of a person's cell against one without.
const PERSON_WEIGHT: f32 = 4.0;
/// Where an error of the box stops to count as a square.
const SMOOTH: f32 = 0.2;

/// What a cell should hold.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Target {
    Empty,
    /// Near a person, or a doubtful one: anything is right.
    Anything,
    /// Place and size as the grid writes them.
    Person([f32; 4]),
}

fn target(people: &[LabelledPerson], grid: usize, [column, row]: [usize; 2]) -> Target {
    let step = STRIDES[grid] as f32;
    let middle = [(column as f32 + 0.5) * step, (row as f32 + 0.5) * step];
    let mut found = Target::Empty;
    for LabelledPerson { edges, is_doubtful } in people {
        let [left, top, right, bottom] = *edges;
        let (across, down) = (right - left, bottom - top);
        let centre = [0.5 * (left + right), 0.5 * (top + bottom)];
        let off = [(middle[0] - centre[0]).abs(), (middle[1] - centre[1]).abs()];
        let own_grid = HEIGHTS_PX.iter().filter(|limit| down > **limit).count();
        let is_own = own_grid == grid && off[0] <= NEAR_STEPS * step && off[1] <= NEAR_STEPS * step;
        if is_own && !is_doubtful {
            let logarithm = |size: f32| libm::logf(size.max(1.0) / step);
            return Target::Person([
                centre[0] / step - column as f32,
                centre[1] / step - row as f32,
                logarithm(across),
                logarithm(down),
            ]);
        }
        if off[0] <= 0.5 * across + 0.5 * step && off[1] <= 0.5 * down + 0.5 * step {
            found = Target::Anything;
        }
    }
    found
}

/// The loss of a picture, and its slope in each number of the grids.
#[must_use]
pub fn loss(grids: &[Planes], people: &[LabelledPerson]) -> (f32, Vec<Planes>) {
    let mut sum = 0.0;
    let mut slopes = Vec::new();
    for (number, grid) in grids.iter().enumerate() {
        let mut slope = Planes::zero(grid.shape);
        let [_, rows, columns] = grid.shape;
        let area = rows * columns;
        for cell in 0..area {
            let sure = (CELL - 1) * area + cell;
            let score = sigmoid(grid.values[sure]);
            let (wanted, weight) = match target(people, number, [cell % columns, cell / columns]) {
                Target::Anything => continue,
                Target::Empty => (0.0, 1.0),
                Target::Person(place) => {
                    for (index, wanted) in place.into_iter().enumerate() {
                        let off = grid.values[index * area + cell] - wanted;
                        let (cost, steep) = if off.abs() < SMOOTH {
                            (0.5 * off * off / SMOOTH, off / SMOOTH)
                        } else {
                            (off.abs() - 0.5 * SMOOTH, off.signum())
                        };
                        sum += cost;
                        slope.values[index * area + cell] = steep;
                    }
                    (1.0, PERSON_WEIGHT)
                }
            };
            let right = if wanted > 0.5 { score } else { 1.0 - score };
            sum -= weight * libm::logf(right.max(1.0e-7));
            slope.values[sure] = weight * (score - wanted);
        }
        slopes.push(slope);
    }
    (sum, slopes)
}
