//! The best one-to-one pairing, through a maintained Hungarian solver.

use pathfinding::kuhn_munkres::kuhn_munkres;
use pathfinding::matrix::Matrix;

/// Pairs rows with columns so that the sum of `weight(row, column)` is largest. Pairs of weight 0 are not worth making
/// and left out. Weights are ≥ 0; the result is ordered by row.
pub(super) fn best_pairs(
    rows: usize,
    columns: usize,
    weight: impl Fn(usize, usize) -> i64,
) -> Vec<(usize, usize)> {
    if rows == 0 || columns == 0 {
        return Vec::new();
    }
    // The solver wants no more rows than columns.
    let turned = rows > columns;
    let weights = if turned {
        Matrix::from_fn(columns, rows, |(column, row)| weight(row, column))
    } else {
        Matrix::from_fn(rows, columns, |(row, column)| weight(row, column))
    };
    let (_, partners) = kuhn_munkres(&weights);
    let mut pairs: Vec<_> = partners
        .into_iter()
        .enumerate()
        .map(|(first, second)| if turned { (second, first) } else { (first, second) })
        .filter(|(row, column)| weight(*row, *column) > 0)
        .collect();
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::best_pairs;

    #[test]
    fn the_sum_counts_not_the_first_choice() {
        let weights = [[5, 4], [4, 0]];
        assert_eq!(best_pairs(2, 2, |row, column| weights[row][column]), [(0, 1), (1, 0)]);
    }

    #[test]
    fn more_rows_than_columns_and_worthless_pairs() {
        let weights = [[0], [3], [7]];
        assert_eq!(best_pairs(3, 1, |row, column| weights[row][column]), [(2, 0)]);
        assert_eq!(best_pairs(1, 3, |_, _| 0), []);
        assert_eq!(best_pairs(0, 3, |_, _| 1), []);
    }
}
