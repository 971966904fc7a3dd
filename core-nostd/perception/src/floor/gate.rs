//! Is this fit the floor? Questions that a table, a wall or a bad frame answers wrongly.

use floorguard_types::number::nearest_f32;

use super::plane::Plane;
use super::refine::FitQuality;
use super::search::Expectation;

/// Limits of a valid fit (book, Floor and dirt: Validity).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitLimits {
    /// Least part of the lattice that must be floor.
    pub floor_share_min: f32,
    /// Least part of the points near the plane that lie in it.
    pub inlier_share_min: f32,
    /// Largest part of points clearly below the plane, of the inliers: more, and the plane is furniture. Mirrors and
    /// wet floor do bring some points from below.
    pub below_share_max: f32,
    /// Range of the normalised root mean square.
    pub normalised_rms: [f32; 2],
}

impl Default for FitLimits {
    fn default() -> Self {
        Self {
            floor_share_min: 0.02,
            inlier_share_min: 0.3,
            below_share_max: 0.2,
            // A lower bound of 0.3 would be for pure depth noise; with the unevenness in the denominator a floor that
            // is flatter than assumed has a smaller one.
            normalised_rms: [0.02, 3.0],
        }
    }
}

/// Why a fit is not the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitFault {
    /// No plane could be fitted to the points.
    Degenerate,
    /// Too few points in the plane: how many, of how many lattice points.
    TooFewInliers(u32, u32),
    /// Too many points below the plane: how many, for how many in it.
    PointsBelow(u32, u32),
    /// The points scatter too much or not at all: root mean square in standard deviations.
    Scatter(f32),
    /// The camera cannot be tilted like this against its mounting: radians, limit.
    Tilt(f32, f32),
    /// The camera cannot be at this height: metres.
    Height(f32),
}

impl core::fmt::Display for FitFault {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        const DEGREES: f32 = 180.0 / core::f32::consts::PI;
        match self {
            Self::Degenerate => write!(formatter, "no plane fits the points"),
            Self::TooFewInliers(found, of) => {
                write!(formatter, "only {found} of {of} points lie in the plane")
            }
            Self::PointsBelow(below, inliers) => {
                write!(formatter, "{below} points lie below a plane of {inliers}: it is not the floor")
            }
            Self::Scatter(rms) => write!(formatter, "the points scatter by {rms} standard deviations"),
            Self::Tilt(tilt, limit) => write!(
                formatter,
                "tilted by {:.1}° against the mounting, more than {:.1}°",
                tilt * DEGREES,
                limit * DEGREES
            ),
            Self::Height(height) => write!(formatter, "camera height {height} m contradicts the mounting"),
        }
    }
}

impl core::error::Error for FitFault {}

/// Every question in turn; the first wrong answer is the fault.
///
/// # Errors
/// The plane is not the floor; keep the last good one.
pub(super) fn check(
    plane: &Plane,
    quality: &FitQuality,
    (limits, expectation): (&FitLimits, &Expectation),
    lattice_size: usize,
) -> Result<(), FitFault> {
    let inliers = nearest_f32(quality.inliers);
    let [least, most] = limits.normalised_rms;
    let [lowest, highest] = expectation.distance_range_m;
    let tilt = expectation.mounted.tilt_from_rad(plane);
    if inliers < limits.floor_share_min * nearest_f32(lattice_size)
        || inliers < limits.inlier_share_min * nearest_f32(quality.candidates)
    {
        return Err(FitFault::TooFewInliers(quality.inliers, quality.candidates));
    }
    if nearest_f32(quality.below) > limits.below_share_max * inliers {
        return Err(FitFault::PointsBelow(quality.below, quality.inliers));
    }
    // A NaN is neither within nor outside: only "within" passes.
    if !(least..=most).contains(&quality.normalised_rms) {
        return Err(FitFault::Scatter(quality.normalised_rms));
    }
    if !(0.0..=expectation.tilt_max_rad).contains(&tilt) {
        return Err(FitFault::Tilt(tilt, expectation.tilt_max_rad));
    }
    if !(lowest..=highest).contains(&plane.distance_m) {
        return Err(FitFault::Height(plane.distance_m));
    }
    Ok(())
}
