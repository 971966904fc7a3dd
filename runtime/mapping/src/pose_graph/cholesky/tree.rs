//! The elimination tree: which column a column of the factor passes on to.

/// Parent of each column; `None` at a root. `earlier` has, for each column, the smaller ones that share an equation with
/// it (Liu 1990, section 3).
pub(super) fn elimination_tree(earlier: &[Vec<usize>]) -> Vec<Option<usize>> {
    let mut parents = vec![None; earlier.len()];
    // Path compression: the farthest known ancestor of each column.
    let mut ancestors: Vec<Option<usize>> = vec![None; earlier.len()];
    for (column, list) in earlier.iter().enumerate() {
        for &start in list {
            let mut here = start;
            while here < column {
                match ancestors[here].replace(column) {
                    Some(next) => here = next,
                    None => {
                        parents[here] = Some(column);
                        break;
                    }
                }
            }
        }
    }
    parents
}

/// The columns with every child before its parent and every subtree in one piece.
pub(super) fn postorder(parents: &[Option<usize>]) -> Vec<usize> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parents.len()];
    let mut waiting = Vec::new();
    // Backwards, so that the smallest child is taken first.
    for (column, parent) in parents.iter().enumerate().rev() {
        match parent {
            Some(parent) => children[*parent].push(column),
            None => waiting.push(column),
        }
    }
    let mut order = Vec::with_capacity(parents.len());
    while let Some(&column) = waiting.last() {
        match children[column].pop() {
            Some(child) => waiting.push(child),
            None => {
                order.push(column);
                waiting.pop();
            }
        }
    }
    order
}
