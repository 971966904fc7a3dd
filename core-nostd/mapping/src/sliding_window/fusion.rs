//! Neighbouring returns of one scan become one point (Dalmedico et al. 2019).

use floorguard_types::geometry::Point3;
use floorguard_types::number::nearest_f32;
use heapless::Vec;

use super::capacities::WINDOW_BEAMS_MAX;

/// A point of a scan, in the window's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ScanPoint {
    pub(super) point: Point3,
    /// It lies within a person's box.
    pub(super) is_person: bool,
}

/// The points of one scan.
pub(super) type ScanPoints = Vec<ScanPoint, WINDOW_BEAMS_MAX>;

/// The running mean of neighbours.
#[derive(Clone, Copy, Debug)]
struct Group {
    first: Point3,
    sum: Point3,
    count: u16,
    is_person: bool,
}

impl Group {
    const fn of(first: ScanPoint) -> Self {
        Self { first: first.point, sum: first.point, count: 1, is_person: first.is_person }
    }

    fn mean(&self) -> Point3 {
        // A group has a first point: never divided by 0.
        let share = 1.0 / nearest_f32(self.count.max(1));
        Point3::new(self.sum.x_m * share, self.sum.y_m * share, self.sum.z_m * share)
    }

    fn takes(&self, next: ScanPoint, reach: Reach) -> bool {
        let (from, reach_m) = match reach {
            Reach::OfFirst(reach_m) => (self.first, reach_m),
            Reach::OfMean(reach_m) => (self.mean(), reach_m),
        };
        let (x, y) = (next.point.x_m - from.x_m, next.point.y_m - from.y_m);
        let z = next.point.z_m - from.z_m;
        next.is_person == self.is_person && x * x + y * y + z * z < reach_m * reach_m
    }

    fn add(&mut self, next: Point3) {
        self.sum.x_m += next.x_m;
        self.sum.y_m += next.y_m;
        self.sum.z_m += next.z_m;
        self.count = self.count.saturating_add(1);
    }
}

/// How far neighbours may be that become one point, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reach {
    /// From the first of them: one point a cell.
    OfFirst(f32),
    /// From their mean so far, as published: a point for two cells of a wall, so that every second cell stays empty.
    OfMean(f32),
}

/// Replaces consecutive points by their mean as long as each is within reach. Points of people and others do not mix. One
/// pass, in place.
pub(super) fn fuse(points: &mut ScanPoints, reach: Reach) {
    let mut kept = 0_usize;
    let mut group = None::<Group>;
    // Not more groups than points were read: what is written has been read.
    for index in 0..points.len().min(WINDOW_BEAMS_MAX) {
        let Some(next) = points.get(index).copied() else { break };
        match &mut group {
            Some(current) if current.takes(next, reach) => current.add(next.point),
            _ => {
                keep(points, &mut kept, group);
                group = Some(Group::of(next));
            }
        }
    }
    keep(points, &mut kept, group);
    points.truncate(kept);
}

fn keep(points: &mut ScanPoints, kept: &mut usize, group: Option<Group>) {
    if let Some(group) = group
        && let Some(place) = points.get_mut(*kept)
    {
        *place = ScanPoint { point: group.mean(), is_person: group.is_person };
        *kept = kept.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(z_m: f32, is_person: bool) -> ScanPoint {
        ScanPoint { point: Point3::new(1.0, 0.0, z_m), is_person }
    }

    #[test]
    fn neighbours_become_their_mean() {
        let mut points = ScanPoints::new();
        for z_m in [0.0, 0.02, 0.04, 0.3, 0.31] {
            points.push(at(z_m, false)).unwrap();
        }
        fuse(&mut points, Reach::OfFirst(0.05));
        assert_eq!(points.len(), 2);
        assert!((points[0].point.z_m - 0.02).abs() < 1e-6 && (points[1].point.z_m - 0.305).abs() < 1e-6);
        assert!((points[0].point.x_m - 1.0).abs() < 1e-6);
    }

    /// A wall of points a centimetre apart, cells of 5 cm.
    #[test]
    fn the_reach_decides_how_many_stay() {
        for (reach, expected) in [(Reach::OfFirst(0.05), 17..=25), (Reach::OfMean(0.05), 10..=12)] {
            let mut points = ScanPoints::new();
            for step in 0..100_u16 {
                points.push(at(0.01 * f32::from(step), false)).unwrap();
            }
            fuse(&mut points, reach);
            assert!(expected.contains(&points.len()), "{reach:?}: {}", points.len());
        }
    }

    #[test]
    fn people_and_others_stay_apart() {
        let mut points = ScanPoints::new();
        for (z_m, is_person) in [(0.0, false), (0.01, true), (0.02, true), (0.03, false)] {
            points.push(at(z_m, is_person)).unwrap();
        }
        fuse(&mut points, Reach::OfFirst(0.05));
        assert_eq!(
            points.iter().map(|point| point.is_person).collect::<std::vec::Vec<_>>(),
            [false, true, false]
        );
        fuse(&mut ScanPoints::new(), Reach::OfMean(0.05));
    }
}
