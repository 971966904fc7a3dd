//! Neighbouring columns of the factor that have nearly the same rows are kept as one dense group.

/// Columns `first` to `last` and the rows below them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Group {
    pub(super) first: usize,
    pub(super) last: usize,
    /// Rows below `last`, rising.
    pub(super) below: Vec<usize>,
    /// Blocks that are kept although they are zero.
    zeros: usize,
}

/// Share of zeros with which a group of so many columns at most may be made.
const ZEROS_MOST: [ZeroLimit; 3] = [
    ZeroLimit { columns_max: 4, share: 0.5 },
    ZeroLimit { columns_max: 16, share: 0.15 },
    ZeroLimit { columns_max: usize::MAX, share: 0.05 },
];

struct ZeroLimit {
    columns_max: usize,
    share: f64,
}

impl Group {
    fn columns(&self) -> usize {
        self.last - self.first + 1
    }

    /// This group with the one before it, whose parent is in this one.
    fn with(&self, before: &Self) -> Self {
        let added = before.columns() * (self.columns() + self.below.len() - before.below.len());
        let zeros = self.zeros + before.zeros + added;
        Self { first: before.first, last: self.last, below: self.below.clone(), zeros }
    }

    fn is_dense_enough(&self) -> bool {
        let columns = self.columns();
        let blocks = columns * (columns + 1) / 2 + columns * self.below.len();
        let limit = ZEROS_MOST.iter().find(|limit| columns <= limit.columns_max);
        limit.is_some_and(|limit| self.zeros as f64 <= limit.share * blocks as f64)
    }

    /// Whether the group that ends before this one passes on to it.
    fn continues(&self, before: &Self) -> bool {
        before.last + 1 == self.first && before.below.first().is_some_and(|parent| *parent <= self.last)
    }
}

/// The groups of a factor. `later` has, for each column, the larger ones that share an equation with it; the columns are
/// in postorder. Cost: the blocks of the factor, each list sorted once.
pub(super) fn column_groups(later: &[Vec<usize>], parents: &[Option<usize>]) -> Vec<Group> {
    let count = later.len();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (column, parent) in parents.iter().enumerate() {
        if let Some(parent) = parent {
            children[*parent].push(column);
        }
    }
    let mut lists: Vec<Vec<usize>> = vec![Vec::new(); count];
    let mut seen = vec![usize::MAX; count];
    let mut groups: Vec<Group> = Vec::new();
    for column in 0..count {
        seen[column] = column;
        let mut list = Vec::new();
        let inherited = children[column].iter().flat_map(|child| lists[*child].iter());
        for &row in later[column].iter().chain(inherited) {
            if seen[row] != column {
                seen[row] = column;
                list.push(row);
            }
        }
        list.sort_unstable();
        // A list is read by the parent alone.
        for &child in &children[column] {
            lists[child] = Vec::new();
        }
        let group = Group { first: column, last: column, below: list.clone(), zeros: 0 };
        add(&mut groups, group, |merged| merged.zeros == 0);
        lists[column] = list;
    }
    // Whole groups first, as above: a few zeros must not cut one of them in two.
    let mut merged = Vec::with_capacity(groups.len());
    for group in groups {
        add(&mut merged, group, Group::is_dense_enough);
    }
    merged
}

/// Adds a group, and merges it with the groups before it as long as that is accepted.
fn add(groups: &mut Vec<Group>, group: Group, is_accepted: fn(&Group) -> bool) {
    let mut group = group;
    while let Some(before) = groups.last().filter(|before| group.continues(before)) {
        let merged = group.with(before);
        if !is_accepted(&merged) {
            break;
        }
        group = merged;
        groups.pop();
    }
    groups.push(group);
}
