//! Floor and clusters of a sweep.

use super::context::{PeopleCounters, SweepContext};
use super::state::PeoplePipeline;
use crate::capacities::SWEEP_RINGS;
use crate::people::clusters::Obstacles;
use crate::people::ground::FloorWalk;
use crate::people::projection::{RingProfile, SweepFrame};
use crate::sensing::{Sweep, SweepColumn};

/// Returns above this height hang over people's heads, metres.
const CEILING_M: f32 = 2.1;

impl PeoplePipeline {
    /// Floor and clusters.
    pub fn find_things(&mut self, sweep: &Sweep, context: &SweepContext) {
        self.counters = PeopleCounters::default();
        self.clusterer.clear();
        self.visibility.clear();
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        let mut obstacles = Obstacles::default();
        let mut profile = frames.still(&SweepColumn::UNKNOWN).profile(&self.angles);
        for column in sweep.used_columns() {
            obstacles.present = 0;
            if column.measured {
                if !frames.is_level() {
                    profile = frames.still(column).profile(&self.angles);
                }
                self.find_obstacles(column, &profile, &mut obstacles);
            } else {
                self.counters.unknown_columns = self.counters.unknown_columns.saturating_add(1);
            }
            self.clusterer.enter_column(&obstacles, &self.cluster_limits);
        }
        self.gather(sweep, &frames);
        // Element by element: a clone of the whole vector would pass over the stack.
        self.things.clear();
        for thing in &self.clusterer.clusters {
            // Same capacity: never full.
            let _ = self.things.push(*thing);
        }
        self.counters.clusters = self.things.len() as u32;
        self.counters.dropped_clusters = self.clusterer.dropped;
    }

    /// What of a column is neither floor nor too far nor too high.
    fn find_obstacles(&mut self, column: &SweepColumn, profile: &RingProfile, obstacles: &mut Obstacles) {
        let range_max_m = self.cluster_limits.range_max_m;
        let mut walk = FloorWalk::default();
        let (mut returns, mut near) = (0_u16, 0_u16);
        for ring in 0..SWEEP_RINGS {
            let raw = column.range_raw.get(ring).copied().unwrap_or(0);
            let (Some((along, rise, height_m)), Some(count)) =
                (profile.get(ring), obstacles.counts.get_mut(ring))
            else {
                continue;
            };
            if raw == 0 {
                continue;
            }
            let bit = 1_u16.wrapping_shl(ring as u32);
            returns |= bit;
            let raw = f32::from(raw);
            let (distance_m, height_m) = (raw * along, raw * rise + height_m);
            walk.step(bit, distance_m, height_m);
            if distance_m <= range_max_m && height_m < CEILING_M {
                near |= bit;
                *count = counts(distance_m);
            }
        }
        // Only the walk's end tells what was floor.
        let floor = walk.floor();
        obstacles.present = near & !floor;
        self.counters.points = self.counters.points.saturating_add(returns.count_ones());
        self.counters.floor_points = self.counters.floor_points.saturating_add(floor.count_ones());
        self.visibility.column(column.azimuth_cdeg, obstacles);
    }

    /// Turns the entered columns into clusters.
    pub(super) fn gather(&mut self, sweep: &Sweep, frames: &SweepFrame) {
        self.clusterer.close(&self.cluster_limits);
        for (index, column) in sweep.used_columns().iter().enumerate() {
            if self.clusterer.present_in(index) != 0 {
                let cells = (&frames.column(column), &column.range_raw, &self.angles);
                self.clusterer.add_column(index, cells, &self.cluster_limits);
            }
        }
        self.clusterer.finish();
    }
}

/// Horizontal distance in counts of 2 mm, as the clusterer takes it: an obstacle is never 0.
pub(super) fn counts(distance_m: f32) -> u16 {
    ((distance_m * 500.0) as u16).max(1)
}
