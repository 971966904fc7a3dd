//! `floorguard localise`: where the robot was in a known map, without a hint.

use std::path::{Path, PathBuf};

use floorguard_host::outcome::{BadInput, VerdictFailed, WrongUsage};
use floorguard_host::words::counted;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::localise::{
    Belief, KnownMap, LocaliseConfig, LocaliserStatistics, Located, MapChoice, MapUpdater, UpdateConfig,
};
use floorguard_mapping_host::metrics::write_tum;
use floorguard_mapping_host::output::{MARKER, OutputFile, check_place, map_server_files, replace_folder};
use serde_json::json;

use super::arguments::LocaliseArguments;
use super::input::Drive;
use super::progress::Progress;
use crate::files::{grid_map, write_whole};

/// The file of evidence in a folder of a map.
const EVIDENCE: &str = "evidence.txt";

/// The map that follows its building, and where it is written.
struct Update {
    updater: MapUpdater,
    out: PathBuf,
}

impl Update {
    fn open(arguments: &LocaliseArguments, out: &Path) -> anyhow::Result<Self> {
        check_place(out).map_err(|error| WrongUsage(error.to_string()))?;
        let is_folder = arguments.map.is_dir();
        let mut updater = MapUpdater::new(grid_map(&arguments.map)?, UpdateConfig::default());
        let evidence = std::fs::read_to_string(arguments.map.join(EVIDENCE));
        if let Some(evidence) = evidence.ok().filter(|_| is_folder)
            && !updater.resume(&evidence)
        {
            say!("note: the evidence of earlier drives is damaged or of another map: it is not used");
        }
        Ok(Self { updater, out: out.to_owned() })
    }

    fn write(mut self) -> anyhow::Result<()> {
        self.updater.finish_visit();
        let mut files = map_server_files(self.updater.map(), MARKER.trim_end_matches(".yaml"));
        files.push(OutputFile::new(EVIDENCE, self.updater.evidence()));
        replace_folder(&self.out, &files).map_err(|error| BadInput(error.to_string()))?;
        let (cells, visits) = (self.updater.changed as u64, u64::from(self.updater.finished));
        say!(
            "map: {} ({} changed after {})",
            self.out.display(),
            counted(cells, "cell"),
            counted(visits, "visit")
        );
        Ok(())
    }
}

/// Counts of all maps together.
fn joined(all: impl Iterator<Item = LocaliserStatistics>) -> LocaliserStatistics {
    all.fold(LocaliserStatistics::default(), |sum, each| LocaliserStatistics {
        searches: sum.searches + each.searches,
        nowhere: sum.nowhere + each.nowhere,
        ambiguous: sum.ambiguous + each.ambiguous,
        contradicted: sum.contradicted + each.contradicted,
        found: sum.found + each.found,
        lost: sum.lost + each.lost,
        not_later: sum.not_later + each.not_later,
        frozen: sum.frozen + each.frozen,
    })
}

/// What the scans so far came to.
#[derive(Default)]
struct Course {
    /// Names of the maps where there are several, and the present one.
    names: Vec<String>,
    map: Option<usize>,
    asked_for_help: bool,
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
    let paths: Vec<&Path> =
        [&arguments.map].into_iter().chain(&arguments.others).map(AsRef::as_ref).collect();
    let maps = paths.iter().map(|path| known_map(path, &config)).collect::<Result<Vec<_>, _>>()?;
    let mut update = arguments.update.as_deref().map(|out| Update::open(arguments, out)).transpose()?;
    let drive = Drive::open(&arguments.files, arguments.drive.options())?;
    drive.notes.iter().for_each(|note| say!("note: {note}"));
    let robot_in_scanner = drive.scanner_in_robot.inverse();
    let mut choice = MapChoice::new(maps, config);
    let mut course = Course::of(&paths);
    let progress = Progress::new(drive.scans);
    let read = drive.read(&|| progress.count(), &mut |record| {
        let chosen = choice.push(&record);
        let located = chosen.located;
        if let (Some(update), Some(pose)) =
            (&mut update, located.pose.filter(|_| located.belief == Belief::Found))
        {
            let front_end = &config.front_end;
            let points = record.points(front_end.range_least_m, front_end.range_most_m);
            update.updater.enter(record.time_s, pose, &points);
        }
        let pose = located.pose.map(|pose| pose.compose(robot_in_scanner));
        course.map = chosen.map;
        course.enter(record.time_s, Located { pose, ..located }, arguments.json)
    })?;
    progress.finish();
    if let Some(out) = &arguments.out {
        write_whole(out, write_tum(&course.trajectory).as_bytes())?;
    }
    if let Some(update) = update {
        update.write()?;
    }
    course.conclude(choice.localisers().iter().map(|each| each.statistics), arguments.json)?;
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
    fn of(paths: &[&Path]) -> Self {
        let names = if paths.len() > 1 { paths } else { &[] };
        Self { names: names.iter().map(|path| path.display().to_string()).collect(), ..Self::default() }
    }

    /// In which of several maps: empty where there is only one.
    fn place_name(&self) -> &str {
        self.map.and_then(|map| self.names.get(map)).map_or("", String::as_str)
    }

    fn ask_for_help(&mut self, at_s: f64, located: &Located, json: bool) {
        if located.asks_for_help && !self.asked_for_help && !json {
            say!("{at_s:8.1} s  asks for help: say where the robot is, or drive it on");
        }
        self.asked_for_help = located.asks_for_help;
    }

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
        self.ask_for_help(at_s, &located, json);
        if self.last == Some(belief) {
            return Ok(());
        }
        self.last = Some(belief);
        let pose = located.pose.unwrap_or_default();
        if json {
            let place = located.pose.map(|pose| json!([pose.x_m, pose.y_m, pose.heading_rad]));
            let row = json!({
                "time_s": time_s, "at_s": at_s, "belief": word(belief), "pose": place, "score": located.score,
                "deviation_m": located.deviation_m, "map": self.place_name()
            });
            tell!("{row}")?;
        } else if located.pose.is_some() {
            let (x_m, y_m, heading) = (pose.x_m, pose.y_m, pose.heading_rad.to_degrees());
            let map = self.place_name();
            say!("{at_s:8.1} s  {} at {x_m:.2}, {y_m:.2} m, {heading:.1}° {map}", word(belief));
        } else {
            say!("{at_s:8.1} s  {}", word(belief));
        }
        Ok(())
    }

    fn conclude(&self, all: impl Iterator<Item = LocaliserStatistics>, json: bool) -> anyhow::Result<()> {
        let (statistics, [unknown, doubt, found]) = (joined(all), self.scans);
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
