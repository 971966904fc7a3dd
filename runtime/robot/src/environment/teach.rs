//! Lets a model learn from recorded tracks and from what the robot saw on a run.

use anyhow::ensure;
use floorguard_mapping::environment::{PersonAt, Sighting, WallTime};
use floorguard_types::geometry::{Point2, Pose2};

use super::model::Model;
use super::sight::Sight;
use super::tracks::Recording;

/// Watching is noted this often, µs.
const WATCH_US: i64 = 1_000_000;
/// Half a place around the outermost tracks was in view, metres.
const RIM_M: f32 = 1.0;

/// The people that the robot saw at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct PeopleSeen {
    /// Microseconds since the start.
    pub at_us: u64,
    /// Where the robot was, in the world.
    pub robot: Pose2,
    /// Confirmed tracks by their number, in the world.
    pub people: Vec<(u64, Point2)>,
}

/// What a recording taught.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lesson {
    /// Positions taken.
    pub positions: u64,
    /// Positions outside the map of the model.
    pub outside: u64,
    /// Seconds watched.
    pub seconds: f64,
    /// Tracks, cells and hours beyond the capacity.
    pub lost: u64,
}

/// Learns a recording that began at `start`. Its cameras saw all of the rectangle in which its people are.
///
/// # Errors
/// The model knows of a later time already: recordings are learned in the order in which they were made.
pub fn teach_recording(model: &mut Model, recording: &Recording, start: WallTime) -> anyhow::Result<Lesson> {
    let Some((low, high)) = recording.bounds() else { return Ok(Lesson::default()) };
    let in_view = |point: Point2| {
        point.x_m >= low.x_m - RIM_M
            && point.x_m <= high.x_m + RIM_M
            && point.y_m >= low.y_m - RIM_M
            && point.y_m <= high.y_m + RIM_M
    };
    let mut learner = RecordingLearner::new(model, start)?;
    let mut watched_us = 0;
    for (&micros, points) in &recording.moments {
        while watched_us <= micros {
            learner.watch(start.plus_micros(watched_us), in_view);
            watched_us += WATCH_US;
        }
        for point in points {
            let person = PersonAt { id: point.id, position_in_map: point.position };
            learner.observe(person, start.plus_micros(micros));
        }
    }
    Ok(learner.finish(start.plus_micros(recording.length_us()), recording.length_us()))
}

/// Learns what the robot saw of people on a run that began at `start`, through walls and shelves excepted.
///
/// # Errors
/// As for [`teach_recording`].
pub fn teach_run(
    model: &mut Model,
    (seen, start): (&[PeopleSeen], WallTime),
    outlines: &[Vec<Point2>],
    range_m: f32,
) -> anyhow::Result<Lesson> {
    let sight = Sight::new(outlines.iter(), range_m);
    let mut learner = RecordingLearner::new(model, start)?;
    let mut next_watch_us = i64::MIN;
    for moment in seen {
        let micros = i64::try_from(moment.at_us).unwrap_or(i64::MAX);
        let at = start.plus_micros(micros);
        if micros >= next_watch_us {
            next_watch_us = micros.saturating_add(WATCH_US);
            learner.watch(at, sight.from(Point2::new(moment.robot.x_m, moment.robot.y_m)));
        }
        for (id, position_in_map) in &moment.people {
            learner.observe(PersonAt { id: *id, position_in_map: *position_in_map }, at);
        }
    }
    let last_us = seen.last().map_or(0, |moment| i64::try_from(moment.at_us).unwrap_or(i64::MAX));
    Ok(learner.finish(start.plus_micros(last_us), last_us))
}

/// A model that learns one recording.
struct RecordingLearner<'a> {
    model: &'a mut Model,
    offset_s: i32,
    lesson: Lesson,
    lost_before: u64,
    /// Numbers of tracks begin anew with every recording: what makes them different from those before.
    first_id: u64,
}

impl<'a> RecordingLearner<'a> {
    fn new(model: &'a mut Model, start: WallTime) -> anyhow::Result<Self> {
        if let Some(newest) = model.core.newest() {
            ensure!(
                start >= newest,
                "this begins on {}, but the model knows of {} already; learn recordings in the order of their time",
                model.calendar.words(start),
                model.calendar.words(newest)
            );
        }
        let (offset_s, lost_before) = (model.calendar.offset_s(start), lost(model));
        let first_id = (start.as_micros() as u64) << 8;
        Ok(Self { model, offset_s, lesson: Lesson::default(), lost_before, first_id })
    }

    fn watch(&mut self, at: WallTime, in_view: impl FnMut(Point2) -> bool) {
        self.offset_s = self.model.calendar.offset_s(at);
        let _newer = self.model.core.watch(at, self.offset_s, in_view);
    }

    fn observe(&mut self, mut person: PersonAt, at: WallTime) {
        person.id = person.id.wrapping_add(self.first_id);
        let inside = self.model.core.heat.cells().geometry().cell_at(person.position_in_map).is_some();
        if !inside {
            self.lesson.outside += 1;
        }
        if self.model.core.observe(person, at, self.offset_s) == Sighting::Taken {
            self.lesson.positions += 1;
        }
    }

    fn finish(mut self, end: WallTime, length_us: i64) -> Lesson {
        self.model.settle(end);
        self.lesson.seconds = length_us as f64 * 1.0e-6;
        self.lesson.lost = lost(self.model) - self.lost_before;
        self.lesson
    }
}

fn lost(model: &Model) -> u64 {
    u64::from(model.core.heat.dropped_tracks()) + u64::from(model.core.heat.hours().lost())
}
