//! Whether two places can really be the same: what was met from one must not lie where the other was seen through.

use floorguard_types::geometry::{Point2, Pose2};

use super::kept::KeptScan;

/// A return this much behind a point means that the scanner saw through the point, metres...
const BEHIND_M: f32 = 0.35;
/// ... and this share of the range.
const BEHIND_SHARE: f32 = 0.03;
/// A return this near to a point confirms it, metres.
const NEAR_M: f32 = 0.25;
/// A kept return speaks for this much to each side, as the sine of the angle: 40 of them cover a scan.
const SINE: f32 = 0.06;

/// How returns of one place agree with scans of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Agreement {
    judged: u32,
    contradicted: u32,
}

impl Agreement {
    /// Both directions together.
    pub(super) const fn and(self, other: Self) -> Self {
        Self {
            judged: self.judged.saturating_add(other.judged),
            contradicted: self.contradicted.saturating_add(other.contradicted),
        }
    }

    /// More than a share of the judged points was seen through.
    pub(super) fn exceeds(self, share: f32) -> bool {
        let number = |count: u32| floorguard_types::number::nearest_f32(count);
        number(self.contradicted) > share * number(self.judged)
    }
}

/// Asks scans about points. `frame` is the frame of the points in the map in which the scans have their poses.
pub(super) fn agreement<'a, const POINTS: usize>(
    points: impl Iterator<Item = Point2>,
    frame: Pose2,
    scans: impl Iterator<Item = &'a KeptScan<POINTS>> + Clone,
) -> Agreement {
    let mut result = Agreement::default();
    for point in points {
        let place = frame.transform(point);
        let (mut is_met, mut is_through) = (false, false);
        for scan in scans.clone() {
            let seen = scan.pose.inverse().transform(place);
            let away = seen.norm();
            for met in scan.returns() {
                is_met |= met.distance(seen) < NEAR_M;
                let beside = met.x_m * seen.y_m - met.y_m * seen.x_m;
                let ahead = met.x_m * seen.x_m + met.y_m * seen.y_m;
                let range = met.norm();
                let is_along = ahead > 0.0 && libm::fabsf(beside) < SINE * range * away;
                is_through |= is_along && range > away * (1.0 + BEHIND_SHARE) + BEHIND_M;
            }
        }
        result.judged = result.judged.saturating_add(u32::from(is_met || is_through));
        result.contradicted = result.contradicted.saturating_add(u32::from(is_through && !is_met));
    }
    result
}
