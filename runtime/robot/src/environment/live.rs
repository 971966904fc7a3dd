//! Learning while the robot works: from its own list of people, saved every minute.
//!
//! There is no map on the robot yet, so places are relative to where it was switched on: a robot that always starts
//! from its dock always learns the same places. What the safety scanner's beams passed through was watched, and
//! nothing else: what stands behind something is unknown, not empty.

use std::path::{Path, PathBuf};

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_mapping::environment::{PersonAt, WallTime};
use floorguard_perception::people::TrackStatus;
use floorguard_runtime::shared::Shared;
use floorguard_runtime::tasks::PERSON_PROBABILITY_MIN;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

use super::calendar::Calendar;
use super::model::Model;
use super::store::{load, save};

/// A new model reaches this far around the start, metres.
const REACH_M: f32 = 40.0;
/// People are recognised up to here, metres.
const RANGE_M: f32 = 12.0;
/// It is saved this often, and watching is noted this often, µs.
const SAVE_US: i64 = 60_000_000;
const WATCH_US: i64 = 1_000_000;

/// Learns while the robot works.
pub struct LiveLearner {
    path: PathBuf,
    model: Model,
    mounting: Pose2,
    last_sweep: Option<Stamp>,
    next_watch: WallTime,
    next_save: WallTime,
    first_id: u64,
    positions: u64,
}

impl LiveLearner {
    /// Opens a model, or begins one around the start; `mounting` is the scanner's.
    ///
    /// # Errors
    /// A model that cannot be read.
    pub fn open(path: &Path, mounting: Pose2, now: WallTime) -> anyhow::Result<Self> {
        let corners = (Point2::new(-REACH_M, -REACH_M), Point2::new(REACH_M, REACH_M));
        let model = match load(path)? {
            Some(loaded) => loaded.model,
            None => Model::over("robot", Calendar::of_this_computer(), corners)?,
        };
        let first_id = (now.as_micros() as u64) << 8;
        Ok(Self {
            path: path.to_owned(),
            model,
            mounting,
            last_sweep: None,
            next_watch: now,
            next_save: now.plus_micros(SAVE_US),
            first_id,
            positions: 0,
        })
    }

    /// Reads what perception has published. To be called many times a second.
    ///
    /// # Errors
    /// The model cannot be saved.
    pub fn learn<M: RawMutex>(&mut self, shared: &Shared<M>, now: WallTime) -> anyhow::Result<()> {
        let Some(robot) = shared.pose.get().map(|pose| pose.pose_in_odometry) else { return Ok(()) };
        let offset_s = self.model.calendar.offset_s(now);
        if let Some(scan) = shared.scan.get().filter(|_| now >= self.next_watch) {
            self.next_watch = now.plus_micros(WATCH_US);
            let seen = through(&scan, robot.compose(self.mounting));
            let _newer = self.model.core.watch(now, offset_s, seen);
        }
        if let Some(report) = shared.people.get().filter(|report| self.last_sweep != Some(report.sweep.stamp))
        {
            self.last_sweep = Some(report.sweep.stamp);
            for person in &report.people {
                let is_person = person.status == TrackStatus::Confirmed
                    && person.person_probability >= PERSON_PROBABILITY_MIN
                    && person.explanation.is_none()
                    && person.position.distance(Point2::new(robot.x_m, robot.y_m)) < RANGE_M;
                if is_person {
                    let id = self.first_id.wrapping_add(u64::from(person.id));
                    let person = PersonAt { id, position_in_map: person.position };
                    let _newer = self.model.core.observe(person, now, offset_s);
                    self.positions += 1;
                }
            }
        }
        if now >= self.next_save {
            self.next_save = now.plus_micros(SAVE_US);
            save(&self.path, &mut self.model)?;
        }
        Ok(())
    }

    /// Ends the watching and saves. Gives the positions of people that were learned.
    ///
    /// # Errors
    /// The model cannot be saved.
    pub fn finish(mut self, now: WallTime) -> anyhow::Result<u64> {
        self.model.settle(now);
        save(&self.path, &mut self.model)?;
        Ok(self.positions)
    }
}

/// What the beams of a scan passed through. An unknown beam saw nothing.
fn through(scan: &Scan, sensor: Pose2) -> impl Fn(Point2) -> bool {
    let reach_m: Vec<f32> = scan
        .beams
        .iter()
        .map(|beam| match beam {
            BeamReturn::Hit(mm) | BeamReturn::Free(mm) => (f32::from(*mm) * 1.0e-3).min(RANGE_M),
            BeamReturn::Unknown => 0.0,
        })
        .collect();
    let (first, step) = (scan.first_angle_rad, scan.step_rad.max(1.0e-6));
    let inverse = sensor.inverse();
    move |point| {
        let seen = inverse.transform(point);
        let distance_m = libm::hypotf(seen.x_m, seen.y_m);
        let beam = ((libm::atan2f(seen.y_m, seen.x_m) - first) / step).round();
        beam >= 0.0 && reach_m.get(beam as usize).is_some_and(|reach_m| distance_m < *reach_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_beams_passed_through_was_watched() {
        let mut scan = Scan { first_angle_rad: -1.5, step_rad: 0.5, ..Scan::default() };
        for beam in
            [BeamReturn::Free(30_000), BeamReturn::Hit(2_000), BeamReturn::Unknown, BeamReturn::Hit(5_000)]
        {
            scan.beams.push(beam).unwrap();
        }
        // The sensor looks to the left of the map: ahead is +y.
        let seen = through(&scan, Pose2::new(1.0, 1.0, std::f32::consts::FRAC_PI_2));
        let at = |bearing: f32, distance_m: f32| {
            let turn = bearing + std::f32::consts::FRAC_PI_2;
            seen(Point2::new(1.0 + distance_m * turn.cos(), 1.0 + distance_m * turn.sin()))
        };
        assert!(at(-1.5, 11.9) && !at(-1.5, 12.1), "as far as people are recognised");
        assert!(at(-1.0, 1.9) && !at(-1.0, 2.1), "not behind what was hit");
        assert!(!at(-0.5, 0.1), "not where the beam is unknown");
        assert!(at(0.0, 4.9) && !at(0.5, 1.0) && !at(-2.0, 1.0), "not outside the scan");
    }
}
