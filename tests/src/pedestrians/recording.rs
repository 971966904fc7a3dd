//! Recorded pedestrians by time: where everybody walked, and the middle of the place.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context as _;
use floorguard_types::geometry::Point2;

use crate::prediction::{TrackRow, rows};

/// From row to row of a person, seconds, and the pictures that lie between.
pub const SAMPLE_S: f32 = 0.4;
const FRAMES: i64 = 10;

/// One person's way through the scene, without a gap.
#[derive(Clone, Debug)]
pub struct Walk {
    /// When it begins, seconds from the beginning of the recording.
    pub begins_s: f32,
    /// Places every 0.4 s, at least two.
    pub places: Vec<Point2>,
}

impl Walk {
    /// When it ends.
    #[must_use]
    pub fn ends_s(&self) -> f32 {
        self.begins_s + self.lasts_s()
    }

    /// How long it lasts, seconds.
    #[must_use]
    pub fn lasts_s(&self) -> f32 {
        SAMPLE_S * (self.places.len() - 1) as f32
    }

    /// Somewhere on it, after a time on the way; at its ends before and after.
    #[must_use]
    pub fn after(&self, time_s: f32) -> Point2 {
        let last = self.places.len() - 1;
        let steps = (time_s / SAMPLE_S).clamp(0.0, last as f32);
        let from = (steps as usize).min(last - 1);
        let share = steps - from as f32;
        let (a, b) = (self.places[from], self.places[from + 1]);
        Point2::new(a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m))
    }

    /// Velocity after a time on the way, m/s.
    #[must_use]
    pub fn velocity_after(&self, time_s: f32) -> Point2 {
        let last = self.places.len() - 1;
        let from = ((time_s / SAMPLE_S).max(0.0) as usize).min(last - 1);
        let (a, b) = (self.places[from], self.places[from + 1]);
        Point2::new((b.x_m - a.x_m) / SAMPLE_S, (b.y_m - a.y_m) / SAMPLE_S)
    }

    /// Its length from a time on the way to another, metres.
    #[must_use]
    pub fn length_m(&self, from_s: f32) -> f32 {
        let first = (from_s / SAMPLE_S).max(0.0) as usize;
        let whole: f32 =
            self.places.iter().zip(&self.places[1..]).skip(first).map(|(a, b)| a.distance(*b)).sum();
        let begun_m = self.after(from_s).distance(self.places[first.min(self.places.len() - 1)]);
        (whole - begun_m).max(0.0)
    }
}

/// Everybody.
#[derive(Clone, Debug)]
pub struct Recording {
    /// In the order in which they begin.
    pub walks: Vec<Walk>,
    /// When it ends, seconds.
    pub ends_s: f32,
    /// The median of all places.
    pub middle: Point2,
}

impl Recording {
    /// Reads a file of frame, person, x and y. A person who is lost for a while begins another walk.
    ///
    /// # Errors
    /// A row that is no row, or nobody who walks.
    pub fn load(path: &Path) -> anyhow::Result<Self> {
        let rows = rows(path)?;
        let first = rows.iter().map(|row| row.frame).min().context("an empty recording")?;
        let seconds = |frame: i64| SAMPLE_S * ((frame - first) as f32) / FRAMES as f32;
        let mut people: BTreeMap<i64, Vec<TrackRow>> = BTreeMap::new();
        for row in &rows {
            people.entry(row.person).or_default().push(*row);
        }
        let mut walks = Vec::new();
        for track in people.values_mut() {
            track.sort_by_key(|row| row.frame);
            for part in track.chunk_by(|a, b| b.frame - a.frame == FRAMES).filter(|part| part.len() > 1) {
                let places = part.iter().map(|row| row.place).collect();
                walks.push(Walk { begins_s: seconds(part[0].frame), places });
            }
        }
        walks.sort_by(|a, b| a.begins_s.total_cmp(&b.begins_s));
        let ends_s = walks.iter().map(Walk::ends_s).fold(0.0, f32::max);
        let middle = Point2::new(
            median(rows.iter().map(|row| row.place.x_m).collect()),
            median(rows.iter().map(|row| row.place.y_m).collect()),
        );
        anyhow::ensure!(!walks.is_empty(), "nobody walks");
        Ok(Self { walks, ends_s, middle })
    }

    /// Where everybody is at a time.
    pub fn at(&self, time_s: f32) -> impl Iterator<Item = Point2> + '_ {
        let present = self.walks.iter().filter(move |walk| (walk.begins_s..walk.ends_s()).contains(&time_s));
        present.map(move |walk| walk.after(time_s - walk.begins_s))
    }
}

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walks_are_read_by_time() {
        let places = vec![Point2::default(), Point2::new(0.4, 0.0), Point2::new(0.4, 0.8)];
        let walk = Walk { begins_s: 2.0, places };
        assert!((walk.ends_s() - 2.8).abs() < 1e-6);
        assert!(walk.after(0.6).distance(Point2::new(0.4, 0.4)) < 1e-6);
        assert!(walk.velocity_after(0.2).distance(Point2::new(1.0, 0.0)) < 1e-6);
        assert!((walk.length_m(0.2) - 1.0).abs() < 1e-6 && (walk.length_m(0.0) - 1.2).abs() < 1e-6);
        assert!(walk.length_m(9.0) < 1e-6);
    }
}
