//! Whether two stretches can really be at the same place: what one saw must not lie where the other saw through.

use std::ops::Range;

use floorguard_types::geometry::Point2;

use crate::front_end::Node;
use crate::refine::ScanView;
use crate::se2::Se2;

/// How two stretches agree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Points that the other stretch could judge.
    pub judged: usize,
    /// Points near a return of the other stretch.
    pub confirmed: usize,
    /// Points that the other stretch saw through.
    pub contradicted: usize,
    /// All points.
    pub all: usize,
}

impl Agreement {
    /// Both directions together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            judged: self.judged + other.judged,
            confirmed: self.confirmed + other.confirmed,
            contradicted: self.contradicted + other.contradicted,
            all: self.all + other.all,
        }
    }

    /// Share of the judged points that were seen through.
    #[must_use]
    pub fn conflict_share(&self) -> f64 {
        self.contradicted as f64 / self.judged.max(1) as f64
    }

    /// Share of all points that were confirmed.
    #[must_use]
    pub fn overlap_share(&self) -> f64 {
        self.confirmed as f64 / self.all.max(1) as f64
    }
}

/// A return this much behind a point means that the scanner saw through the point, metres...
const BEHIND_M: f32 = 0.35;
/// ... and this share of the range.
const BEHIND_SHARE: f32 = 0.03;
/// A return this near confirms a point, metres.
const NEAR_M: f32 = 0.2;

/// Asks the scans `of` about points in the frame of their stretch, whose origin is `origin` in the frame of the tracking.
#[must_use]
pub fn agreement(
    points: &[Point2],
    origin: Se2,
    scans: (&[Node], &[ScanView]),
    of: Range<usize>,
) -> Agreement {
    let (nodes, views) = scans;
    let mut result = Agreement { all: points.len(), ..Agreement::default() };
    // Every third scan sees nearly what all of them see.
    let asked: Vec<usize> = of.clone().step_by(((of.end - of.start) / 8).max(1)).collect();
    let from_stretch: Vec<_> = asked.iter().map(|&node| nodes[node].pose.between(origin).single()).collect();
    for point in points {
        let (mut confirmed, mut through) = (false, 0);
        for (&node, pose) in asked.iter().zip(&from_stretch) {
            let place = pose.transform(*point);
            let range = place.norm();
            if views[node].nearest(place, NEAR_M).is_some() {
                confirmed = true;
                break;
            }
            let seen = views[node].seen_range_m(place);
            through += usize::from(seen.is_some_and(|seen| seen > range * (1.0 + BEHIND_SHARE) + BEHIND_M));
        }
        result.judged += usize::from(confirmed || through > 0);
        result.confirmed += usize::from(confirmed);
        result.contradicted += usize::from(!confirmed && through > 0);
    }
    result
}
