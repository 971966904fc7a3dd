//! Consecutive returns of one laser on one surface become their mean.
//!
//! A spinning lidar samples a wall every few centimetres along a ring; the mean of eight such returns lies on the wall
//! too, with a third of their noise. Runs end where the surface ends (a jump of the step or of its change), so that a mean
//! never hangs in the air between two objects.

use floorguard_types::geometry::Point3;
use heapless::Vec;
use nalgebra::Vector3;

/// One return of a sweep, in the order of firing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepReturn {
    /// Metres in the sensor's frame at the time of the return: x forward, y left, z up.
    pub point_in_sensor: Vector3<f32>,
    /// When within the sweep: 0 at its start, 1 at its end.
    pub time_share: f32,
    /// Which laser, 0 … [`RINGS_MAX`] − 1.
    pub ring: u8,
}

impl SweepReturn {
    /// Of a return at a point of the sensor's frame.
    #[must_use]
    pub const fn new(point: Point3, time_share: f32, ring: u8) -> Self {
        Self { point_in_sensor: Vector3::new(point.x_m, point.y_m, point.z_m), time_share, ring }
    }
}

/// The mean of a run of returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AveragedReturn {
    /// Metres in the sensor's frame at the mean time.
    pub point_in_sensor: Vector3<f32>,
    /// Mean time within the sweep, 0 … 1.
    pub time_share: f32,
}

/// Lasers of the largest lidar.
pub const RINGS_MAX: usize = 64;

/// How runs are cut. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AveragingConfig {
    /// Returns of a full run, ≥ 2.
    pub run: u16,
    /// Shorter runs are left out: small or ragged objects.
    pub run_least: u16,
    /// Longer runs are cut, so that a mean lies near all of its returns, metres.
    pub length_m: f32,
    /// Nearer returns are the robot itself.
    pub range_least_m: f32,
    /// Farther returns are not used.
    pub range_most_m: f32,
    /// Largest step from return to return at the sensor; a run ends at a larger one.
    pub step_m: f32,
    /// What is added to it per metre of range: 0.2° of a wall under a grazing angle of 7°.
    pub step_per_m: f32,
    /// Largest change of the step: the noise of three ranges, and small ledges.
    pub bend_m: f32,
    /// What is added to it per metre of range.
    pub bend_per_m: f32,
}

impl Default for AveragingConfig {
    fn default() -> Self {
        Self {
            run: 8,
            run_least: 5,
            length_m: 0.6,
            range_least_m: 0.4,
            range_most_m: 60.0,
            step_m: 0.15,
            step_per_m: 0.03,
            bend_m: 0.12,
            bend_per_m: 0.01,
        }
    }
}

#[derive(Clone, Copy)]
struct Run {
    count: u16,
    sum: Vector3<f32>,
    time_sum: f32,
    first: Vector3<f32>,
    last: Vector3<f32>,
    step: Vector3<f32>,
}

impl Run {
    const NONE: Self = Self {
        count: 0,
        sum: Vector3::new(0.0, 0.0, 0.0),
        time_sum: 0.0,
        first: Vector3::new(0.0, 0.0, 0.0),
        last: Vector3::new(0.0, 0.0, 0.0),
        step: Vector3::new(0.0, 0.0, 0.0),
    };

    fn starting_at(each: &SweepReturn) -> Self {
        Self {
            count: 1,
            sum: each.point_in_sensor,
            time_sum: each.time_share,
            first: each.point_in_sensor,
            last: each.point_in_sensor,
            step: Vector3::zeros(),
        }
    }

    /// Whether a return that is a step from the last one lies on the same surface as the run. `square` is that of its range.
    #[inline]
    fn continues(&self, step: &Vector3<f32>, square: f32, limits: &Limits) -> bool {
        let [bend, step_most] = [limits.bend, limits.step].map(|[base, slope]| base + slope * square);
        let straight = self.count < 2 || (step - self.step).norm_squared() <= bend;
        straight && step.norm_squared() <= step_most
    }

    fn mean(&self) -> AveragedReturn {
        let share = 1.0 / f32::from(self.count.max(1));
        AveragedReturn { point_in_sensor: self.sum * share, time_share: self.time_sum * share }
    }
}

/// The settings as squares.
struct Limits {
    /// From the square of the least range to that of the largest, as bits: numbers from 0 on are ordered as theirs are.
    range_bits: [u32; 2],
    /// What a step and its change may be, and what is added to it with the square of the range.
    step: [f32; 2],
    bend: [f32; 2],
    length: f32,
}

impl Limits {
    fn of(config: &AveragingConfig) -> Self {
        let square = |value: f32| value * value;
        Self {
            range_bits: [config.range_least_m, config.range_most_m].map(|range_m| square(range_m).to_bits()),
            step: [config.step_m, config.step_per_m].map(square),
            bend: [config.bend_m, config.bend_per_m].map(square),
            length: square(config.length_m),
        }
    }
}

/// Takes the means of the runs that end.
struct Means<'a, const N: usize> {
    means: &'a mut Vec<AveragedReturn, N>,
    run_least: u16,
    dropped: u32,
}

impl<const N: usize> Means<'_, N> {
    /// Out of the loop over the returns, which needs the registers; one of eight returns ends a run.
    #[inline(never)]
    fn give(&mut self, run: &Run) {
        if run.count >= self.run_least && self.means.push(run.mean()).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }
}

/// Fills `means` with the means of a sweep, in the order in which the runs end. Returns how many did not fit. Cost: a few
/// multiplications for each return.
pub fn average_returns<const N: usize>(
    sweep: &[SweepReturn],
    config: &AveragingConfig,
    means: &mut Vec<AveragedReturn, N>,
) -> u32 {
    means.clear();
    let mut means = Means { means, run_least: config.run_least, dropped: 0 };
    let mut runs = [Run::NONE; RINGS_MAX];
    let limits = Limits::of(config);
    let [near, far] = limits.range_bits;
    for each in sweep {
        let Some(run) = runs.get_mut(usize::from(each.ring)) else { continue };
        let square = each.point_in_sensor.norm_squared();
        // The bits of a NaN are in no range.
        if !(near..=far).contains(&square.to_bits()) {
            continue;
        }
        let step = each.point_in_sensor - run.last;
        if run.count > 0 && run.continues(&step, square, &limits) {
            run.step = step;
            run.last = each.point_in_sensor;
            run.sum += each.point_in_sensor;
            run.time_sum += each.time_share;
            run.count = run.count.saturating_add(1);
            let length = (run.last - run.first).norm_squared();
            if run.count >= config.run || length > limits.length {
                means.give(run);
                *run = Run::NONE;
            }
        } else {
            means.give(run);
            *run = Run::starting_at(each);
        }
    }
    runs.iter().for_each(|run| means.give(run));
    means.dropped
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec as HeapVec;

    /// A wall 4 m ahead that ends in the middle; behind it another one at 7 m.
    fn walls() -> HeapVec<SweepReturn> {
        let one = |index: u16| {
            let angle = (f32::from(index) - 40.0) * 0.2_f32.to_radians();
            let x = if index < 40 { 4.0 } else { 7.0 };
            SweepReturn {
                point_in_sensor: Vector3::new(x, x * libm::tanf(angle), 0.0),
                time_share: f32::from(index) / 80.0,
                ring: 3,
            }
        };
        (0..80).map(one).collect()
    }

    #[test]
    fn means_lie_on_the_surfaces_of_their_returns() {
        let mut means = Vec::<AveragedReturn, 64>::new();
        assert_eq!(average_returns(&walls(), &AveragingConfig::default(), &mut means), 0);
        assert_eq!(means.len(), 10);
        for mean in &means {
            let x = mean.point_in_sensor.x;
            assert!((x - 4.0).abs() < 1.0e-5 || (x - 7.0).abs() < 1.0e-5, "{mean:?}");
        }
    }

    #[test]
    fn nothing_useful_gives_nothing() {
        let mut means = Vec::<AveragedReturn, 4>::new();
        let config = AveragingConfig::default();
        let bad = SweepReturn { point_in_sensor: Vector3::new(f32::NAN, 1.0, 0.0), time_share: 0.0, ring: 0 };
        let far = SweepReturn { point_in_sensor: Vector3::new(90.0, 1.0, 0.0), ..bad };
        let unknown = SweepReturn { point_in_sensor: Vector3::new(2.0, 1.0, 0.0), ring: 200, ..bad };
        assert_eq!(average_returns(&[bad, far, unknown], &config, &mut means), 0);
        assert!(means.is_empty());
        // Ten runs, and only four have a place.
        assert_eq!(average_returns(&walls(), &config, &mut means), 6);
    }
}
