//! Lays the averaged returns of a sweep onto the planes of the map.
//!
//! Each return gives one distance along the normal of the plane in its cube; its derivative by pose and velocity is the
//! same row twice, the second one times the time until the end of the sweep. So three matrices of 6 × 6 (weighted with the
//! powers 0, 1 and 2 of that time) hold all that 12 unknowns need.

use floorguard_types::number::{count_u32, nearest_f32_of_f64, nearest_f64};
use heapless::Vec;
use nalgebra::{Matrix6, Vector3, Vector6};

use super::averaging::AveragedReturn;
use super::filter::{Matrix12, Quadratic, Vector12};
use super::motion::Pose3;
use super::sweep_motion::SweepMotion;
use super::voxel_map::{Bucket, Level, Plane, VoxelKey, VoxelMap, VoxelPlace, symmetric_eigen};

/// How returns are weighted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignConfig {
    /// Rounds of correction, at most.
    pub rounds: u32,
    /// Stop when a round turned by less than this, radians...
    pub turn_rad: f64,
    /// ... and moved by less than this, metres.
    pub step_m: f64,
    /// What planes of cubes do not explain, added to their deviation, metres.
    pub noise_m: f32,
    /// A distance of this many deviations has a quarter of the weight (Geman and McClure 1987).
    pub kernel: f32,
    /// The kernel of the first round is wider by this factor, that of the second by its root.
    pub kernel_first: f32,
    /// Rounds, at most, where the prediction failed...
    pub rounds_wide: u32,
    /// ... and the factor of their first kernel.
    pub kernel_wide: f32,
    /// Neighbouring returns err alike: so many count as one.
    pub alike: f64,
    /// Fewer matched returns say nothing.
    pub matched_least: u32,
}

impl Default for AlignConfig {
    fn default() -> Self {
        Self {
            rounds: 6,
            turn_rad: 1.0e-4,
            step_m: 3.0e-4,
            noise_m: 0.01,
            kernel: 3.0,
            kernel_first: 1.5,
            rounds_wide: 16,
            kernel_wide: 30.0,
            alike: 10.0,
            matched_least: 50,
        }
    }
}

/// A direction with less than so many times the information of independent noise is silent. In a corridor without features
/// the planes of ragged edges amount to some ten to 150 times; in a small furnished room the weakest direction has a thousand.
const SILENT: f64 = 150.0;
/// One with more than this counts in full.
const CLEAR: f64 = 400.0;

/// The plane that a return was matched with, and for which cube that holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Match {
    key: VoxelKey,
    place: Option<VoxelPlace>,
}

impl Match {
    /// Not looked for.
    pub(super) const OPEN: Self = Self { key: VoxelKey::NONE, place: None };
}

/// Sums over the returns of a sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    /// Products of rows, weighted with the powers 0, 1, 2 of the time; then the gradient with the powers 0, 1.
    by_time: [Matrix6<f64>; 3],
    gradient: [Vector6<f64>; 2],
    /// Returns that were matched.
    pub(super) matched: u32,
    /// Sum of the squares of the distances in deviations, each counted by its kernel.
    pub(super) squares: f64,
    /// Sum of the kernels.
    pub(super) kernels: f64,
    /// What planes that are tilted by noise alone would say about the place along themselves, 1/m².
    tilts: f64,
}

/// The direction of the place that a sweep says least about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weakest {
    /// Unit vector in the sensor's axes.
    pub(super) direction: Vector3<f64>,
    /// The information about it in multiples of what noise would say; 0 of too few returns.
    pub(super) times_noise: f64,
    /// The share of the information that was used, 0 to 1.
    pub(super) share: f64,
}

impl Weakest {
    /// Of a sweep that says nothing.
    pub(super) fn of_nothing() -> Self {
        Self { direction: Vector3::x(), times_noise: 0.0, share: 0.0 }
    }

    /// Too little to tell it from noise.
    pub(super) fn is_silent(&self) -> bool {
        self.share <= 0.0
    }
}

/// What a sweep says about a state, and the directions about which it says nothing.
pub(super) struct SweepInformation {
    pub(super) quadratic: Quadratic,
    pub(super) weakest: Weakest,
}

/// Six derivatives, and the distance.
type Row = [f32; 7];

/// A row and how much it counts.
#[derive(Clone, Copy)]
struct Weighed {
    row: Row,
    weight: f32,
}

/// Sums of the products of a few rows: each derivative with itself and with what stands after it; the other products are the
/// same.
struct Products {
    first: [f32; 7],
    second: [f32; 6],
    third: [f32; 5],
    fourth: [f32; 4],
    fifth: [f32; 3],
    sixth: [f32; 2],
}

impl Products {
    /// In two passes, each of which has its sums in the registers of a processor with 32 of them.
    fn of(rows: &[Weighed]) -> Self {
        let (mut first, mut second, mut third) = ([0.0; 7], [0.0; 6], [0.0; 5]);
        for Weighed { row: [a, b, c, d, e, f, distance], weight } in rows.iter().copied() {
            add_scaled(&mut first, [a, b, c, d, e, f, distance], weight * a);
            add_scaled(&mut second, [b, c, d, e, f, distance], weight * b);
            add_scaled(&mut third, [c, d, e, f, distance], weight * c);
        }
        let (mut fourth, mut fifth, mut sixth) = ([0.0; 4], [0.0; 3], [0.0; 2]);
        for Weighed { row: [.., d, e, f, distance], weight } in rows.iter().copied() {
            add_scaled(&mut fourth, [d, e, f, distance], weight * d);
            add_scaled(&mut fifth, [e, f, distance], weight * e);
            add_scaled(&mut sixth, [f, distance], weight * f);
        }
        Self { first, second, third, fourth, fifth, sixth }
    }

    /// Row by row, without what stands before the diagonal.
    fn rows(&self) -> [&[f32]; 6] {
        [&self.first, &self.second, &self.third, &self.fourth, &self.fifth, &self.sixth]
    }
}

#[inline]
fn add_scaled<const N: usize>(sums: &mut [f32; N], values: [f32; N], factor: f32) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
}

/// How the returns are seen in one round.
pub(super) struct Round<'a> {
    pub(super) config: &'a AlignConfig,
    /// In squared deviations.
    pub(super) kernel: f32,
    pub(super) motion: &'a SweepMotion,
}

impl Sums {
    /// Of no return.
    pub(super) fn none() -> Self {
        Self {
            by_time: [Matrix6::zeros(); 3],
            gradient: [Vector6::zeros(); 2],
            matched: 0,
            squares: 0.0,
            kernels: 0.0,
            tilts: 0.0,
        }
    }

    fn take(&mut self, products: &Products, time_s: f64) {
        let powers = [1.0, time_s, time_s * time_s];
        for (row, sums) in products.rows().into_iter().enumerate() {
            for (column, sum) in (row..7).zip(sums) {
                let sum = f64::from(*sum);
                for (matrix, power) in self.by_time.iter_mut().zip(powers) {
                    let product = sum * power;
                    matrix.get_mut((row, column)).into_iter().for_each(|cell| *cell += product);
                    if row != column {
                        matrix.get_mut((column, row)).into_iter().for_each(|cell| *cell += product);
                    }
                }
                if column == 6 {
                    for (gradient, power) in self.gradient.iter_mut().zip(powers) {
                        gradient.get_mut(row).into_iter().for_each(|cell| *cell += sum * power);
                    }
                }
            }
        }
    }

    /// What the sweep says about the state whose pose is given, in its axes. Directions of the place about which it says no
    /// more than noise would are taken out: the prediction holds them (Zhang et al. 2016, with the noise of the planes as the
    /// limit, and a gradual end).
    pub(super) fn information(&self, end: &Pose3, alike: f64) -> SweepInformation {
        let mut all = self.quadratic(end, alike);
        let noise = (self.tilts / alike).max(1.0e-30);
        let place = all.information.fixed_view::<3, 3>(3, 3).into_owned();
        let scale = place.trace().max(1.0e-30);
        let [xx, xy, xz] = [place.m11, place.m12, place.m13];
        let parts = [xx, xy, xz, place.m22, place.m23, place.m33];
        let eigen = symmetric_eigen(parts.map(|part| nearest_f32_of_f64(part / scale)));
        let mut weakest = Weakest { times_noise: f64::INFINITY, ..Weakest::of_nothing() };
        for (value, direction) in eigen.values.iter().zip(eigen.vectors) {
            let times_noise = f64::from(*value).max(0.0) * scale / noise;
            let share = ((times_noise - SILENT) / (CLEAR - SILENT)).clamp(0.0, 1.0);
            let direction = direction.map(f64::from);
            if share < 1.0 {
                all.reduce(&direction, share);
            }
            if times_noise < weakest.times_noise {
                weakest = Weakest { direction, times_noise, share };
            }
        }
        SweepInformation { quadratic: all, weakest }
    }

    fn quadratic(&self, end: &Pose3, alike: f64) -> Quadratic {
        let mut turn = Matrix6::zeros();
        turn.fixed_view_mut::<3, 3>(0, 0).copy_from(&end.rotation);
        turn.fixed_view_mut::<3, 3>(3, 3).copy_from(&end.rotation);
        let back = turn.transpose();
        let [now, first, second] = self.by_time.map(|matrix| back * matrix * turn / alike);
        let mut information = Matrix12::zeros();
        information.fixed_view_mut::<6, 6>(0, 0).copy_from(&now);
        information.fixed_view_mut::<6, 6>(0, 6).copy_from(&first);
        information.fixed_view_mut::<6, 6>(6, 0).copy_from(&first);
        information.fixed_view_mut::<6, 6>(6, 6).copy_from(&second);
        let mut gradient = Vector12::zeros();
        let [place, velocity] = self.gradient.map(|part| back * part / alike);
        gradient.fixed_rows_mut::<6>(0).copy_from(&place);
        gradient.fixed_rows_mut::<6>(6).copy_from(&velocity);
        Quadratic { information, gradient }
    }
}

/// Measures all returns against the map. `end` is where the sweep ends.
pub(super) fn measure<S: AsRef<[Bucket]> + AsMut<[Bucket]>>(
    returns: (&[AveragedReturn], &mut [Match]),
    map: &VoxelMap<S>,
    round: &Round<'_>,
    end: &Vector3<f32>,
) -> Sums {
    /// Rows that are summed before the time is applied.
    const TOGETHER: usize = 48;
    let mut sums = Sums::none();
    let (returns, matches) = returns;
    for (returns, matches) in returns.chunks(TOGETHER).zip(matches.chunks_mut(TOGETHER)) {
        let mut rows: Vec<Weighed, TOGETHER> = Vec::new();
        let mut time_sum = 0.0_f64;
        for (each, matched) in returns.iter().zip(matches) {
            time_sum += f64::from(round.motion.time_s(each.time_share));
            let Some(found) = row(each, matched, map, (round, end)) else { continue };
            // As many rows as returns: they fit.
            let _ = rows.push(Weighed { row: found.row, weight: found.weight });
            sums.matched = sums.matched.saturating_add(1);
            sums.squares += f64::from(found.square * found.kernel);
            sums.kernels += f64::from(found.kernel);
            sums.tilts += f64::from(found.weight * found.tilt);
        }
        let count = count_u32(returns.len()).max(1);
        sums.take(&Products::of(&rows), time_sum / nearest_f64(count));
    }
    sums
}

struct Found {
    row: Row,
    weight: f32,
    kernel: f32,
    square: f32,
    tilt: f32,
}

#[inline]
fn row<S: AsRef<[Bucket]> + AsMut<[Bucket]>>(
    each: &AveragedReturn,
    matched: &mut Match,
    map: &VoxelMap<S>,
    (round, end): (&Round<'_>, &Vector3<f32>),
) -> Option<Found> {
    let point = round.motion.transform(&each.point_in_sensor, each.time_share);
    let plane = plane_of(&point, matched, map)?;
    let from_middle = point - plane.mean;
    let distance = plane.normal.dot(&from_middle);
    let noise = round.config.noise_m;
    let variance = plane.variance + plane.tilt * from_middle.norm_squared() + noise * noise;
    let square = distance * distance / variance;
    let share = round.kernel / (round.kernel + square);
    // Beyond three times the kernel nothing of the return is believed.
    if share.is_nan() || share <= 0.1 {
        return None;
    }
    let arm = point - end;
    let turn = arm.cross(&plane.normal);
    let n = plane.normal;
    let kernel = share * share;
    let row = [turn.x, turn.y, turn.z, n.x, n.y, n.z, distance];
    Some(Found { row, weight: kernel / variance, kernel, square, tilt: plane.tilt })
}

/// The plane of the small cube, or of the large one.
#[inline]
fn plane_of<'a, S: AsRef<[Bucket]> + AsMut<[Bucket]>>(
    point: &Vector3<f32>,
    matched: &mut Match,
    map: &'a VoxelMap<S>,
) -> Option<&'a Plane> {
    let key = map.key(point, Level::Fine);
    if key != matched.key {
        let known = |place: &super::voxel_map::VoxelPlace| map.plane(*place).is_known();
        let fine = map.find_key(key).filter(known);
        let place = fine.or_else(|| map.find(point, Level::Coarse).filter(known));
        *matched = Match { key, place };
    }
    matched.place.map(|place| map.plane(place))
}
