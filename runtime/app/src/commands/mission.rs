//! `floorguard mission`: cleaning missions in simulation, and what their claims are worth.

use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::exit::Unfinished;
use super::heartbeat::Heartbeat;
use super::interrupt::end_at_ctrl_c;
use super::mission_table::MissionTable;
use super::mission_verdict::verdict;
use super::{BadInput, WrongUsage};
use floorguard_host::executor::StopFlag;
use floorguard_laboratory::mission::{
    FaultKind, FaultRates, Guarantee, Interrupted, Memory, MissionConfig, MissionStorage, Robot, RunMonitor,
    Strategy, StrategySummary, StrategyTrials, TrialResult, pictures, report, run_keeping,
    run_strategies_believing,
};
use floorguard_laboratory::mission::{expected_units, teach_cleaning};
use floorguard_laboratory::status::{MissionStatus, write_status};
use floorguard_mapping::environment::WallTime;
use floorguard_robot::environment::{Calendar, Model, load, read_zones, save};
use floorguard_robot::site::{DirtSource, Floor, rooms, ros_map};
use floorguard_types::random::Pcg32;

/// What to clean, how, and how often.
#[derive(Clone, Debug, Args)]
pub struct MissionArguments {
    /// A ROS map_server map (.yaml), a bare picture of 0.05 m a pixel, or one of: plain, furnished, supermarket.
    #[arg(long)]
    pub map: PathBuf,
    /// random:SHARE%:LOW-HIGH (expected units a cell), or a CSV file with x_m,y_m,units.
    #[arg(long)]
    pub dirt: DirtSource,
    /// One strategy, or several separated by commas.
    #[arg(long, value_delimiter = ',', default_value = "guarantee")]
    pub strategy: Vec<Strategy>,
    /// Units that may stay in a clean cell.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u8).range(0..=50))]
    pub tau: u8,
    /// Probability with which a cell that is called clean may hold more.
    #[arg(long, default_value_t = 0.01, value_parser = probability)]
    pub delta: f64,
    /// Missions a strategy.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    pub trials: u64,
    /// Seed of the first mission; the next ones count on.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// People on the floor.
    #[arg(long, default_value_t = 0, value_parser = people)]
    pub people: usize,
    /// What goes wrong, about every twenty seconds in all; without a list, everything does.
    #[arg(long, value_delimiter = ',', num_args = 0..=1, default_missing_value = "all")]
    pub faults: Vec<FaultKind>,
    /// What holds with a confidence of 1 − δ: the mission succeeds, each cell is clean, or all cells are at once.
    #[arg(long, default_value = "mission")]
    pub guarantee: Guarantee,
    /// What the robot sees its surroundings with; people and faults need the scanner.
    #[arg(long, default_value = "scanner")]
    pub sensor: Sensor,
    /// Keep what is known of the mission in this file about once a second, and go on from it after a power cut; it is
    /// removed at the end. For one mission of one strategy.
    #[arg(long)]
    pub resume: Option<PathBuf>,
    /// One line of JSON for each strategy on standard output.
    #[arg(long)]
    pub json: bool,
    /// Folder for maps and plots.
    #[arg(long, default_value = "floorguard-mission")]
    pub out: PathBuf,
    /// Write the operator's status report of the first mission, before and after, to this folder.
    #[arg(long)]
    pub report: Option<PathBuf>,
    /// The robot expects the dirt that this environment model expects, whatever `--dirt` puts there; the model, made
    /// if there is none, learns from the first mission of the first strategy how fast which place gets dirty.
    #[arg(long)]
    pub environment: Option<PathBuf>,
    /// When the missions are, for `--environment`: 2026-04-06T22:00; without it, now.
    #[arg(long, requires = "environment")]
    pub now: Option<String>,
    /// Zones by name for the report: a TOML file with [[zone]] name, corners_m.
    #[arg(long, requires = "report")]
    pub zones: Option<PathBuf>,
}

/// The range sensor of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Sensor {
    /// A safety scanner of 270°.
    Scanner,
    /// The depth camera of the published robot: 57°, 4 m. Enough for a room, not for a hall.
    DepthCamera,
}

/// More do not stand on any floor, and each of them costs time.
const PEOPLE_MAX: usize = 1_000;

fn people(text: &str) -> Result<usize, String> {
    let some = text.parse::<usize>().ok().filter(|people| *people <= PEOPLE_MAX);
    some.ok_or_else(|| format!("give 0 to {PEOPLE_MAX} people"))
}

fn probability(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err(format!("'{text}' is not a probability between 0 and 1")),
    }
}

/// A line of JSON.
#[derive(Serialize)]
struct JsonLine<'a> {
    map: &'a str,
    seed: u64,
    tau: u8,
    delta: f64,
    #[serde(flatten)]
    summary: &'a StrategySummary,
}

/// Runs the missions, reports, and writes the pictures.
///
/// # Errors
/// A map or dirt that cannot be used; a false claim rate of the guarantee that is significantly above δ.
pub fn run(arguments: &MissionArguments) -> anyhow::Result<()> {
    let floor = load_floor(arguments)?;
    say!("{}", report::scope(&floor));
    let beyond = arguments.dirt.lines_beyond(&floor).map_err(|error| BadInput(format!("{error:#}")))?;
    if beyond > 0 {
        say!("{beyond} lines of dirt lie beyond the part of the map that one mission answers for");
    }
    let config = config(arguments);
    let missions = arguments.trials * arguments.strategy.len() as u64;
    let bar = ProgressBar::new(missions).with_style(
        ProgressStyle::with_template("{bar:40} {pos}/{len} missions, {eta} left\n{msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    let mut prior = Prior::load(arguments, &floor)?;
    let believed = prior.as_ref().map(|prior| prior.believed.as_slice());
    let ended = StopFlag::default();
    end_at_ctrl_c(&ended, "the run ends here")?;
    say!("{}", robot_words(&config.robot));
    let heartbeat = Heartbeat::start(missions);
    let table = MissionTable::new(&arguments.strategy, arguments.trials);
    let progress = |strategy, result: &TrialResult| {
        bar.set_message(table.add(strategy, result));
        heartbeat.count(&bar);
    };
    let columns = match &arguments.resume {
        Some(file) => vec![kept_mission(arguments, (file, &ended), (&floor, &config), believed)?],
        None => run_strategies_believing(
            &floor,
            (&arguments.strategy, &config, &arguments.dirt),
            believed,
            (arguments.trials, arguments.seed),
            &RunMonitor { progress: &progress, ended: &ended },
        )?,
    };
    drop(heartbeat);
    bar.finish_and_clear();
    report_partial(&columns, arguments.trials)?;
    let summaries: Vec<StrategySummary> = columns.iter().map(StrategyTrials::summary).collect();
    say!("{}", report::table(&summaries).trim_end());
    say!("{}", report::proof(&summaries, arguments.delta).trim_end());
    if arguments.json {
        for summary in &summaries {
            let (seed, tau, delta) = (arguments.seed, arguments.tau, arguments.delta);
            let line = JsonLine { map: &floor.name, seed, tau, delta, summary };
            tell!("{}", serde_json::to_string(&line)?)?;
        }
    }
    draw(arguments, &floor, &columns)?;
    if let Some(prior) = &mut prior {
        prior.learn((&floor, &config), &columns)?;
    }
    if let Some(folder) = &arguments.report {
        let believed = prior.as_ref().map(|prior| prior.believed.as_slice());
        status_report(arguments, (folder, believed), (&floor, &config), &columns)?;
    }
    verdict(&summaries, arguments.delta)
}

/// The robot that is played: it is not the one of a robot.toml.
fn robot_words(robot: &Robot) -> String {
    format!(
        "the robot of these missions is round, {:.2} m wide, drives {:.2} m/s with a brush of {:.2} m; that of a robot.toml is \
         played by simulate",
        2.0 * robot.radius_m,
        robot.follow.speed_mps,
        robot.brush.width_m
    )
}

/// Somebody has ended the missions: how many count; an error if none does.
fn report_partial(columns: &[StrategyTrials], asked: u64) -> anyhow::Result<()> {
    let done = columns.iter().map(|column| column.trials.len() as u64).min().unwrap_or(0);
    if done == 0 {
        return Err(Unfinished("ended before the first mission was done".to_owned()).into());
    }
    if done < asked {
        say!("ended early: what follows is of {done} of {asked} missions");
    }
    Ok(())
}

fn load_floor(arguments: &MissionArguments) -> anyhow::Result<Floor> {
    let name = arguments.map.display().to_string();
    let map = match name.as_str() {
        "plain" => rooms::plain(),
        "furnished" => rooms::furnished(),
        "supermarket" => rooms::supermarket(),
        _ => ros_map::load(&arguments.map),
    };
    let stem = arguments.map.file_stem().map_or(name.clone(), |stem| stem.to_string_lossy().into_owned());
    let floor = map.and_then(|map| {
        let mut floor = Floor::new(&stem, map, Robot::PUBLISHED.radius_m)?;
        floor.keep_in_sight()?;
        Ok(floor)
    });
    floor.map_err(|error| {
        let why = format!("{error:#}");
        BadInput(if why.contains(&name) { why } else { format!("{name}: {why}") }).into()
    })
}

fn config(arguments: &MissionArguments) -> MissionConfig {
    let has_scanner =
        arguments.sensor == Sensor::Scanner || arguments.people > 0 || !arguments.faults.is_empty();
    MissionConfig {
        tolerated_units: arguments.tau,
        delta: arguments.delta,
        mission_risk: arguments.delta,
        guarantee: arguments.guarantee,
        robot: if has_scanner { Robot::WITH_SCANNER } else { Robot::PUBLISHED },
        people: arguments.people,
        faults: FaultRates::of(&arguments.faults),
        ..MissionConfig::published(Strategy::Guarantee)
    }
}

/// One mission whose memory is a file.
fn kept_mission(
    arguments: &MissionArguments,
    (file, ended): (&Path, &StopFlag),
    (floor, config): (&Floor, &MissionConfig),
    believed: Option<&[f32]>,
) -> anyhow::Result<StrategyTrials> {
    let bad = |error: anyhow::Error| BadInput(format!("{error:#}"));
    let &[strategy] = arguments.strategy.as_slice() else {
        return Err(WrongUsage("--resume keeps the mission of one strategy".to_owned()).into());
    };
    if arguments.trials != 1 {
        return Err(WrongUsage("--resume keeps one mission: --trials 1".to_owned()).into());
    }
    let config = MissionConfig { strategy, ..*config };
    let expected = arguments.dirt.expected_units(floor, &mut Pcg32::new(arguments.seed, 0)).map_err(bad)?;
    let before = Memory::load(file).map_err(bad)?;
    if let Some(memory) = &before {
        say!("{}: goes on after {:.0} s", file.display(), memory.time_s);
    }
    let mut keep = |memory: &Memory| memory.save(file);
    let storage = MissionStorage { from: before.as_ref(), keep: Some(&mut keep), ended: Some(ended) };
    let dirt = (expected.as_slice(), believed.unwrap_or(&expected));
    let result = run_keeping(floor, &config, dirt, (arguments.seed, storage)).map_err(|error| {
        if error.is::<Interrupted>() {
            Unfinished(format!("ended; the same command goes on from {}", file.display())).into()
        } else {
            anyhow::Error::from(bad(error))
        }
    })?;
    std::fs::remove_file(file).map_err(|error| bad(error.into()))?;
    Ok(StrategyTrials { strategy, trials: vec![result] })
}

fn draw(arguments: &MissionArguments, floor: &Floor, columns: &[StrategyTrials]) -> anyhow::Result<()> {
    std::fs::create_dir_all(&arguments.out)?;
    let expected = arguments.dirt.expected_units(floor, &mut Pcg32::new(arguments.seed, 0))?;
    let mut lines = Vec::new();
    for column in columns {
        let name = column.strategy.name();
        if let Some(first) = column.trials.first() {
            let path = arguments.out.join(format!("{name}.png"));
            pictures::mission_map(&path, floor, first, (&expected, u32::from(arguments.tau)))?;
        }
        let mut left: Vec<u32> = column.trials.iter().map(|t| t.quantile99).collect();
        left.sort_unstable();
        let count = left.len() as f64;
        let points =
            left.iter().enumerate().map(|(i, &units)| (f64::from(units), (i + 1) as f64 / count)).collect();
        lines.push(pictures::Series { name: name.to_owned(), points });
    }
    let names = ("Dirt left in the dirtiest 1 % of the dirty cells", "units", "share of missions");
    pictures::line_plot(&arguments.out.join("dirt_left.svg"), names, &lines)?;
    say!("pictures in {}", arguments.out.display());
    Ok(())
}

/// What the environment model expects, and where it learns.
struct Prior {
    path: PathBuf,
    model: Model,
    now: WallTime,
    believed: Vec<f32>,
}

impl Prior {
    fn load(arguments: &MissionArguments, floor: &Floor) -> anyhow::Result<Option<Self>> {
        let Some(path) = &arguments.environment else { return Ok(None) };
        let bad = |error: anyhow::Error| BadInput(format!("{error:#}"));
        let corner = |index: usize| floor.cells.centre(index);
        let corners = (corner(0), corner(floor.cells.cell_count().saturating_sub(1)));
        let model = match load(path).map_err(bad)? {
            Some(loaded) => loaded.model,
            None => Model::over(&floor.name, Calendar::of_this_computer(), corners).map_err(bad)?,
        };
        let now = match &arguments.now {
            Some(text) => model.calendar.parse(text).map_err(bad)?,
            None => Calendar::now(),
        };
        let believed = expected_units(&model, floor, now, Some(arguments.delta));
        Ok(Some(Self { path: path.clone(), model, now, believed }))
    }

    fn learn(
        &mut self,
        (floor, config): (&Floor, &MissionConfig),
        columns: &[StrategyTrials],
    ) -> anyhow::Result<()> {
        let Some(first) = columns.first().and_then(|column| column.trials.first()) else { return Ok(()) };
        let brush = (config.assumed_pickup, config.robot.brush.width_m);
        let lesson = teach_cleaning(&mut self.model, (floor, first), brush, self.now);
        save(&self.path, &mut self.model).map_err(|error| BadInput(format!("{error:#}")))?;
        say!("{}: {:.0} units in {} places learned", self.path.display(), lesson.units, lesson.places);
        Ok(())
    }
}

/// The first mission of the first strategy, for the operator.
fn status_report(
    arguments: &MissionArguments,
    (folder, believed): (&Path, Option<&[f32]>),
    (floor, config): (&Floor, &MissionConfig),
    columns: &[StrategyTrials],
) -> anyhow::Result<()> {
    let Some((column, first)) = columns.first().and_then(|column| Some((column, column.trials.first()?)))
    else {
        return Ok(());
    };
    let zones = match &arguments.zones {
        Some(path) => read_zones(path).map_err(|error| BadInput(format!("{error:#}")))?,
        None => Vec::new(),
    };
    let expected = arguments.dirt.expected_units(floor, &mut Pcg32::new(arguments.seed, 0))?;
    let brush_m = config.robot.brush.width_m;
    let promise = (arguments.tau, arguments.delta);
    let status = MissionStatus::new((floor, first, believed.unwrap_or(&expected)), promise, brush_m, &zones);
    let page = write_status(folder, &status, column.strategy.name())
        .map_err(|error| BadInput(format!("{error:#}")))?;
    say!("{}\nreport in {}", status.sentence(), page.display());
    Ok(())
}
