//! What of a factorisation depends on the pattern alone.

use super::BLOCK;
use super::group::{Group, column_groups};
use super::order::fill_reducing_order;
use super::tree::{elimination_tree, postorder};

/// Rows of a front are filled up to a multiple of this.
const STRIDE: usize = 4;

/// Where a block of the matrix lies in its front.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Index of the block.
    pub(super) block: u32,
    /// Block row and block column in the front.
    pub(super) row: u32,
    pub(super) column: u32,
}

/// A group of columns, its dense front, and where it lies in the factor. Rows and columns of a front are numbers; the
/// columns of the group come first.
#[derive(Clone, Debug)]
pub(super) struct Front {
    /// First position of the group.
    pub(super) first: usize,
    /// Columns that are eliminated here.
    pub(super) pivots: usize,
    /// Rows of the front, without the filling.
    pub(super) size: usize,
    /// Rows of the front, with the filling: from column to column.
    pub(super) height: usize,
    /// Positions of the blocks below.
    pub(super) below: Vec<usize>,
    /// The front that takes what is left.
    pub(super) parent: Option<usize>,
    /// Block row of each block below in the parent's front.
    pub(super) in_parent: Vec<usize>,
    /// Fronts that pass on to this one.
    pub(super) children: usize,
    /// Blocks of the matrix that begin here.
    pub(super) entries: Vec<Entry>,
    /// First number in the factor.
    pub(super) start: usize,
}

impl Front {
    /// Rows of what is passed on, counted from `rest_base`: it begins at a multiple of the stride.
    pub(super) const fn rest_base(&self) -> usize {
        self.pivots - self.pivots % STRIDE
    }

    pub(super) const fn rest_height(&self) -> usize {
        self.height - self.rest_base()
    }

    /// Numbers of what is passed on.
    pub(super) const fn rest_len(&self) -> usize {
        self.rest_height() * (self.size - self.pivots)
    }
}

/// The order of the variables and the fronts.
#[derive(Clone, Debug)]
pub(in crate::pose_graph) struct Analysis {
    /// Position of each variable in the order of elimination.
    pub(super) positions: Vec<usize>,
    /// In postorder.
    pub(super) fronts: Vec<Front>,
    /// Front of each position.
    pub(super) front_of: Vec<usize>,
    /// Numbers of the factor.
    pub(super) factor_len: usize,
}

impl Analysis {
    /// Of a symmetric matrix. `lower` has, for each variable, itself and the larger ones that share a block with it,
    /// rising; the blocks are counted in this order.
    pub(in crate::pose_graph) fn new(lower: &[Vec<usize>]) -> Self {
        let order = fill_reducing_order(lower);
        let positions = inverse(&order);
        let parents = elimination_tree(&Sides::new(lower, &positions).earlier);
        let after = postorder(&parents);
        let order: Vec<usize> = after.iter().map(|column| order[*column]).collect();
        let (positions, renumbered) = (inverse(&order), inverse(&after));
        let parents: Vec<Option<usize>> =
            after.iter().map(|column| parents[*column].map(|parent| renumbered[parent])).collect();
        let groups = column_groups(&Sides::new(lower, &positions).later, &parents);
        Self::with_groups(lower, positions, groups)
    }

    fn with_groups(lower: &[Vec<usize>], positions: Vec<usize>, groups: Vec<Group>) -> Self {
        let mut front_of = vec![0; positions.len()];
        for (index, group) in groups.iter().enumerate() {
            front_of[group.first..=group.last].fill(index);
        }
        let mut factor_len = 0;
        let mut fronts: Vec<Front> = Vec::with_capacity(groups.len());
        for group in groups {
            let pivots = BLOCK * (group.last + 1 - group.first);
            let size = pivots + BLOCK * group.below.len();
            let front = Front {
                first: group.first,
                pivots,
                size,
                height: stride_height(size),
                parent: group.below.first().map(|row| front_of[*row]),
                below: group.below,
                in_parent: Vec::new(),
                children: 0,
                entries: Vec::new(),
                start: factor_len,
            };
            factor_len += front.height * pivots;
            fronts.push(front);
        }
        let mut analysis = Self { positions, fronts, front_of, factor_len };
        analysis.link();
        analysis.place_entries(lower);
        analysis
    }

    /// Where each front's rest goes in its parent.
    fn link(&mut self) {
        for index in 0..self.fronts.len() {
            let Some(parent) = self.fronts[index].parent else { continue };
            let places = self.fronts[index].below.iter().map(|row| self.row_in(parent, *row)).collect();
            self.fronts[index].in_parent = places;
            self.fronts[parent].children += 1;
        }
    }

    /// Block row of a position in a front that has it.
    fn row_in(&self, front: usize, position: usize) -> usize {
        let front = &self.fronts[front];
        let columns = front.pivots / BLOCK;
        if position < front.first + columns {
            position - front.first
        } else {
            columns + front.below.binary_search(&position).unwrap_or(0)
        }
    }

    fn place_entries(&mut self, lower: &[Vec<usize>]) {
        let mut block = 0;
        for (variable, list) in lower.iter().enumerate() {
            for &other in list {
                let (a, b) = (self.positions[variable], self.positions[other]);
                let front = self.front_of[a.min(b)];
                let (row, column) = (self.row_in(front, a.max(b)), a.min(b) - self.fronts[front].first);
                let [number, row, column] = [block, row, column].map(|number| number as u32);
                self.fronts[front].entries.push(Entry { block: number, row, column });
                block += 1;
            }
        }
    }

    /// Position of a variable in the order of elimination: a block is stored with the rows of the later variable.
    pub(in crate::pose_graph) fn position(&self, variable: usize) -> usize {
        self.positions[variable]
    }
}

/// Filled up; never a multiple of a page's columns, which would share one line of the processor's cache.
fn stride_height(size: usize) -> usize {
    let height = size.next_multiple_of(STRIDE);
    if height.is_multiple_of(64) { height + STRIDE } else { height }
}

fn inverse(order: &[usize]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    for (place, index) in order.iter().enumerate() {
        places[*index] = place;
    }
    places
}

/// The positions before and after each position that share a block with it.
struct Sides {
    earlier: Vec<Vec<usize>>,
    later: Vec<Vec<usize>>,
}

impl Sides {
    fn new(lower: &[Vec<usize>], positions: &[usize]) -> Self {
        let mut earlier = vec![Vec::new(); lower.len()];
        let mut later = vec![Vec::new(); lower.len()];
        for (variable, list) in lower.iter().enumerate() {
            for &other in list.iter().filter(|other| **other != variable) {
                let (a, b) = (positions[variable], positions[other]);
                later[a.min(b)].push(a.max(b));
                earlier[a.max(b)].push(a.min(b));
            }
        }
        Self { earlier, later }
    }
}
