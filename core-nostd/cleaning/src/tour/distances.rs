//! How far it is from place to place. Whole numbers, so that the gain of an exchange is exact and the search never
//! goes in circles on rounding.

use floorguard_types::number::saturating_i32;

/// Symmetric distances between the nodes 0..n of a tour, in a unit of the caller's choice. A sum of a whole tour must
/// fit 31 bits.
pub trait Distances {
    /// Distance from one node to another, ≥ 0.
    fn between(&self, from: u16, to: u16) -> i32;
}

/// Straight lines between points, in `units_per_metre` of whatever the coordinates are in.
#[derive(Clone, Copy, Debug)]
pub struct EuclideanCells<'a> {
    /// Coordinates of the nodes.
    pub points: &'a [(f32, f32)],
    /// Units in which distances are counted, in one unit of the coordinates.
    pub scale: f32,
}

impl Distances for EuclideanCells<'_> {
    #[inline]
    fn between(&self, from: u16, to: u16) -> i32 {
        let (Some(a), Some(b)) = (self.points.get(usize::from(from)), self.points.get(usize::from(to)))
        else {
            return 0;
        };
        let (dx, dy) = (a.0 - b.0, a.1 - b.1);
        saturating_i32(libm::sqrtf(dx * dx + dy * dy) * self.scale + 0.5)
    }
}

/// Makes a closed tour of a path that starts at node 0 and may end anywhere: the node `end` costs nothing to reach,
/// and its place before node 0 is worth so much that no exchange gives it up.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenPath<'a, D> {
    pub distances: &'a D,
    pub end: u16,
}

/// Worth of the closing edge: more than any gain of one exchange.
const CLOSING_BONUS: i32 = 1 << 28;

impl<D: Distances> Distances for OpenPath<'_, D> {
    #[inline]
    fn between(&self, from: u16, to: u16) -> i32 {
        if from == self.end || to == self.end {
            let other = if from == self.end { to } else { from };
            return if other == 0 { -CLOSING_BONUS } else { 0 };
        }
        self.distances.between(from, to)
    }
}
