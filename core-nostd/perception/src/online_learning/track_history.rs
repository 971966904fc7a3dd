//! What one track did, in constant memory: how far, how fast, how it looked.

use super::experts::TrackSummary;
use crate::shapes::shape::ShapeVector;
use floorguard_types::capacities::LEARNING_SHAPES;
use floorguard_types::geometry::Point2;
use floorguard_types::number::{exact_usize, nearest_f32};
use floorguard_types::random::Pcg32;
use floorguard_types::time::{Age, Stamp};

/// The travel is measured in steps of this, µs: from sweep to sweep it would be noise.
const STEP_US: u64 = 500_000;

/// The history of a track.
#[derive(Clone, Debug)]
pub(super) struct TrackHistory {
    pub track: u32,
    began: Stamp,
    pub last: Stamp,
    start: Point2,
    step: (Point2, Stamp),
    walked_m: f32,
    strayed_m: f32,
    /// Sums of the places relative to the start and of their squares.
    sums: [f32; 4],
    count: u32,
    shapes_seen: u32,
    log_odds: (f32, f32),
    pub shapes: heapless::Vec<ShapeVector, LEARNING_SHAPES>,
}

impl TrackHistory {
    pub(super) fn new(track: u32, stamp: Stamp, place: Point2) -> Self {
        Self {
            track,
            began: stamp,
            last: stamp,
            start: place,
            step: (place, stamp),
            walked_m: 0.0,
            strayed_m: 0.0,
            sums: [0.0; 4],
            count: 0,
            shapes_seen: 0,
            log_odds: (f32::NEG_INFINITY, 0.0),
            shapes: heapless::Vec::new(),
        }
    }

    /// Enters where the track is now.
    pub(super) fn enter(&mut self, stamp: Stamp, place: Point2) {
        self.last = stamp;
        let (dx, dy) = (place.x_m - self.start.x_m, place.y_m - self.start.y_m);
        for (sum, value) in self.sums.iter_mut().zip([dx, dy, dx * dx, dy * dy]) {
            *sum += value;
        }
        self.count = self.count.saturating_add(1);
        self.strayed_m = self.strayed_m.max(libm::hypotf(dx, dy));
        let (before, since) = self.step;
        if matches!(since.age(stamp), Age::Past(age) if age >= STEP_US) {
            self.walked_m += before.distance(place);
            self.step = (place, stamp);
        }
    }

    /// Enters its shape and the log-odds it got; of many shapes an even choice is kept.
    pub(super) fn add_shape(&mut self, shape: &ShapeVector, log_odds: f32, random: &mut Pcg32) {
        self.shapes_seen = self.shapes_seen.saturating_add(1);
        let (best, sum) = self.log_odds;
        self.log_odds = (best.max(log_odds), sum + log_odds);
        if self.shapes.push(*shape).is_err()
            && let Some(slot) = self.shapes.get_mut(exact_usize(random.below(self.shapes_seen)))
        {
            *slot = *shape;
        }
    }

    pub(super) fn summary(&self) -> TrackSummary {
        let count = nearest_f32(self.count.max(1));
        let [x, y, xx, yy] = self.sums.map(|sum| sum / count);
        let (best, sum) = self.log_odds;
        let us = match self.began.age(self.last) {
            Age::Past(age) => age,
            Age::Future(_) => 0,
        };
        TrackSummary {
            seconds: nearest_f32(us) * 1.0e-6,
            walked_m: self.walked_m,
            strayed_m: self.strayed_m,
            variance_m2: (xx - x * x + yy - y * y).max(0.0),
            best,
            mean: sum / nearest_f32(self.shapes_seen.max(1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn travel_is_summed_over_half_seconds() {
        let mut history = TrackHistory::new(1, Stamp::ZERO, Point2::new(2.0, 0.0));
        for step in 1..=40_u32 {
            let noise = if step % 2 == 0 { 0.05 } else { 0.0 };
            let place = Point2::new(2.0 + 0.1 * step as f32, noise);
            history.enter(Stamp::from_micros(u64::from(step) * 100_000), place);
        }
        let summary = history.summary();
        assert!((summary.seconds - 4.0).abs() < 1e-4 && (summary.strayed_m - 4.0).abs() < 0.01);
        assert!((summary.walked_m - 4.0).abs() < 0.05, "{}", summary.walked_m);
    }
}
