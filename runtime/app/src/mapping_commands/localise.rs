//! `floorguard localise`: where the robot was in a known map, without a hint.

use std::path::Path;

use floorguard_host::outcome::{BadInput, VerdictFailed};
use floorguard_host::words::counted;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::localise::{Belief, KnownMap, LocaliseConfig, Localiser, Located};
use floorguard_mapping_host::metrics::write_tum;
use serde_json::json;

use super::arguments::LocaliseArguments;
use super::files::{grid_map, write_whole};
use super::input::Drive;
use super::progress::Progress;

/// What the scans so far came to.
#[derive(Default)]
struct Course {
    first_s: Option<f64>,
    last: Option<Belief>,
    /// Scans with each belief: unknown, doubt, found.
    scans: [u64; 3],
    first_found_s: Option<f64>,
    trajectory: Vec<(f64, Se2)>,
}

/// Runs the command.
///
/// # Errors
/// Bad input, or a place that is not known at the end.
pub fn run(arguments: &LocaliseArguments) -> anyhow::Result<()> {
    let config = LocaliseConfig::default();
    let map = known_map(&arguments.map, &config)?;
    let drive = Drive::open(&arguments.files, arguments.drive.options())?;
    drive.notes.iter().for_each(|note| say!("note: {note}"));
    let robot_in_scanner = drive.scanner_in_robot.inverse();
    let mut localiser = Localiser::new(map, config);
    let mut course = Course::default();
    let progress = Progress::new(drive.scans);
    let read = drive.read(&|| progress.count(), &mut |record| {
        let located = localiser.push(&record);
        let pose = located.pose.map(|pose| pose.compose(robot_in_scanner));
        course.enter(record.time_s, Located { pose, ..located }, arguments.json)
    })?;
    progress.finish();
    if let Some(out) = &arguments.out {
        write_whole(out, write_tum(&course.trajectory).as_bytes())?;
    }
    course.conclude(&localiser, arguments.json)?;
    match (read.ended, course.last) {
        (Some(why), _) => Err(BadInput(format!("{why}; everything before was used")).into()),
        (None, Some(Belief::Found)) => Ok(()),
        (None, Some(Belief::Doubt)) => {
            Err(VerdictFailed("the place is in doubt at the end".to_owned()).into())
        }
        (None, _) => Err(VerdictFailed("I do not know where this is in the map".to_owned()).into()),
    }
}

fn known_map(path: &Path, config: &LocaliseConfig) -> Result<KnownMap, BadInput> {
    let map = grid_map(path)?;
    let bad = |what: &dyn std::fmt::Display| BadInput(format!("{}: {what}", path.display()));
    KnownMap::new(map, config).ok_or_else(|| bad(&"no wall in this map: nothing to find a place by"))
}

const fn word(belief: Belief) -> &'static str {
    match belief {
        Belief::Unknown => "not found",
        Belief::Doubt => "doubt",
        Belief::Found => "found",
    }
}

impl Course {
    fn enter(&mut self, time_s: f64, located: Located, json: bool) -> anyhow::Result<()> {
        let at_s = time_s - *self.first_s.get_or_insert(time_s);
        let belief = located.belief;
        let scans = match belief {
            Belief::Unknown => &mut self.scans[0],
            Belief::Doubt => &mut self.scans[1],
            Belief::Found => &mut self.scans[2],
        };
        *scans += 1;
        if belief == Belief::Found {
            self.first_found_s = self.first_found_s.or(Some(at_s));
            self.trajectory.extend(located.pose.map(|pose| (time_s, pose)));
        }
        if self.last == Some(belief) {
            return Ok(());
        }
        self.last = Some(belief);
        let pose = located.pose.unwrap_or_default();
        if json {
            let place = located.pose.map(|pose| json!([pose.x_m, pose.y_m, pose.heading_rad]));
            let row = json!({
                "time_s": time_s, "at_s": at_s, "belief": word(belief), "pose": place, "score": located.score
            });
            tell!("{row}")?;
        } else if located.pose.is_some() {
            let (x_m, y_m, heading) = (pose.x_m, pose.y_m, pose.heading_rad.to_degrees());
            say!("{at_s:8.1} s  {} at {x_m:.2}, {y_m:.2} m, {heading:.1}°", word(belief));
        } else {
            say!("{at_s:8.1} s  {}", word(belief));
        }
        Ok(())
    }

    fn conclude(&self, localiser: &Localiser, json: bool) -> anyhow::Result<()> {
        let (statistics, [unknown, doubt, found]) = (localiser.statistics, self.scans);
        if json {
            let row = json!({
                "verdict": word(self.last.unwrap_or_default()),
                "first_found_s": self.first_found_s,
                "scans_found": found,
                "scans_doubt": doubt,
                "scans_not_found": unknown,
                "searches": statistics.searches,
                "searches_nowhere": statistics.nowhere,
                "searches_ambiguous": statistics.ambiguous,
                "searches_contradicted": statistics.contradicted,
                "times_lost": statistics.lost,
            });
            tell!("{row}")?;
            return Ok(());
        }
        let first =
            self.first_found_s.map_or_else(|| "never".to_owned(), |at_s| format!("after {at_s:.1} s"));
        say!(
            "found {first}; known at {found} of {}, in doubt at {doubt}; {} of the map: {} without a place, {} with \
             several, {} through walls; lost {}",
            counted(unknown + doubt + found, "scan"),
            counted(statistics.searches as u64, "search"),
            statistics.nowhere,
            statistics.ambiguous,
            statistics.contradicted,
            counted(statistics.lost as u64, "time")
        );
        Ok(())
    }
}
