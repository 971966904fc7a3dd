//! All gaps of a robot: every motion at rising speeds, every place that the body sweeps meanwhile, every height.

use floorguard_guard::fastest_mps;
use floorguard_runtime::configuration::{Limits, RobotConfiguration};
use floorguard_types::geometry::{Point2, Twist2};

use super::area::{Motion, Outline, Region, Swept, speed_at_mps};
use super::gap::{Gap, Unseen};
use super::rays::SensorRays;
use super::sight::{
    Approach, BARS, HEIGHTS_M, Index, Known, Sight, SightMap, indices, lower_edge_m, place, position, rows,
};
use crate::camera::CameraConfiguration;

/// Shares of the limits at which the motions are examined.
const SHARES: [f32; 10] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
/// Bars are reported in bands of this height, metres.
const BAND_M: f32 = 0.10;
/// Bars of a band, and how many bands there are.
const BAND_BARS: usize = 5;
const BANDS: usize = BARS.div_ceil(BAND_BARS);

/// Heights that are unseen from a speed on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedStep {
    /// From this speed of the fastest point of the body on, m/s.
    pub from_mps: f32,
    /// Between these heights, metres.
    pub heights_m: [f32; 2],
}

/// A motion that brings the body into a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct GapMotion {
    /// Which one.
    pub motion: Motion,
    /// What is unseen at which speeds, in rising order.
    pub steps: Vec<SpeedStep>,
    /// So fast the body comes there at most, m/s.
    pub reached_mps: f32,
    /// How fast it comes there, as a share of its fastest point at most.
    pub body_share: f32,
    /// So fast its fastest point may be, and nothing there is unseen, m/s.
    pub free_mps: f32,
    /// So fast its fastest point is at the limits of the robot, m/s.
    pub fastest_mps: f32,
}

/// A gap of the sensors, and how the body comes into it.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorGap {
    /// Its name.
    pub gap: Gap,
    /// The motions.
    pub motions: Vec<GapMotion>,
    /// Least and greatest x and y of the places where it is widest, robot frame, metres.
    pub around_m: [Point2; 2],
}

impl SensorGap {
    /// So fast the body comes there at most, m/s.
    #[must_use]
    pub fn reached_mps(&self) -> f32 {
        self.motions.iter().map(|motion| motion.reached_mps).fold(0.0, f32::max)
    }
}

/// What the sensors of a robot see and do not see of the volume that its body goes into.
#[derive(Clone, Debug)]
pub struct Coverage {
    /// What no sensor sees.
    pub gaps: Vec<SensorGap>,
    /// Places that the body goes to, with how many of [`HEIGHTS_M`] are unseen there at the worst motion.
    pub places: Vec<(Point2, usize)>,
    rays: SensorRays,
    robot: RobotConfiguration,
}

/// One kind of gap in one region.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    /// How many of [`HEIGHTS_M`] are unseen, or the bits of the bars.
    amount: u64,
    reached_mps: f32,
    /// The places: of the greatest number of heights, or of any bar.
    around: Option<[Point2; 2]>,
}

/// What one motion at one speed leaves unseen in one region.
#[derive(Clone, Copy, Debug, Default)]
struct InRegion {
    upright: Found,
    stepping_in: Found,
    hanging: Found,
}

/// One motion at one speed.
struct Sample {
    motion: Motion,
    fastest_mps: f32,
    regions: [InRegion; Region::ALL.len()],
}

/// What the examination of the motions works with.
struct Examined<'a> {
    robot: &'a RobotConfiguration,
    outline: Outline<'a>,
    sights: SightMap,
}

impl Coverage {
    /// Of a robot with or without a floor camera.
    #[must_use]
    pub fn of(robot: &RobotConfiguration, camera: Option<&CameraConfiguration>) -> Self {
        let guard = robot.guard();
        let scanners: Vec<_> = [robot.scanner].into_iter().chain(robot.rear_scanner).collect();
        let rays = match SensorRays::of(&guard, &scanners, camera) {
            rays if robot.has_lidar => rays,
            rays => rays.without_lidar(),
        };
        let sights = SightMap::of(&rays, &guard);
        let examined = Examined { robot, outline: Outline::of(&robot.geometry), sights };
        let mut worst = vec![None; indices().count()];
        let mut samples = Vec::new();
        for (motion, twist) in motions(&robot.limits) {
            samples.extend(examined.sample(motion, twist, &mut worst));
        }
        samples.sort_by(|a, b| a.fastest_mps.total_cmp(&b.fastest_mps));
        let gaps = Region::ALL.into_iter().flat_map(|region| gaps_of(region, &samples)).collect();
        let places =
            indices().zip(worst).filter_map(|(index, unseen)| Some((place(index), unseen?))).collect();
        Self { gaps, places, rays, robot: robot.clone() }
    }

    /// What the sensors see over a place of the robot frame at this moment.
    #[must_use]
    pub fn sight(&self, at: Point2) -> Sight {
        Sight::of(&self.rays.over(at), &self.robot.guard())
    }
}

/// All motions that a robot can make, slow and fast.
fn motions(limits: &Limits) -> Vec<(Motion, Twist2)> {
    let at = |motion: Motion| SHARES.into_iter().map(move |share| (motion, share));
    let all = Motion::ALL.into_iter().flat_map(at);
    all.flat_map(|(motion, share)| motion.twists(limits, share).into_iter().map(move |twist| (motion, twist)))
        .collect()
}

impl Examined<'_> {
    /// Goes through all places that a motion sweeps.
    fn sample(&self, motion: Motion, twist: Twist2, worst: &mut [Option<usize>]) -> Option<Sample> {
        let swept = Swept::of(&self.outline, twist, (&self.robot.geometry, &self.robot.limits))?;
        let after = self.after(motion, twist, &swept);
        let mut regions = [InRegion::default(); Region::ALL.len()];
        for index in &swept.places {
            let at = place(*index);
            let now = self.sights.unseen_now(*index);
            let known = self.in_time(motion, *index, &after).map_or(now, |kept| Known {
                heights: now.heights.min(kept.heights),
                bars: now.bars & kept.bars,
            });
            let speed_mps = speed_at_mps(twist, at);
            let in_region = &mut regions[self.outline.region(at, motion).index()];
            in_region.upright.take_height(known.heights, at, speed_mps);
            in_region.stepping_in.take_height(now.heights, at, speed_mps);
            in_region.hanging.take_bars(known.bars, at, speed_mps);
            if let Some(worst) = worst.get_mut(position(*index)) {
                *worst = (*worst).max(Some(known.heights));
            }
        }
        Some(Sample { motion, fastest_mps: fastest_mps(self.outline.corners, twist), regions })
    }

    /// What is unknown of each row of places after the robot came straight along it.
    fn after(&self, motion: Motion, twist: Twist2, swept: &Swept) -> Vec<Known> {
        let beyond_m = match motion {
            Motion::Reverse => self.outline.x_m[0] - swept.needed_m,
            _ => self.outline.x_m[1] + swept.needed_m,
        };
        let approach = Approach { speed_mps: twist.linear_mps, beyond_m };
        match motion {
            Motion::SpinLeft | Motion::SpinRight => Vec::new(),
            _ => (0..rows()).map(|y| self.sights.unseen_after(y, &approach)).collect(),
        }
    }

    /// What is unknown of a place that the robot has come up to; `None`: it may not have been in view before.
    fn in_time(&self, motion: Motion, index: Index, after: &[Known]) -> Option<Known> {
        let [rear_m, front_m] = self.outline.x_m;
        let x_m = place(index).x_m;
        let came =
            if motion.is_forward() { x_m > front_m } else { motion == Motion::Reverse && x_m < rear_m };
        after.get(index[1]).filter(|_| came).copied()
    }
}

impl Found {
    fn take_height(&mut self, unseen: usize, at: Point2, speed_mps: f32) {
        let unseen = unseen as u64;
        if unseen == 0 {
            return;
        }
        if unseen >= self.amount {
            self.around = joined(self.around.filter(|_| unseen == self.amount), Some([at, at]));
        }
        self.amount = self.amount.max(unseen);
        self.reached_mps = self.reached_mps.max(speed_mps);
    }

    fn take_bars(&mut self, unseen: u64, at: Point2, speed_mps: f32) {
        if unseen != 0 {
            self.amount |= unseen;
            self.around = joined(self.around, Some([at, at]));
            self.reached_mps = self.reached_mps.max(speed_mps);
        }
    }
}

/// The box around two boxes.
fn joined(one: Option<[Point2; 2]>, other: Option<[Point2; 2]>) -> Option<[Point2; 2]> {
    match (one, other) {
        (Some([a, b]), Some([c, d])) => Some([
            Point2::new(a.x_m.min(c.x_m), a.y_m.min(c.y_m)),
            Point2::new(b.x_m.max(d.x_m), b.y_m.max(d.y_m)),
        ]),
        (one, other) => one.or(other),
    }
}

/// One kind of gap in all samples of a region.
struct Kind<'a> {
    region: Region,
    samples: &'a [Sample],
    of: fn(&InRegion) -> Found,
}

impl Kind<'_> {
    fn found(&self) -> impl Iterator<Item = Found> + '_ {
        self.samples.iter().map(|sample| (self.of)(&sample.regions[self.region.index()]))
    }

    fn greatest(&self) -> u64 {
        self.found().map(|found| found.amount).max().unwrap_or(0)
    }

    /// The gap of upright objects, so many heights of which are unseen.
    fn upright(&self, amount: u64, unseen: fn(f32) -> Unseen) -> SensorGap {
        let heights = |found: Found| (found.amount > 0).then(|| [0.0, height_m(found.amount)]);
        let places = self.found().filter(|found| found.amount == amount);
        self.gap(unseen(height_m(amount)), (heights, places.map(|found| found.around).fold(None, joined)))
    }

    /// The gap of bars in a run of bands.
    fn hanging(&self, [first, last]: [usize; 2]) -> SensorGap {
        let bands = (first..=last).fold(0, |bits, band| bits | band_bits(band));
        let heights = |found: Found| {
            runs(found.amount & bands).first().map(|[first, _]| *first).map(|first| {
                let last = runs(found.amount & bands).last().map_or(first, |[_, last]| *last);
                [band_m(first), band_m(last + 1)]
            })
        };
        let places = self.found().filter(|found| found.amount & bands != 0);
        let around = places.map(|found| found.around).fold(None, joined);
        self.gap(Unseen::Hanging([band_m(first), band_m(last + 1)]), (heights, around))
    }

    fn gap(
        &self,
        unseen: Unseen,
        (heights, around): (impl Fn(Found) -> Option<[f32; 2]>, Option<[Point2; 2]>),
    ) -> SensorGap {
        let of = |motion| self.of_motion(motion, &heights);
        let motions = Motion::ALL.into_iter().filter_map(of).collect();
        SensorGap { gap: Gap { region: self.region, unseen }, motions, around_m: around.unwrap_or_default() }
    }

    /// How a motion comes into a gap: every speed at which it is wider than at any lower one.
    fn of_motion(&self, motion: Motion, heights: impl Fn(Found) -> Option<[f32; 2]>) -> Option<GapMotion> {
        let (mut steps, mut reached_mps): (Vec<SpeedStep>, f32) = (Vec::new(), 0.0);
        let (mut body_share, mut free_mps, mut fastest_mps) = (0.0_f32, 0.0_f32, 0.0_f32);
        let samples = self.samples.iter().zip(self.found()).filter(|(sample, _)| sample.motion == motion);
        for (sample, found) in samples {
            fastest_mps = fastest_mps.max(sample.fastest_mps);
            let Some([low_m, high_m]) = heights(found) else {
                free_mps = if steps.is_empty() { sample.fastest_mps } else { free_mps };
                continue;
            };
            reached_mps = reached_mps.max(found.reached_mps);
            body_share = body_share.max(found.reached_mps / sample.fastest_mps.max(1.0e-3));
            let [least_m, greatest_m] = steps.last().map_or([f32::MAX, f32::MIN], |step| step.heights_m);
            if low_m < least_m || high_m > greatest_m {
                let heights_m = [low_m.min(least_m), high_m.max(greatest_m)];
                steps.push(SpeedStep { from_mps: sample.fastest_mps, heights_m });
            }
        }
        (!steps.is_empty()).then_some(GapMotion {
            motion,
            steps,
            reached_mps,
            body_share,
            free_mps,
            fastest_mps,
        })
    }
}

/// The gaps of one region. The samples come with rising speed.
fn gaps_of(region: Region, samples: &[Sample]) -> Vec<SensorGap> {
    let kind = |of| Kind { region, samples, of };
    let (upright, stepping_in) = (kind(|found| found.upright), kind(|found| found.stepping_in));
    let mut gaps = Vec::new();
    let (in_time, at_once) = (upright.greatest(), stepping_in.greatest());
    if in_time > 0 {
        gaps.push(upright.upright(in_time, Unseen::Below));
    }
    if at_once > in_time {
        gaps.push(stepping_in.upright(at_once, Unseen::SteppingIn));
    }
    let hanging = kind(|found| found.hanging);
    let bars = hanging.found().fold(0, |bars, found| bars | found.amount);
    gaps.extend(runs(bars).into_iter().map(|run| hanging.hanging(run)));
    gaps
}

/// The height from which on objects are seen of which so many are not.
fn height_m(unseen: u64) -> f32 {
    let index = (unseen as usize).min(HEIGHTS_M.len() - 1);
    HEIGHTS_M[index]
}

/// Where a band begins, metres above the floor.
fn band_m(band: usize) -> f32 {
    lower_edge_m(0) + band as f32 * BAND_M
}

/// The bars of a band.
fn band_bits(band: usize) -> u64 {
    let bars = band * BAND_BARS..((band + 1) * BAND_BARS).min(BARS);
    bars.fold(0, |bits, bar| bits | (1 << bar))
}

/// Bands in which bars are unseen: first and last of each run.
fn runs(bars: u64) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for band in (0..BANDS).filter(|band| bars & band_bits(*band) != 0) {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == band => *last = band,
            _ => runs.push([band, band]),
        }
    }
    runs
}
