//! People who touch are one cluster for a lidar. Where the tracker expects two or more within one cluster, its returns
//! are shared out: each goes to the nearest expected person.

use heapless::Vec;

use crate::clusters::Cluster;
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::number::truncating_u16;

/// Expected people who are close to a cluster, of one sweep. More than this touch nobody.
pub(super) const SEEDS_MAX: usize = 32;

/// One person's share of a cluster.
#[derive(Clone, Copy, Debug)]
struct Share {
    /// Index of the cluster.
    cluster: u16,
    /// Where the person is expected, robot frame.
    expected: Point2,
    /// The returns of this share.
    part: Option<Cluster>,
    /// Slot among the candidates.
    slot: Option<u16>,
}

/// The shared clusters of a sweep.
#[derive(Clone, Debug)]
pub(super) struct Splits {
    shares: Vec<Share, SEEDS_MAX>,
}

impl Splits {
    pub(super) const fn new() -> Self {
        Self { shares: Vec::new() }
    }

    pub(super) fn clear(&mut self) {
        self.shares.clear();
    }

    /// Nothing is shared.
    pub(super) fn is_empty(&self) -> bool {
        self.shares.is_empty()
    }

    /// Finds the people expected within a cluster; two at least make it shared.
    pub(super) fn consider(
        &mut self,
        index: usize,
        cluster: &Cluster,
        expected: impl Iterator<Item = Point2>,
    ) {
        let [width_m, depth_m, _] = cluster.extent_m();
        if !(WIDTH_MIN_M..=WIDTH_MAX_M).contains(&width_m.max(depth_m)) {
            return;
        }
        let before = self.shares.len();
        for place in expected.filter(|place| is_within(*place, cluster)) {
            let is_new = |share: &Share| share.expected.distance(place) >= APART_MIN_M;
            if self.shares.iter().skip(before).all(is_new) {
                let fresh = Share { cluster: truncating_u16(index), expected: place, part: None, slot: None };
                // Beyond the capacity the cluster stays whole.
                let _ = self.shares.push(fresh);
            }
        }
        if self.shares.len() < before.saturating_add(2) {
            self.shares.truncate(before);
        }
    }

    /// The cluster is shared.
    pub(super) fn is_shared(&self, cluster: usize) -> bool {
        self.shares.iter().any(|share| usize::from(share.cluster) == cluster)
    }

    /// Gives a return of a cluster to the nearest expected person.
    pub(super) fn add(&mut self, cluster: usize, point: Point3, distance_m: f32) {
        if let Some(share) = self.nearest(cluster, point).and_then(|index| self.shares.get_mut(index)) {
            share
                .part
                .get_or_insert_with(|| Cluster::start(0, (point, distance_m)))
                .include(point, distance_m, 0);
        }
    }

    /// Cluster and returns of a share, by its index; `None` where nothing was seen of the person.
    pub(super) fn part(&self, index: usize) -> Option<(usize, Cluster)> {
        let share = self.shares.get(index)?;
        let mut part = share.part?;
        part.finish();
        // Its neighbour may hide a part of it.
        part.occluded = true;
        Some((usize::from(share.cluster), part))
    }

    /// The candidate that a share has become.
    pub(super) fn assign(&mut self, index: usize, slot: Option<usize>) {
        if let Some(share) = self.shares.get_mut(index) {
            share.slot = slot.map(truncating_u16);
        }
    }

    /// The candidate to which a return of a shared cluster belongs.
    pub(super) fn slot(&self, cluster: usize, point: Point3) -> Option<usize> {
        let share = self.nearest(cluster, point).and_then(|index| self.shares.get(index))?;
        share.slot.map(usize::from)
    }

    fn nearest(&self, cluster: usize, point: Point3) -> Option<usize> {
        let at = Point2::new(point.x_m, point.y_m);
        let shares =
            self.shares.iter().enumerate().filter(|(_, share)| usize::from(share.cluster) == cluster);
        let distances = shares.map(|(index, share)| (share.expected.distance(at), index));
        let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.filter(|(distance_m, _)| *distance_m < REACH_M).map(|(_, index)| index)
    }
}

/// Clusters narrower than this are one person, metres.
const WIDTH_MIN_M: f32 = 0.6;
/// Wider clusters are walls and shelves, metres.
const WIDTH_MAX_M: f32 = 3.0;
/// Somebody expected this far outside a cluster's box may belong to it, metres.
const MARGIN_M: f32 = 0.15;
/// Two expected places nearer to each other than this are one person, metres.
const APART_MIN_M: f32 = 0.1;
/// A return farther from the expected place than this is somebody else's, metres.
const REACH_M: f32 = 0.7;

fn is_within(place: Point2, cluster: &Cluster) -> bool {
    (cluster.lower.x_m - MARGIN_M..=cluster.upper.x_m + MARGIN_M).contains(&place.x_m)
        && (cluster.lower.y_m - MARGIN_M..=cluster.upper.y_m + MARGIN_M).contains(&place.y_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cluster as wide as two people: points along y from −0.5 to 0.5 m, 3 m ahead.
    fn wide() -> Cluster {
        let mut cluster = Cluster::start(0, (Point3::new(3.0, -0.5, 0.5), 3.0));
        points().for_each(|point| cluster.include(point, 3.0, 0));
        cluster.finish();
        cluster
    }

    fn points() -> impl Iterator<Item = Point3> {
        (0..41_u8).map(|step| Point3::new(3.0, 0.025 * f32::from(step) - 0.5, 0.5 + 0.01 * f32::from(step)))
    }

    #[test]
    fn two_expected_people_share_a_wide_cluster() {
        let mut splits = Splits::new();
        let places = [Point2::new(3.1, -0.3), Point2::new(3.1, 0.35), Point2::new(9.0, 0.0)];
        splits.consider(7, &wide(), places.into_iter());
        assert!(splits.is_shared(7) && !splits.is_shared(0));
        points().for_each(|point| splits.add(7, point, 3.0));
        let parts = [0, 1].map(|index| splits.part(index).expect("both were seen"));
        assert!(splits.part(2).is_none());
        let [left, right] = parts.map(|(cluster, part)| (cluster, part.centroid.y_m, part.points));
        assert!(
            left.1 < -0.2 && right.1 > 0.2 && left.2 + right.2 == 41 && left.0 == 7,
            "{left:?} {right:?}"
        );
        splits.assign(1, Some(1));
        assert_eq!(splits.slot(7, Point3::new(3.0, 0.4, 1.0)), Some(1));
    }

    #[test]
    fn single_expectation_or_narrow_cluster_stays_whole() {
        let mut splits = Splits::new();
        splits.consider(0, &wide(), [Point2::new(3.0, 0.0), Point2::new(3.0, 0.05)].into_iter());
        let mut narrow = wide();
        (narrow.lower.y_m, narrow.upper.y_m) = (-0.2, 0.2);
        splits.consider(1, &narrow, [Point2::new(3.0, -0.2), Point2::new(3.0, 0.2)].into_iter());
        assert!(splits.is_empty());
    }
}
