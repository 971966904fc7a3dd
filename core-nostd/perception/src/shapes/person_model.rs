//! From the shape of a candidate to the probability that it is a person: boosted trees from a constant table.
//!
//! Trained by `floorguard train people` on simulated sweeps; the sum over the trees is the logarithm of the odds.

use super::person_table::{OFFSET, TREES};
use super::shape::ShapeVector;

/// Decisions of a tree: three levels.
pub const TREE_NODES: usize = 7;
/// Ends of a tree.
pub const TREE_LEAVES: usize = 8;
/// Levels of a tree.
const DEPTH: usize = 3;

/// One tree of three levels, complete: node n is followed by 2n + 1 (at most the threshold) or 2n + 2 (above).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tree {
    /// Index of the feature of each node.
    pub features: [u8; TREE_NODES],
    /// What it compares it with.
    pub thresholds: [f32; TREE_NODES],
    /// Log-odds at the ends.
    pub leaves: [f32; TREE_LEAVES],
}

impl Tree {
    /// What this tree adds to the log-odds. Three comparisons.
    #[must_use]
    pub fn value(&self, shape: &[f32]) -> f32 {
        let mut node = 0_usize;
        for _ in 0..DEPTH {
            let feature = self.features.get(node).map_or(0, |feature| usize::from(*feature));
            let value = shape.get(feature).copied().unwrap_or(0.0);
            let threshold = self.thresholds.get(node).copied().unwrap_or(0.0);
            let above = usize::from(value > threshold);
            node = node.saturating_mul(2).saturating_add(1).saturating_add(above);
        }
        self.leaves.get(node.saturating_sub(TREE_NODES)).copied().unwrap_or(0.0)
    }
}

/// Log-odds of some trees.
#[must_use]
pub fn log_odds(offset: f32, trees: &[Tree], shape: &[f32]) -> f32 {
    trees.iter().fold(offset, |sum, tree| sum + tree.value(shape))
}

/// Log-odds that a shape is a person, by the table of this build.
#[must_use]
pub fn person_log_odds(shape: &ShapeVector) -> f32 {
    log_odds(OFFSET, &TREES, shape)
}

/// The probability of some log-odds.
#[must_use]
pub fn probability(log_odds: f32) -> f32 {
    1.0 / (1.0 + libm::expf(-log_odds.clamp(-30.0, 30.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_is_walked_by_its_thresholds() {
        let tree = Tree {
            features: [0, 1, 1, 2, 2, 2, 2],
            thresholds: [0.5; 7],
            leaves: [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
        };
        for index in 0..8_u8 {
            let bit = |place: u8| f32::from(index >> place & 1);
            assert_eq!(tree.value(&[bit(2), bit(1), bit(0)]), f32::from(index));
        }
        assert_eq!(log_odds(0.25, &[tree, tree], &[1.0, 1.0, 1.0]), 14.25);
    }

    #[test]
    fn broken_numbers_give_a_number() {
        assert!(person_log_odds(&[f32::NAN; 24]).is_finite());
        assert!(person_log_odds(&[f32::INFINITY; 24]).is_finite());
    }
}
