//! What scans say about a place: returns on walls of the map for it, beams through walls against it.

use floorguard_types::geometry::Point2;

use super::known_map::{BeamFate, KnownMap};
use crate::se2::Se2;

/// What a beam through a wall takes away, in returns that lie on a wall...
const THROUGH_COST: f64 = 1.5;
/// ... and what a return does that ends before anything the map knows: people and new furniture do so at the right place.
const SHORT_COST: f64 = 0.3;

/// Sums over beams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Support {
    /// Beams.
    pub beams: usize,
    /// Sum of the values of the returns that lie near a wall of the map.
    pub near: f64,
    /// Beams that went through a wall of the map.
    pub through: usize,
    /// Beams that ended on floor that the map knows as free.
    pub short: usize,
}

impl Support {
    /// Asks every so manyth beam of a scan, taken at a pose of the map.
    pub fn add(&mut self, map: &KnownMap, (pose, points): (Se2, &[Point2]), beams_most: usize) {
        for point in points.iter().step_by(points.len().div_ceil(beams_most.max(1)).max(1)) {
            self.beams += 1;
            match map.fate(pose, *point) {
                BeamFate::Wall(value) => self.near += f64::from(value),
                BeamFate::Through => self.through += 1,
                BeamFate::Short => self.short += 1,
            }
        }
    }

    /// Adds other beams.
    pub fn join(&mut self, other: &Self) {
        self.beams += other.beams;
        self.near += other.near;
        self.through += other.through;
        self.short += other.short;
    }

    /// The balance, at most 1.
    pub fn value(&self) -> f64 {
        let against = THROUGH_COST * self.through as f64 + SHORT_COST * self.short as f64;
        (self.near - against) / self.beams.max(1) as f64
    }

    /// Share of the beams that went through walls.
    pub fn through_share(&self) -> f64 {
        self.through as f64 / self.beams.max(1) as f64
    }
}
