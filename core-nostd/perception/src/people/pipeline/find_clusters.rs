//! Floor and clusters of a sweep.

use super::context::{PeopleCounters, SweepContext};
use super::state::PeoplePipelineOf;
use crate::clusters::{FloorLimits, Obstacles, RingProfile, SweepFrame, rings_of};
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::number::{saturating_u32, truncating_u16, truncating_u32};
use floorguard_types::profile::{List, Profile};
use floorguard_types::sensing::{SweepColumnOf, SweepOf};

/// Returns above this height hang over people's heads, metres.
const CEILING_M: f32 = 2.1;

impl<P: Profile> PeoplePipelineOf<P> {
    /// Floor and clusters.
    // Not inlined, here and below: once in a program, and each frame is gone before the next one comes.
    #[inline(never)]
    pub fn find_clusters(&mut self, sweep: &SweepOf<P>, context: &SweepContext) {
        self.counters = PeopleCounters::default();
        self.clusterer.clear(&self.cluster_limits);
        self.visibility.clear();
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        let mut obstacles = Obstacles::default();
        let mut profile = frames.still(&SweepColumnOf::<P>::UNKNOWN).profile(&self.angles);
        let mut limits = FloorLimits::new(&profile);
        for column in sweep.used_columns() {
            obstacles.present = 0;
            if column.measured {
                if !frames.is_level() {
                    profile = frames.still(column).profile(&self.angles);
                    limits = FloorLimits::new(&profile);
                }
                self.find_obstacles(column, (&profile, &limits), &mut obstacles);
            } else {
                self.counters.unknown_columns = self.counters.unknown_columns.saturating_add(1);
            }
            self.clusterer.enter_column(&obstacles, &self.cluster_limits);
        }
        self.gather(sweep, &frames);
        // Element by element: a clone of the whole vector would pass over the stack.
        self.clusters.clear();
        for cluster in self.clusterer.clusters.iter() {
            // Same capacity: never full.
            let _ = self.clusters.push(*cluster);
        }
        self.counters.clusters = truncating_u32(self.clusters.len());
        self.counters.dropped_clusters = self.clusterer.dropped;
    }

    /// What of a column is neither floor nor too far nor too high.
    fn find_obstacles(
        &mut self,
        column: &SweepColumnOf<P>,
        (profile, limits): (&RingProfile, &FloorLimits),
        obstacles: &mut Obstacles,
    ) {
        let range_max_m = self.cluster_limits.range_max_m;
        let floor = limits.floor_of(&column.range_raw, profile);
        let returns = returns_of(&column.range_raw);
        let mut present = 0_u16;
        let mut sector = self.visibility.sector(column.azimuth_cdeg);
        for ring in rings_of(returns & !floor) {
            let (Some(raw), Some((along, rise, origin_m)), Some(count)) =
                (column.range_raw.get(ring), profile.get(ring), obstacles.counts.get_mut(ring))
            else {
                continue;
            };
            let raw = f32::from(*raw);
            let (distance_m, height_m) = (raw * along, raw * rise + origin_m);
            if distance_m <= range_max_m && height_m < CEILING_M {
                present |= 1_u16.wrapping_shl(truncating_u32(ring));
                *count = in_counts(distance_m);
                sector.include(*count);
            }
        }
        self.visibility.measured(column.azimuth_cdeg, sector);
        obstacles.present = present;
        self.counters.points = self.counters.points.saturating_add(returns.count_ones());
        self.counters.floor_points = self.counters.floor_points.saturating_add(floor.count_ones());
    }

    /// Turns the entered columns into clusters.
    #[inline(never)]
    pub(super) fn gather(&mut self, sweep: &SweepOf<P>, frames: &SweepFrame) {
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

/// The returns of a column, a bit per ring.
fn returns_of(range_raw: &[u16; SWEEP_RINGS]) -> u16 {
    let rings = range_raw.iter().zip(0_u32..);
    rings.fold(0, |bits, (raw, ring)| bits | if *raw == 0 { 0 } else { 1_u16.wrapping_shl(ring) })
}

/// Horizontal distance in counts of 2 mm, as the clusterer takes it: an obstacle is never 0.
pub(super) fn in_counts(distance_m: f32) -> u16 {
    truncating_u16(saturating_u32(distance_m * 500.0).clamp(1, u32::from(u16::MAX)))
}
