//! From where the places behind people are looked at again, in the order of a short tour.

use floorguard_types::geometry::{Point2, Pose2, wrap_angle};

use super::sightings::{SIGHTINGS, Sighting};

/// Which poses are one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevisitRule {
    /// Poses within this distance, metres ...
    pub same_m: f32,
    /// ... and turned by at most this against each other are one, radians.
    pub same_rad: f32,
}

impl Default for RevisitRule {
    /// 0.5 m and 20°.
    fn default() -> Self {
        Self { same_m: 0.5, same_rad: 20.0_f32.to_radians() }
    }
}

/// Poses from which people were seen, each once, ordered by nearest neighbours from `start`; poses that cannot be reached are
/// left out. Cost: at most 1,024² distances.
///
/// ```
/// use floorguard_mapping::people_removal::{RevisitRule, Sighting, revisits};
/// use floorguard_types::geometry::{Point3, Pose2};
/// use floorguard_types::time::Stamp;
///
/// let seen_from = |x_m| Sighting {
///     person_in_map: Point3::new(0.0, 0.0, 1.0),
///     seen_from_in_map: Pose2::new(x_m, 0.0, 0.0),
///     stamp: Stamp::ZERO,
///     count: 1,
/// };
/// let sightings = [8.0, 2.0, 2.3, 5.0, 9.0].map(seen_from);
/// let tour = revisits(&sightings, Pose2::default(), RevisitRule::default(), |pose| pose.x_m < 8.5);
/// assert!(tour.iter().map(|pose| pose.x_m).eq([2.0, 5.0, 8.0]));
/// ```
#[must_use]
pub fn revisits(
    sightings: &[Sighting],
    start: Pose2,
    rule: RevisitRule,
    mut is_reachable: impl FnMut(Pose2) -> bool,
) -> heapless::Vec<Pose2, SIGHTINGS> {
    let mut tour: heapless::Vec<Pose2, SIGHTINGS> = heapless::Vec::new();
    for sighting in sightings.iter().take(SIGHTINGS) {
        let pose = sighting.seen_from_in_map;
        let is_known = tour.iter().any(|known| is_same(*known, pose, rule));
        if !is_known && is_reachable(pose) {
            // There is a place for each of the sightings.
            let _ = tour.push(pose);
        }
    }
    let mut from = start;
    for done in 0..tour.len() {
        let Some(rest) = tour.get_mut(done..) else { break };
        let mut nearest = (f32::INFINITY, 0);
        for (index, pose) in rest.iter().enumerate() {
            let away_m = place(from).distance(place(*pose));
            if away_m < nearest.0 {
                nearest = (away_m, index);
            }
        }
        rest.swap(0, nearest.1);
        from = rest.first().copied().unwrap_or(from);
    }
    tour
}

const fn place(pose: Pose2) -> Point2 {
    Point2::new(pose.x_m, pose.y_m)
}

fn is_same(a: Pose2, b: Pose2, rule: RevisitRule) -> bool {
    let turned_rad = libm::fabsf(wrap_angle(a.heading_rad - b.heading_rad));
    place(a).distance(place(b)) <= rule.same_m && turned_rad <= rule.same_rad
}
