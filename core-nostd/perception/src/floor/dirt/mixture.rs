//! Gaussian mixtures of points in the plane, fitted by expectation and maximisation a bounded number of times.
//!
//! One pass over the points does both steps, so responsibilities are never stored. Where a component starves it is
//! seeded again once, at the point that is explained worst. Source: book, Floor and dirt: Mixtures.

use floorguard_types::number::{nearest_f32, saturating_i32, saturating_usize, truncating_u32};

/// A point: mean and standard deviation of a block's gradients.
pub type Point = [f32; 2];

/// Components that a mixture may have (book, Floor and dirt: Mixtures).
pub const COMPONENTS_MAX: usize = 5;
/// Passes at most (book, Floor and dirt: Mixtures).
pub const PASSES_MAX: u8 = 30;

/// One component. Invariant: the covariance (xx, xy, yy) is positive definite, because every fit adds a floor to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Component {
    /// Its share of the points.
    pub weight: f32,
    /// Mean.
    pub mean: Point,
    /// Covariance: xx, xy, yy.
    pub covariance: [f32; 3],
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitRules {
    /// Passes at most, ≤ [`PASSES_MAX`].
    pub passes: u8,
    /// Ends where the mean log-likelihood rises by less.
    pub tolerance: f32,
    /// Added to the variances, in squares of the features' unit.
    pub variance_floor: f32,
}

impl Default for FitRules {
    fn default() -> Self {
        Self { passes: PASSES_MAX, tolerance: 1.0e-3, variance_floor: 1.0e-3 }
    }
}

/// One to five components.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mixture {
    /// The components in use.
    pub components: heapless::Vec<Component, COMPONENTS_MAX>,
}

/// `ln 2π`.
const LN_TAU: f32 = 1.837_877_1;
/// Least determinant, so that a degenerate covariance divides by something.
const DETERMINANT_MIN: f32 = 1.0e-12;
/// A component with a smaller share starves (book, Floor and dirt: Mixtures).
const STARVING: f32 = 1.0e-3;

/// What a density needs of a component.
#[derive(Clone, Copy, Default)]
struct Density {
    mean: Point,
    /// Inverse covariance: xx, xy, yy, each times −½ (xy twice).
    form: [f32; 3],
    /// `ln weight − ln 2π − ½ ln |Σ|`.
    offset: f32,
}

/// Sums over the points, around the component's present mean.
#[derive(Clone, Copy, Default)]
struct Sums {
    share: f32,
    first: [f32; 2],
    second: [f32; 3],
}

impl Component {
    fn density(&self) -> Density {
        let [xx, xy, yy] = self.covariance;
        let determinant = (xx * yy - xy * xy).max(DETERMINANT_MIN);
        let offset = libm::logf(self.weight.max(f32::MIN_POSITIVE)) - LN_TAU - 0.5 * libm::logf(determinant);
        Density {
            mean: self.mean,
            form: [-0.5 * yy / determinant, xy / determinant, -0.5 * xx / determinant],
            offset,
        }
    }
}

impl Density {
    #[inline]
    fn log_at(&self, [x, y]: Point) -> f32 {
        let ([mx, my], [xx, xy, yy]) = (self.mean, self.form);
        let (dx, dy) = (x - mx, y - my);
        self.offset + dx * (xx * dx + xy * dy) + yy * dy * dy
    }
}

/// e^x for x ≤ 0, within two units of the last place; below −87 it is 0. Plain arithmetic, which compilers vectorise.
#[inline]
fn exp_of_negative(x: f32) -> f32 {
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    const ROUND: f32 = 12_582_912.0;
    let x = x.max(-87.0);
    // Adding 1.5 · 2²³ rounds to a whole number and leaves it in the low bits (Cephes' reduction).
    let shifted = x * core::f32::consts::LOG2_E + ROUND;
    let whole = shifted - ROUND;
    let r = x - whole * LN2_HIGH - whole * LN2_LOW;
    let polynomial = 1.0
        + r * (1.0
            + r * (0.5 + r * (0.166_666_65 + r * (0.041_665_795 + r * (0.008_333_452 + r * 0.001_392_05)))));
    let exponent = truncating_u32(saturating_i32(whole).wrapping_add(127).clamp(1, 254));
    if x > -87.0 { polynomial * f32::from_bits(exponent << 23) } else { 0.0 }
}

impl Mixture {
    /// A start without chance: the points along their longest axis, in `count` groups of equal size. `None` for fewer
    /// points than components or a count outside 1..=5.
    #[must_use]
    pub fn along_first_axis(points: &[Point], count: usize, variance_floor: f32) -> Option<Self> {
        if count == 0 || count > COMPONENTS_MAX || points.len() < count {
            return None;
        }
        let whole = moments(points.iter().copied(), variance_floor)?;
        let [xx, xy, yy] = whole.covariance;
        let angle = 0.5 * libm::atan2f(2.0 * xy, xx - yy);
        let (sin, cos) = libm::sincosf(angle);
        let along = move |[x, y]: Point| cos * x + sin * y;
        let mut mixture = Self::default();
        let mut low = f32::NEG_INFINITY;
        for group in 1..=count.min(COMPONENTS_MAX) {
            let part = nearest_f32(group) / nearest_f32(count);
            let [cut] = super::order::quantiles(points.iter().map(|point| along(*point)), [part])?;
            let high = if group == count { f32::INFINITY } else { cut };
            let members = points.iter().copied().filter(move |point| {
                let place = along(*point);
                place >= low && place < high
            });
            // A group may be empty where many points are equal: it starts as everything.
            let mut component = moments(members, variance_floor).unwrap_or(whole);
            component.weight = 1.0 / nearest_f32(count);
            mixture.components.push(component).ok()?;
            low = high;
        }
        Some(mixture)
    }

    /// Expectation and maximisation until the mean log-likelihood stands still or the passes are used up. Returns the
    /// passes. Points that are not finite must have been left out.
    pub fn fit(&mut self, points: &[Point], rules: &FitRules) -> u8 {
        let mut before = f32::NEG_INFINITY;
        let mut is_seeded = false;
        for pass in 0..rules.passes.min(PASSES_MAX) {
            let (sums, mean_log, worst) = self.expectation(points);
            self.maximise(&sums, points.len(), rules.variance_floor);
            let starved = self.components.iter_mut().find(|component| component.weight < STARVING);
            if let (Some(component), false) = (starved, is_seeded) {
                is_seeded = true;
                let whole = moments(points.iter().copied(), rules.variance_floor).unwrap_or_default();
                *component = Component { weight: STARVING, mean: worst, covariance: whole.covariance };
                continue;
            }
            if (mean_log - before).abs() < rules.tolerance {
                return pass.saturating_add(1);
            }
            before = mean_log;
        }
        rules.passes.min(PASSES_MAX)
    }

    fn densities(&self) -> heapless::Vec<Density, COMPONENTS_MAX> {
        self.components.iter().map(Component::density).collect()
    }

    /// Sums of every component, mean log-likelihood, and the point that is explained worst.
    fn expectation(&self, points: &[Point]) -> ([Sums; COMPONENTS_MAX], f32, Point) {
        /// Likelihoods of this many points are multiplied before one logarithm is taken: at most 5¹⁶, at least 1.
        const GROUP: usize = 16;
        let densities = self.densities();
        let mut sums = [Sums::default(); COMPONENTS_MAX];
        let (mut total, mut worst) = (0.0_f32, (f32::INFINITY, [0.0; 2]));
        for group in points.chunks(GROUP) {
            let (mut product, mut highest, mut part) = (1.0_f32, 0.0_f32, [Sums::default(); COMPONENTS_MAX]);
            for point in group {
                let mut logs = [f32::NEG_INFINITY; COMPONENTS_MAX];
                let mut top = f32::NEG_INFINITY;
                for (log, density) in logs.iter_mut().zip(&densities) {
                    *log = density.log_at(*point);
                    top = top.max(*log);
                }
                let mut sum = 0.0;
                for (log, _) in logs.iter_mut().zip(&densities) {
                    *log = exp_of_negative(*log - top);
                    sum += *log;
                }
                product *= sum;
                highest += top;
                if top < worst.0 {
                    worst = (top, *point);
                }
                let inverse = 1.0 / sum.max(1.0);
                for ((likelihood, density), sums) in logs.iter().zip(&densities).zip(&mut part) {
                    sums.add(likelihood * inverse, density.mean, *point);
                }
            }
            total += highest + libm::logf(product);
            for (sum, part) in sums.iter_mut().zip(&part) {
                sum.merge(part);
            }
        }
        (sums, total / nearest_f32(points.len()).max(1.0), worst.1)
    }

    fn maximise(&mut self, sums: &[Sums; COMPONENTS_MAX], count: usize, floor: f32) {
        for (component, sums) in self.components.iter_mut().zip(sums) {
            // Ten times the smallest step of 1, as the oracle does, so that an empty component divides by something.
            let share = sums.share + 10.0 * f32::EPSILON;
            let ([fx, fy], [sxx, sxy, syy]) = (sums.first, sums.second);
            let (dx, dy) = (fx / share, fy / share);
            let [mx, my] = component.mean;
            component.weight = share / nearest_f32(count).max(1.0);
            component.mean = [mx + dx, my + dy];
            component.covariance = [
                (sxx / share - dx * dx).max(0.0) + floor,
                sxy / share - dx * dy,
                (syy / share - dy * dy).max(0.0) + floor,
            ];
        }
    }

    /// Log-likelihood of a point under the components whose weight is at least `weight_min`; of the heaviest one where
    /// none is. Call [`Self::scorer`] once for many points.
    #[must_use]
    pub fn scorer(&self, weight_min: f32) -> Scorer {
        let heaviest = self.components.iter().map(|component| component.weight).fold(0.0, f32::max);
        let kept = |component: &&Component| component.weight >= weight_min.min(heaviest);
        Scorer { densities: self.components.iter().filter(kept).map(Component::density).collect() }
    }
}

/// Log-likelihoods under a fitted mixture.
#[derive(Clone)]
pub struct Scorer {
    densities: heapless::Vec<Density, COMPONENTS_MAX>,
}

impl Scorer {
    /// Log-likelihood of a point.
    #[must_use]
    pub fn log_likelihood(&self, point: Point) -> f32 {
        let top =
            self.densities.iter().map(|density| density.log_at(point)).fold(f32::NEG_INFINITY, f32::max);
        let sum: f32 =
            self.densities.iter().map(|density| exp_of_negative(density.log_at(point) - top)).sum();
        top + libm::logf(sum.max(f32::MIN_POSITIVE))
    }
}

impl Sums {
    #[inline]
    fn add(&mut self, share: f32, [mx, my]: Point, [x, y]: Point) {
        let (dx, dy) = (x - mx, y - my);
        self.share += share;
        let [fx, fy] = &mut self.first;
        *fx += share * dx;
        *fy += share * dy;
        let [sxx, sxy, syy] = &mut self.second;
        *sxx += share * dx * dx;
        *sxy += share * dx * dy;
        *syy += share * dy * dy;
    }

    fn merge(&mut self, part: &Self) {
        self.share += part.share;
        for (sum, value) in self.first.iter_mut().zip(part.first) {
            *sum += value;
        }
        for (sum, value) in self.second.iter_mut().zip(part.second) {
            *sum += value;
        }
    }
}

/// Mean and covariance of points as one component of weight 1; `None` without a point.
fn moments(points: impl Iterator<Item = Point> + Clone, floor: f32) -> Option<Component> {
    let mut sums = Sums::default();
    let origin = points.clone().next()?;
    for point in points {
        sums.add(1.0, origin, point);
    }
    let mut mixture = Mixture::default();
    let start = Component { weight: 1.0, mean: origin, covariance: [1.0, 0.0, 1.0] };
    mixture.components.push(start).ok()?;
    let mut all = [Sums::default(); COMPONENTS_MAX];
    let [first, ..] = &mut all;
    *first = sums;
    mixture.maximise(&all, saturating_usize(sums.share), floor);
    mixture.components.first().copied()
}

#[cfg(test)]
#[path = "mixture_tests.rs"]
mod tests;
