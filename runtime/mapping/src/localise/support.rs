//! What scans say about a place: returns on walls of the map for it, beams through walls against it.
//!
//! The weights were chosen in changed buildings (book, Mapping: Localisation).

use floorguard_types::geometry::Point2;

use super::known_map::KnownMap;
use crate::se2::Se2;

/// What a beam through a long wall takes away, in returns that lie on a wall: at the right place hardly one of a thousand does so...
const THROUGH_COST: f64 = 8.0;
/// ... what one through furniture does, which may have been taken away...
const FURNITURE_COST: f64 = 0.7;
/// ... and what a return does that ends before anything the map knows: people and new furniture do so at the right place.
const SHORT_COST: f64 = 0.2;

/// The same costs where a place is followed.
const FOLLOWED_THROUGH_COST: f64 = 1.5;
const FOLLOWED_SHORT_COST: f64 = 0.3;

/// Sums over beams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Support {
    /// Beams.
    pub beams: usize,
    /// Sum of the values of the returns that lie near a wall of the map.
    pub near: f64,
    /// Beams that went through something, each counted as far as that stays where it is: a long wall 1, furniture 0.
    pub through: f64,
    /// The same, as far as it may have been taken away.
    pub furniture: f64,
    /// Beams that ended on floor that the map knows as free.
    pub short: usize,
}

impl Support {
    /// Asks every so manyth beam of a scan, taken at a pose of the map.
    pub fn add(&mut self, map: &KnownMap, (pose, points): (Se2, &[Point2]), beams_most: usize) {
        for point in points.iter().step_by(points.len().div_ceil(beams_most.max(1)).max(1)) {
            self.beams += 1;
            let fate = map.fate(pose, *point);
            if let Some(permanence) = fate.crossed {
                self.through += f64::from(permanence);
                self.furniture += 1.0 - f64::from(permanence);
            }
            if fate.end > 0.0 {
                self.near += f64::from(fate.end);
            } else if fate.crossed.is_none() {
                self.short += 1;
            }
        }
    }

    /// The balance, at most 1.
    pub fn value(&self) -> f64 {
        let clutter = self.near - FURNITURE_COST * self.furniture - SHORT_COST * self.short as f64;
        clutter / self.beams.max(1) as f64 - self.contradiction()
    }

    /// The balance of a place that is known and followed, at most 1: a wall that the map shows and that is not there, a door that stands
    /// open, is no reason to leave it.
    pub fn lenient_value(&self) -> f64 {
        let against =
            FOLLOWED_THROUGH_COST * (self.through + self.furniture) + FOLLOWED_SHORT_COST * self.short as f64;
        (self.near - against) / self.beams.max(1) as f64
    }

    /// The part of the balance that no change of furniture explains: beams through walls.
    pub fn contradiction(&self) -> f64 {
        THROUGH_COST * self.through_share()
    }

    /// Share of the beams that went through walls.
    pub fn through_share(&self) -> f64 {
        self.through / self.beams.max(1) as f64
    }
}
