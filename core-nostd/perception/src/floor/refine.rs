//! From a rough plane to the best one: weighted least squares, a fixed number of times, in a narrowing band.
//!
//! A depth error moves a point along its ray, so its height errs by `σ_z |n·r|`: far floor counts less. On top comes
//! the unevenness of the floor itself, without which thousands of near pixels would outvote all others. Huber's
//! weights keep shoes and cables from pulling. Source: book, Floor and dirt: Floor plane.

use super::depth_noise::DepthNoise;
use super::lanes::{LaneSums, Lanes};
use super::lattice::Lattice;
use super::normal_equations::NormalEquations;
use super::plane::{Plane, dot};
use floorguard_types::number::saturating_u32;

/// Unevenness of an ordinary floor, standard deviation in metres (book, Floor and dirt: Floor plane).
const UNEVENNESS_M: f32 = 0.005;
/// Huber's threshold in standard deviations (book, Floor and dirt: Floor plane).
const HUBER: f32 = 1.5;
/// Largest correction of the normal in one pass: 5° (book, Floor and dirt: Floor plane).
const TURN_MAX_RAD: f32 = 0.087_27;
/// Largest correction of the height in one pass, metres (book, Floor and dirt: Floor plane).
const SHIFT_MAX_M: f32 = 0.05;

/// Half widths of the bands after a search, metres: its plane errs by a degree. The last is the inlier distance of
/// the search; a wider one takes in the feet of furniture.
pub(super) const BANDS_AFTER_SEARCH_M: [f32; 6] = [0.03, 0.025, 0.02, 0.02, 0.02, 0.02];
/// The same from a prediction (book, Floor and dirt: Floor plane).
pub(super) const BANDS_AFTER_PREDICTION_M: [f32; 4] = [0.045, 0.03, 0.02, 0.02];

/// Expected variance of the heights of floor points, m², from the products of the plane's normal with their rays.
#[inline]
pub(super) fn height_variances_m2(noise: &DepthNoise, along_rays: Lanes, depths: Lanes) -> Lanes {
    noise.variances_m2(depths) * along_rays * along_rays
}

/// The plane after one pass for each band; `None` where too few points were left or the system is degenerate.
pub(super) fn refine(
    lattice: &Lattice<'_>,
    noise: &DepthNoise,
    start: Plane,
    bands_m: &[f32],
) -> Option<Plane> {
    let mut plane = start;
    for band in bands_m {
        plane = pass(lattice, noise, &plane, *band)?;
    }
    Some(plane)
}

fn pass(lattice: &Lattice<'_>, noise: &DepthNoise, plane: &Plane, band_m: f32) -> Option<Plane> {
    let [across, along] = plane.axes();
    let mut sums = [0.0; 9];
    for row in lattice.rows() {
        let mut part = LaneSums::default();
        for points in row {
            let along_rays = points.along_rays(plane.normal);
            let height = along_rays * points.z + plane.distance_m;
            let is_near = height.size().is_below(Lanes::all(band_m)) * points.is_return;
            let variance = height_variances_m2(noise, along_rays, points.z);
            let weight = weight(height, variance) * is_near;
            let (x, y) = (points.along_rays(across) * points.z, points.along_rays(along) * points.z);
            let (wx, wy, wh) = (weight * x, weight * y, weight * height * -1.0);
            part.take([wx * x, wx * y, wx, wy * y, wy, weight, wh * x, wh * y, wh]);
        }
        part.pour_into(&mut sums);
    }
    let [xx, xy, x, yy, y, one, hx, hy, h] = sums;
    let system = NormalEquations::of_sums([xx, xy, x, yy, y, one], [hx, hy, h]);
    let [turn_x, turn_y, shift] = system.solve()?;
    let turn = libm::sqrtf(turn_x * turn_x + turn_y * turn_y);
    let scale = if turn > TURN_MAX_RAD { TURN_MAX_RAD / turn } else { 1.0 };
    let corrected = |n: f32, (x, y): (f32, f32)| n + scale * (turn_x * x + turn_y * y);
    let ([nx, ny, nz], [ax, ay, az], [lx, ly, lz]) = (plane.normal, across, along);
    let normal = [corrected(nx, (ax, lx)), corrected(ny, (ay, ly)), corrected(nz, (az, lz))];
    let length = libm::sqrtf(dot(normal, normal)).max(1.0e-6);
    let distance = plane.distance_m + shift.clamp(-SHIFT_MAX_M, SHIFT_MAX_M);
    Plane::new(normal, distance / length)
}

/// Variance of the unevenness, m².
const UNEVEN_M2: f32 = UNEVENNESS_M * UNEVENNESS_M;

/// Weights of floor points, 1 for one without depth error at the height of the plane: over the variance within Huber's
/// threshold, over the standard deviation and the height beyond it. Both are one over the root of one product.
#[inline]
fn weight(height_m: Lanes, variance_m2: Lanes) -> Lanes {
    let variance = variance_m2 + UNEVEN_M2;
    let squared = height_m * height_m * (1.0 / (HUBER * HUBER));
    (variance * variance.larger(squared)).inverse_root() * UNEVEN_M2
}

/// How well a plane explains the points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitQuality {
    /// Lattice points with a return.
    pub returns: u32,
    /// Points near the plane: within three standard deviations and 3 cm (book, Floor and dirt: Floor plane).
    pub candidates: u32,
    /// Candidates within three standard deviations.
    pub inliers: u32,
    /// Points clearly below the plane.
    pub below: u32,
    /// Root mean square of the inliers' heights in standard deviations.
    pub normalised_rms: f32,
    /// Root mean square of the inliers' heights, metres.
    pub rms_m: f32,
}

/// Counts who is near, in and below the plane.
pub(super) fn quality(lattice: &Lattice<'_>, noise: &DepthNoise, plane: &Plane) -> FitQuality {
    const MARGIN_M: f32 = 0.03;
    const SIGMAS: f32 = 3.0;
    const BELOW_M: f32 = 0.05;
    // Returns, points below, candidates, inliers, their squared heights, and those over the variances.
    let mut sums = [0.0; 6];
    for row in lattice.rows() {
        let mut part = LaneSums::default();
        for points in row {
            let along_rays = points.along_rays(plane.normal);
            let height = along_rays * points.z + plane.distance_m;
            let variance = height_variances_m2(noise, along_rays, points.z) + UNEVEN_M2;
            let inverse_root = variance.inverse_root();
            let three_sigmas = variance * inverse_root * SIGMAS;
            let is_return = points.is_return;
            let is_below = (height + BELOW_M).is_below(three_sigmas * -1.0) * is_return;
            let is_candidate = height.size().is_below(three_sigmas + MARGIN_M) * is_return;
            let is_inlier = height.size().is_below(three_sigmas) * is_return;
            let squared = height * height * is_inlier;
            let normalised = squared * inverse_root * inverse_root;
            part.take([is_return, is_below, is_candidate, is_inlier, squared, normalised]);
        }
        part.pour_into(&mut sums);
    }
    let [returns, below, candidates, inliers, squares, normalised] = sums;
    let count = inliers.max(1.0);
    FitQuality {
        // Whole numbers below 2²⁴ are exact.
        returns: saturating_u32(returns),
        candidates: saturating_u32(candidates),
        inliers: saturating_u32(inliers),
        below: saturating_u32(below),
        normalised_rms: libm::sqrtf(normalised / count),
        rms_m: libm::sqrtf(squares / count),
    }
}
