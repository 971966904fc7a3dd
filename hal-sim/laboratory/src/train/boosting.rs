//! Gradient boosting of three-level trees on the logistic loss (Friedman 2001, with Newton steps at the leaves).

use floorguard_perception::people::person_model::{TREE_LEAVES, TREE_NODES, Tree, log_odds, probability};

/// One labelled vector.
#[derive(Clone, Copy, Debug)]
pub struct Sample<const FEATURES: usize> {
    /// Its numbers.
    pub features: [f32; FEATURES],
    /// What it is.
    pub positive: bool,
}

/// How to boost.
#[derive(Clone, Copy, Debug)]
pub struct Boosting {
    /// Trees.
    pub trees: usize,
    /// Share of each step that is taken.
    pub shrinkage: f32,
    /// Least sum of p·(1 − p) at a leaf.
    pub weight_min: f64,
    /// Added to the denominator of a leaf: small leaves say less.
    pub ridge: f64,
    /// Share of the samples that each tree sees, taken in turn.
    pub stride: usize,
}

impl Boosting {
    /// Values that were chosen on held-out seeds.
    pub const DEFAULT: Self = Self { trees: 80, shrinkage: 0.15, weight_min: 8.0, ridge: 4.0, stride: 2 };
}

/// What was learnt.
#[derive(Clone, Debug, PartialEq)]
pub struct Forest {
    /// Log-odds before any tree.
    pub offset: f32,
    /// The trees.
    pub trees: Vec<Tree>,
}

impl Forest {
    /// Log-odds of a vector.
    #[must_use]
    pub fn log_odds(&self, features: &[f32]) -> f32 {
        log_odds(self.offset, &self.trees, features)
    }
}

/// Borders that a feature is compared with at most.
const BORDERS: usize = 48;

/// Sum of gradients and of curvatures.
#[derive(Clone, Copy, Debug, Default)]
struct Slope {
    gradient: f64,
    curvature: f64,
}

impl Slope {
    fn add(&mut self, other: Self) {
        self.gradient += other.gradient;
        self.curvature += other.curvature;
    }

    fn gain(&self, ridge: f64) -> f64 {
        self.gradient * self.gradient / (self.curvature + ridge)
    }
}

/// Learns; the same samples in the same order give the same trees.
#[must_use]
pub fn boost<const FEATURES: usize>(samples: &[Sample<FEATURES>], boosting: &Boosting) -> Forest {
    let positives = samples.iter().filter(|sample| sample.positive).count() as f32;
    let share = (positives / samples.len().max(1) as f32).clamp(1.0e-3, 1.0 - 1.0e-3);
    let mut forest = Forest { offset: (share / (1.0 - share)).ln(), trees: Vec::new() };
    let borders: Vec<Vec<f32>> = (0..FEATURES).map(|feature| borders(samples, feature)).collect();
    let bins: Vec<[u8; FEATURES]> = samples
        .iter()
        .map(|sample| {
            core::array::from_fn(|feature| {
                borders[feature].partition_point(|border| sample.features[feature] > *border) as u8
            })
        })
        .collect();
    let mut sums: Vec<f32> = vec![forest.offset; samples.len()];
    for round in 0..boosting.trees {
        let slopes: Vec<Slope> =
            samples.iter().zip(&sums).map(|(sample, sum)| slope(sample.positive, *sum)).collect();
        let used: Vec<usize> = (round % boosting.stride..samples.len()).step_by(boosting.stride).collect();
        let tree = grow(&Data { bins: &bins, slopes: &slopes, borders: &borders }, used, boosting);
        for (sum, sample) in sums.iter_mut().zip(samples) {
            *sum += tree.value(&sample.features);
        }
        forest.trees.push(tree);
    }
    forest
}

fn slope(positive: bool, sum: f32) -> Slope {
    let p = f64::from(probability(sum));
    Slope { gradient: f64::from(u8::from(positive)) - p, curvature: (p * (1.0 - p)).max(1.0e-6) }
}

/// Quantiles of a feature, rounded so that the table prints them exactly.
fn borders<const FEATURES: usize>(samples: &[Sample<FEATURES>], feature: usize) -> Vec<f32> {
    let mut values: Vec<f32> = samples.iter().map(|sample| sample.features[feature]).collect();
    values.sort_by(f32::total_cmp);
    let quantile = |step: usize| values[step * (values.len() - 1) / (BORDERS + 1)];
    let mut borders: Vec<f32> = (1..=BORDERS)
        .filter(|_| !values.is_empty())
        .map(|step| (quantile(step) * 1.0e4).round() / 1.0e4)
        .collect();
    borders.dedup();
    borders
}

struct Data<'a, const FEATURES: usize> {
    bins: &'a [[u8; FEATURES]],
    slopes: &'a [Slope],
    borders: &'a [Vec<f32>],
}

/// The best split of some samples: feature, index of its border.
fn best_split<const FEATURES: usize>(
    data: &Data<'_, FEATURES>,
    members: &[usize],
    boosting: &Boosting,
) -> Option<(usize, usize)> {
    let mut histogram = vec![[Slope::default(); BORDERS + 1]; FEATURES];
    let mut total = Slope::default();
    for member in members {
        total.add(data.slopes[*member]);
        for (bins, bin) in histogram.iter_mut().zip(&data.bins[*member]) {
            bins[usize::from(*bin)].add(data.slopes[*member]);
        }
    }
    let mut best: Option<(f64, usize, usize)> = None;
    for (feature, bins) in histogram.iter().enumerate() {
        let mut below = Slope::default();
        for (border, bin) in bins.iter().enumerate().take(data.borders[feature].len()) {
            below.add(*bin);
            let above = Slope {
                gradient: total.gradient - below.gradient,
                curvature: total.curvature - below.curvature,
            };
            if below.curvature < boosting.weight_min || above.curvature < boosting.weight_min {
                continue;
            }
            let gain = below.gain(boosting.ridge) + above.gain(boosting.ridge) - total.gain(boosting.ridge);
            if gain > 1.0e-6 && best.is_none_or(|(other, ..)| gain > other) {
                best = Some((gain, feature, border));
            }
        }
    }
    best.map(|(_, feature, border)| (feature, border))
}

/// One tree, level by level. Where nothing is worth a split everything goes to the lower side.
fn grow<const FEATURES: usize>(data: &Data<'_, FEATURES>, all: Vec<usize>, boosting: &Boosting) -> Tree {
    let mut tree =
        Tree { features: [0; TREE_NODES], thresholds: [f32::MAX; TREE_NODES], leaves: [0.0; TREE_LEAVES] };
    let mut groups = vec![Vec::new(); TREE_NODES + TREE_LEAVES];
    groups[0] = all;
    for node in 0..TREE_NODES {
        let members = std::mem::take(&mut groups[node]);
        let Some((feature, border)) = best_split(data, &members, boosting) else {
            groups[2 * node + 1] = members;
            continue;
        };
        (tree.features[node], tree.thresholds[node]) = (feature as u8, data.borders[feature][border]);
        let is_below = |member: &usize| usize::from(data.bins[*member][feature]) <= border;
        (groups[2 * node + 1], groups[2 * node + 2]) = members.into_iter().partition(is_below);
    }
    for (leaf, members) in tree.leaves.iter_mut().zip(&groups[TREE_NODES..]) {
        let mut sum = Slope::default();
        members.iter().for_each(|member| sum.add(data.slopes[*member]));
        let step = boosting.shrinkage * (sum.gradient / (sum.curvature + boosting.ridge)) as f32;
        *leaf = (step * 1.0e4).round() / 1.0e4;
    }
    tree
}

#[cfg(test)]
mod tests {
    use floorguard_types::random::Pcg32;

    use super::*;

    /// Two numbers whose product decides: no single comparison can.
    #[test]
    fn more_than_one_comparison_is_learnt() {
        let mut random = Pcg32::new(1, 1);
        let mut draw = || {
            let features = [random.uniform_between(-1.0, 1.0), random.uniform_between(-1.0, 1.0)];
            Sample { features, positive: features[0] * features[1] > 0.0 }
        };
        let (train, test): (Vec<_>, Vec<_>) =
            ((0..4_000).map(|_| draw()).collect(), (0..1_000).map(|_| draw()).collect());
        let forest = boost(&train, &Boosting::DEFAULT);
        let right =
            test.iter().filter(|each| (forest.log_odds(&each.features) > 0.0) == each.positive).count();
        assert!(right > 950, "{right} of 1,000");
        assert_eq!(forest, boost(&train, &Boosting::DEFAULT));
    }
}
