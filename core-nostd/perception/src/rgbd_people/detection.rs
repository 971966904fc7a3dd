//! What the finder says: people with place, doubt and belief, and why there are none where there are none.

use heapless::Vec;

use super::silhouette::AREAS;
use floorguard_types::capacities::RGBD_PEOPLE_MAX;
use floorguard_types::geometry::Point2;

/// What was seen of a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RgbdKind {
    /// Head and shoulders.
    UpperBody,
    /// A pair of legs.
    Legs,
    /// Both, at one place.
    UpperBodyAndLegs,
}

/// A person as one picture shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RgbdDetection {
    /// What was seen.
    pub kind: RgbdKind,
    /// Where the person stands, robot frame (x forward, y left), metres.
    pub position_in_base: Point2,
    /// Covariance of the position in the robot's frame: xx, xy, yy, m².
    pub covariance_m2: [f32; 3],
    /// Distance from the camera's foot point, metres.
    pub distance_m: f32,
    /// Highest point above the floor, metres; of legs the top of the band.
    pub top_m: f32,
    /// Belief within 0..=1 that this is a person, from this one picture.
    pub confidence: f32,
    /// Mean squared difference from the silhouette; 0 for legs.
    pub score: f32,
    /// Mean squared difference of each area of the silhouette: head, torso, left and right of the head, beside the torso.
    pub differences: [f32; AREAS],
    /// Part of the silhouette that had a depth, within 0..=1; what has none speaks neither way.
    pub seen_share: f32,
    /// Corner of the rectangle in the picture, column and row.
    pub first_px: [u16; 2],
    /// Opposite corner, included.
    pub last_px: [u16; 2],
}

/// Why candidates did not become people. Together with the list they account for everything that was examined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RgbdCounters {
    /// Pixels with a depth.
    pub returns: u32,
    /// Regions of the floor on which something stands.
    pub regions: u32,
    /// Regions with a top too low or too high for a person.
    pub wrong_top: u32,
    /// Regions of which nothing reaches into the picture's upper part, or which are too small in it.
    pub out_of_view: u32,
    /// Heads that were tried, over all scales.
    pub heads: u32,
    /// Heads without enough depth to judge.
    pub unseen: u32,
    /// Heads that do not fit the silhouette.
    pub no_silhouette: u32,
    /// Heads that are the same person as a better one.
    pub suppressed: u32,
    /// Objects in the band of the legs.
    pub leg_parts: u32,
    /// Of them shaped like a leg.
    pub leg_candidates: u32,
    /// What was dropped: regions, heads, parts, people. There is more than the list says.
    pub dropped: u32,
}

/// People of one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RgbdPeople {
    /// Nearest first. An empty list is no statement about free space.
    pub people: Vec<RgbdDetection, RGBD_PEOPLE_MAX>,
    /// Account.
    pub counters: RgbdCounters,
}

impl RgbdPeople {
    /// Adds a person; the farthest is given up when the list is full.
    pub(super) fn keep(&mut self, person: RgbdDetection) {
        if self.people.is_full() {
            self.counters.dropped = self.counters.dropped.saturating_add(1);
            if self.people.last().is_some_and(|last| last.distance_m <= person.distance_m) {
                return;
            }
            self.people.pop();
        }
        let place = self.people.iter().position(|other| other.distance_m > person.distance_m);
        let place = place.unwrap_or(self.people.len());
        if self.people.insert(place, person).is_err() {
            self.counters.dropped = self.counters.dropped.saturating_add(1);
        }
    }
}

/// A covariance along and across the line of sight, turned into the robot's frame: xx, xy, yy.
pub(super) fn turned_covariance(along_m2: f32, across_m2: f32, bearing_rad: f32) -> [f32; 3] {
    let (sin, cos) = libm::sincosf(bearing_rad);
    [
        along_m2 * cos * cos + across_m2 * sin * sin,
        (along_m2 - across_m2) * sin * cos,
        along_m2 * sin * sin + across_m2 * cos * cos,
    ]
}
