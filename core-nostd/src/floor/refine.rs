//! From a rough plane to the best one: weighted least squares, a fixed number of times, in a narrowing band.
//!
//! A depth error moves a point along its ray, so its height errs by `σ_z |n·r|`: far floor counts less. On top comes
//! the unevenness of the floor itself, without which thousands of near pixels would outvote all others. Huber's
//! weights keep shoes and cables from pulling. Source: algorithms E.1 (height noise), E.2 step 4.

use super::depth_noise::DepthNoise;
use super::lattice::Lattice;
use super::normal_equations::NormalEquations;
use super::plane::{Plane, dot};

/// Unevenness of an ordinary floor, standard deviation in metres (algorithms E.3, acceptance test).
const UNEVENNESS_M: f32 = 0.005;
/// Huber's threshold in standard deviations (algorithms E.2).
const HUBER: f32 = 1.5;
/// Largest correction of the normal in one pass: 5° (algorithms E.2).
const TURN_MAX_RAD: f32 = 0.087_27;
/// Largest correction of the height in one pass, metres (algorithms E.2).
const SHIFT_MAX_M: f32 = 0.05;

/// Half widths of the bands after a search, metres: its plane errs by a degree. The last is the inlier distance of
/// algorithms E.2 step 3; a wider one takes in the feet of furniture.
pub(super) const BANDS_AFTER_SEARCH_M: [f32; 6] = [0.03, 0.025, 0.02, 0.02, 0.02, 0.02];
/// The same from a prediction (algorithms E.2 step 2).
pub(super) const BANDS_AFTER_PREDICTION_M: [f32; 4] = [0.045, 0.03, 0.02, 0.02];

/// Expected variance of the height of a floor point, m².
#[inline]
pub(super) fn height_variance_m2(noise: &DepthNoise, plane: &Plane, point: [f32; 3]) -> f32 {
    let [_, _, z] = point;
    let along_ray = dot(plane.normal, point) / z.max(1.0e-3);
    noise.variance_m2(z) * along_ray * along_ray
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
    let mut system = NormalEquations::default();
    for row in lattice.rows(0.0) {
        let mut part = NormalEquations::default();
        for point in row {
            let height = plane.height_m(point);
            if height.abs() < band_m {
                let weight = weight(height, height_variance_m2(noise, plane, point));
                part.add(weight, [dot(across, point), dot(along, point), 1.0], -height);
            }
        }
        system.merge(&part);
    }
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

/// Weight of a floor point, 1 for one without depth error at the height of the plane.
#[inline]
fn weight(height_m: f32, variance_m2: f32) -> f32 {
    const UNEVEN: f32 = UNEVENNESS_M * UNEVENNESS_M;
    let variance = variance_m2 + UNEVEN;
    let limit_m2 = HUBER * HUBER * variance;
    let squared = height_m * height_m;
    let huber = if squared > limit_m2 { libm::sqrtf(limit_m2 / squared) } else { 1.0 };
    huber * UNEVEN / variance
}

/// How well a plane explains the points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitQuality {
    /// Lattice points with a return.
    pub returns: u32,
    /// Points near the plane: within three standard deviations and 3 cm (algorithms E.2 step 2).
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
    let mut quality = FitQuality::default();
    let (mut squares, mut normalised) = (0.0_f32, 0.0_f32);
    for point in lattice.rows(0.0).flatten() {
        let height = plane.height_m(point);
        let variance = height_variance_m2(noise, plane, point) + UNEVENNESS_M * UNEVENNESS_M;
        let three_sigmas = SIGMAS * libm::sqrtf(variance);
        quality.returns = quality.returns.saturating_add(1);
        quality.below = quality.below.saturating_add(u32::from(height < -BELOW_M - three_sigmas));
        quality.candidates =
            quality.candidates.saturating_add(u32::from(height.abs() < MARGIN_M + three_sigmas));
        if height.abs() < three_sigmas {
            quality.inliers = quality.inliers.saturating_add(1);
            squares += height * height;
            normalised += height * height / variance;
        }
    }
    let count = (quality.inliers as f32).max(1.0);
    quality.rms_m = libm::sqrtf(squares / count);
    quality.normalised_rms = libm::sqrtf(normalised / count);
    quality
}
