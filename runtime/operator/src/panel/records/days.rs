//! What the robot did on a day.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Missions of a day that are kept.
const MISSIONS_MAX: usize = 50;
/// Places of a day that are kept.
const PLACES_MAX: usize = 200;

/// A mission, from its beginning to where it is or ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MissionRecord {
    /// What people call it; empty: the mission of the robot's file.
    pub name: String,
    /// When it began, RFC 3339.
    pub began: String,
    /// When it was last heard of, RFC 3339.
    pub ended: String,
    /// What it was doing then.
    pub phase: String,
    /// Cleaned in this mission and claimed, m².
    pub cleaned_m2: f32,
    /// Claimed because no dirt was expected there, m².
    pub assumed_m2: f32,
    /// Not claimed, m².
    pub to_do_m2: f32,
    /// Probability with which a cell that is claimed holds no more than what is tolerated, percent.
    pub confidence_percent: f64,
    /// Dirt that may stay in such a cell, units.
    pub tolerated_units: u8,
    /// Cells that are dirty and out of reach.
    pub unreachable_cells: usize,
    /// Held by people and other obstacles, seconds.
    pub waited_s: f32,
}

/// A day.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Day {
    /// Switched on, seconds.
    pub on_s: f64,
    /// Moving, seconds.
    pub moving_s: f64,
    /// Held by the guard, seconds.
    pub held_s: f64,
    /// Driven, metres.
    pub driven_m: f64,
    /// Stops by cause.
    pub stops: BTreeMap<String, u32>,
    /// Seconds held by cause.
    pub held_by_s: BTreeMap<String, f64>,
    /// Seconds held at a place of the map, `x,y` in whole metres.
    pub held_at_s: BTreeMap<String, f64>,
    /// Missions, the oldest first.
    pub missions: Vec<MissionRecord>,
}

impl Day {
    /// Held at a place for so long.
    pub fn hold_at(&mut self, place: String, lasted_s: f64) {
        if self.held_at_s.len() < PLACES_MAX || self.held_at_s.contains_key(&place) {
            *self.held_at_s.entry(place).or_default() += lasted_s;
        }
    }

    /// A mission that began, or more of it.
    pub fn mission(&mut self, record: MissionRecord) {
        let is_full = self.missions.len() >= MISSIONS_MAX;
        match self.missions.iter_mut().find(|known| known.began == record.began) {
            Some(known) => *known = record,
            None if is_full => {}
            None => self.missions.push(record),
        }
    }

    /// Cleaned and claimed, m².
    #[must_use]
    pub fn cleaned_m2(&self) -> f32 {
        self.missions.iter().map(|mission| mission.cleaned_m2).sum()
    }
}
