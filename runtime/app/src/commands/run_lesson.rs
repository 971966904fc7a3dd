//! What a simulated run teaches the environment model.

use std::path::{Path, PathBuf};

use floorguard_laboratory::run_report::outlines;
use floorguard_laboratory::world::{Observation, Plan, TRACKED_RANGE_M};
use floorguard_mapping::environment::WallTime;
use floorguard_robot::environment::{Model, save, teach_run};
use floorguard_types::geometry::Point2;

use crate::learning::{PlaceArguments, bad, bounds, open};

/// When the first simulated run begins by default.
const FIRST_RUN: &str = "2026-04-06T08:00";

/// What is to be learned from a simulated run, made ready before it: a run of an hour must not end in a wrong date.
pub(super) struct RunLesson {
    path: PathBuf,
    model: Model,
    start: WallTime,
    outlines: Vec<Vec<Point2>>,
}

impl RunLesson {
    /// For a run that begins at `start`; without it, after what the model knows, or on a Monday morning.
    ///
    /// # Errors
    /// A model that cannot be read, an invalid moment.
    pub(super) fn prepare((path, start): (&Path, Option<&str>), plan: &Plan) -> anyhow::Result<Self> {
        let outlines: Vec<Vec<Point2>> = outlines(&plan.scenario.scene);
        let bounds = bounds(outlines.iter().flatten().map(|corner| (*corner, *corner)));
        let place =
            PlaceArguments { model: path.to_owned(), timezone: "UTC".to_owned(), map: None, zones: None };
        let model = open(&place, bounds).map_err(bad)?;
        let start = match (start, model.core.newest()) {
            (None, Some(newest)) => newest.plus_micros(1_000_000),
            (text, _) => model.calendar.parse(text.unwrap_or(FIRST_RUN)).map_err(bad)?,
        };
        Ok(Self { path: path.to_owned(), model, start, outlines })
    }

    /// Learns what the robot saw of people.
    ///
    /// # Errors
    /// A model that cannot be written, a time before what it knows.
    pub(super) fn learn(mut self, observation: &Observation) -> anyhow::Result<()> {
        let seen = (&*observation.people_seen, self.start);
        let lesson = teach_run(&mut self.model, seen, &self.outlines, TRACKED_RANGE_M).map_err(bad)?;
        save(&self.path, &mut self.model).map_err(bad)?;
        say!(
            "{}: learned {} positions of people in {:.0} s",
            self.path.display(),
            lesson.positions,
            lesson.seconds
        );
        Ok(())
    }
}
