//! Which people were seen, and from where: a buffer of fixed size that merges what it knows already.

use floorguard_types::geometry::{Point2, Point3, Pose2};
use floorguard_types::time::Stamp;

/// Entries of the buffer.
pub const SIGHTINGS: usize = 1_024;

/// A person at a place, seen from a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Surface of the person, in the map.
    pub person_in_map: Point3,
    /// Where the robot was at the time of the picture, in the map.
    pub seen_from_in_map: Pose2,
    /// Time of the newest picture.
    pub stamp: Stamp,
    /// Pictures merged into this entry, at least 1.
    pub count: u32,
}

/// What became of a sighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entered {
    /// A new entry.
    New,
    /// One that was known is seen again.
    Merged,
    /// The buffer is full: not entered, and counted.
    Full,
    /// A number is not finite: not entered, and counted.
    Refused,
}

/// The buffer. Invariant: at most `N` entries, all finite.
#[derive(Clone, Debug)]
pub struct Sightings<const N: usize = SIGHTINGS> {
    entries: heapless::Vec<Sighting, N>,
    left_out: u32,
}

/// People within this distance ...
const SAME_PLACE_M: f32 = 0.3;
/// ... seen from within this distance are one entry.
const SAME_POSE_M: f32 = 0.5;

impl<const N: usize> Default for Sightings<N> {
    fn default() -> Self {
        Self { entries: heapless::Vec::new(), left_out: 0 }
    }
}

impl<const N: usize> Sightings<N> {
    /// Enters a person. Cost: one pass over the entries.
    ///
    /// ```
    /// use floorguard_mapping::people_removal::{Entered, Sighting, Sightings};
    /// use floorguard_types::geometry::{Point3, Pose2};
    /// use floorguard_types::time::Stamp;
    ///
    /// let mut sightings = Sightings::<2>::default();
    /// let seen = |x_m| Sighting {
    ///     person_in_map: Point3::new(x_m, 0.0, 1.0),
    ///     seen_from_in_map: Pose2::default(),
    ///     stamp: Stamp::ZERO,
    ///     count: 1,
    /// };
    /// let entered = [2.0, 2.2, 4.0, 6.0].map(|x_m| sightings.enter(seen(x_m)));
    /// assert_eq!(entered, [Entered::New, Entered::Merged, Entered::New, Entered::Full]);
    /// assert_eq!((sightings.entries()[0].count, sightings.left_out()), (2, 1));
    /// ```
    pub fn enter(&mut self, sighting: Sighting) -> Entered {
        let Sighting { person_in_map: place, seen_from_in_map: pose, .. } = sighting;
        let numbers = [place.x_m, place.y_m, place.z_m, pose.x_m, pose.y_m, pose.heading_rad];
        if !numbers.iter().all(|number| number.is_finite()) {
            self.left_out = self.left_out.saturating_add(1);
            return Entered::Refused;
        }
        if let Some(known) = self.entries.iter_mut().find(|known| known.is_same(&sighting)) {
            known.count = known.count.saturating_add(sighting.count);
            known.stamp = known.stamp.max(sighting.stamp);
            return Entered::Merged;
        }
        if self.entries.push(sighting).is_err() {
            self.left_out = self.left_out.saturating_add(1);
            return Entered::Full;
        }
        Entered::New
    }

    /// The entries, in the order of their first sighting.
    #[must_use]
    pub fn entries(&self) -> &[Sighting] {
        &self.entries
    }

    /// Sightings that were not entered.
    #[must_use]
    pub const fn left_out(&self) -> u32 {
        self.left_out
    }
}

impl Sighting {
    fn is_same(&self, other: &Self) -> bool {
        let floor = |pose: Pose2| Point2::new(pose.x_m, pose.y_m);
        let (a, b) = (self.person_in_map, other.person_in_map);
        let apart = [a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m];
        let squared: f32 = apart.iter().map(|side| side * side).sum();
        squared <= SAME_PLACE_M * SAME_PLACE_M
            && floor(self.seen_from_in_map).distance(floor(other.seen_from_in_map)) <= SAME_POSE_M
    }
}
