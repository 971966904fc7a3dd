//! What scans say about a place: returns on walls of the map for it, beams through walls against it.
//!
//! The weights were chosen in changed buildings (book, Mapping: Localisation).

use floorguard_types::geometry::Point2;

use super::known_map::KnownMap;
use crate::se2::Se2;

/// What a beam through a long wall takes away, in returns that lie on a wall: at the right place hardly one of a hundred does so...
const THROUGH_COST: f64 = 4.0;
/// ... what one through furniture does, which may have been taken away...
const FURNITURE_COST: f64 = 0.7;
/// ... what a return does that ends before anything the map knows: people and new furniture do so at the right place...
const SHORT_COST: f64 = 0.2;
/// ... and what it takes away besides if it lies on a long wall of the scans where the map knows free floor: nobody builds walls.
const UNMAPPED_COST: f64 = 8.0;

/// The same costs where a place is followed.
const FOLLOWED_THROUGH_COST: f64 = 1.5;
const FOLLOWED_SHORT_COST: f64 = 0.3;

/// No beam at all divides by this.
const BEAMS_LEAST: f64 = 1.0e-9;

/// A beam that is asked.
#[derive(Clone, Copy, Debug)]
pub struct AskedBeam {
    /// Where it ended, in the scanner's frame.
    pub point: Point2,
    /// What it counts.
    pub weight: f64,
    /// How surely what it ended on stays, by the scans alone: 0 furniture, 1 a long wall.
    pub permanence: f64,
}

/// Sums over beams, each by its weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Support {
    /// Beams.
    pub beams: f64,
    /// Sum of the values of the returns that lie near a wall of the map.
    pub near: f64,
    /// Beams that went through something, each counted as far as that stays where it is: a long wall 1, furniture 0.
    pub through: f64,
    /// The same, as far as it may have been taken away.
    pub furniture: f64,
    /// Beams that ended before anything that the map knows.
    pub short: f64,
    /// Those that ended on free floor of the map, each counted as far as what it ended on stays where it is.
    pub unmapped: f64,
}

impl Support {
    /// Asks a beam of a scan taken at a pose of the map.
    pub fn ask(&mut self, map: &KnownMap, pose: Se2, beam: &AskedBeam) {
        self.beams += beam.weight;
        let fate = map.fate(pose, beam.point);
        if let Some(permanence) = fate.crossed {
            self.through += beam.weight * f64::from(permanence);
            self.furniture += beam.weight * (1.0 - f64::from(permanence));
        }
        if fate.end > 0.0 {
            self.near += beam.weight * f64::from(fate.end);
        } else if fate.crossed.is_none() {
            self.short += beam.weight;
            if fate.ends_on_floor {
                self.unmapped += beam.weight * beam.permanence;
            }
        }
    }

    /// Asks every so manyth beam of a scan, each for one.
    pub fn ask_scan(&mut self, map: &KnownMap, (pose, points): (Se2, &[Point2]), beams_most: usize) {
        for point in thinned(points, beams_most) {
            self.ask(map, pose, &AskedBeam { point: *point, weight: 1.0, permanence: 0.0 });
        }
    }

    /// The balance, at most 1.
    pub fn value(&self) -> f64 {
        let clutter = self.near - FURNITURE_COST * self.furniture - SHORT_COST * self.short;
        clutter / self.beams.max(BEAMS_LEAST) - self.contradiction()
    }

    /// The balance of a place that is known and followed, at most 1: a wall that the map shows and that is not there, a door that stands
    /// open, is no reason to leave it.
    pub fn lenient_value(&self) -> f64 {
        let against =
            FOLLOWED_THROUGH_COST * (self.through + self.furniture) + FOLLOWED_SHORT_COST * self.short;
        (self.near - against) / self.beams.max(BEAMS_LEAST)
    }

    /// The part of the balance that no change of furniture explains: beams through walls, and walls that the map does not know.
    pub fn contradiction(&self) -> f64 {
        THROUGH_COST * self.through_share() + UNMAPPED_COST * self.unmapped / self.beams.max(BEAMS_LEAST)
    }

    /// Share of the beams that went through walls.
    pub fn through_share(&self) -> f64 {
        self.through / self.beams.max(BEAMS_LEAST)
    }
}

/// Every so manyth of the returns of a scan.
pub fn thinned(points: &[Point2], most: usize) -> impl Iterator<Item = &Point2> {
    points.iter().step_by(points.len().div_ceil(most.max(1)).max(1))
}
