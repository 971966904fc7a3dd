//! `floorguard train`: learns the tables that the core carries.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use floorguard_perception::legs::{KnownPlaces, LEG_CUES, Stump, near_floor_committee};
use floorguard_perception::people::shape::SHAPE_NAMES;
use floorguard_sim::Scenario;

use floorguard_host::outcome::{BadInput, WrongUsage};
use floorguard_laboratory::evaluate::{in_any_room, learn_legs, recordings, training_samples};
use floorguard_laboratory::train::{
    Boosting, Forest, LegSample, OnlinePlace, Sample, anchors, boost, built_in_scenes, draw_online,
    learn_place, leg_table, person_samples, person_table, quality, random_scenes, read_leg_scans,
    simulated_leg_samples, stretched,
};
use floorguard_robot::learning::{
    anchors_file, anchors_fingerprint, load_weights, save_weights, shipped_anchors,
};

/// What to learn.
#[derive(Clone, Debug, Args)]
pub struct TrainArguments {
    /// Which classifier.
    #[command(subcommand)]
    pub what: TrainWhat,
}

/// A classifier.
#[derive(Clone, Debug, Subcommand)]
pub enum TrainWhat {
    /// The shape of people in lidar sweeps, from simulated rooms and the built-in scenarios.
    #[command(after_help = "Example:\n  floorguard train people --out people.rs --scenes 40")]
    People(TrainPeopleArguments),
    /// What people look like in a new place, from tracks, without labels made by hand; the truth of the simulation judges.
    #[command(
        after_help = "Example:\n  floorguard train online --place hall --seconds 120 --model people.learned --out lesson"
    )]
    Online(TrainOnlineArguments),
    /// The anchors that ship with the program, on which nothing that a robot learns may do worse: from simulated rooms of other
    /// seeds than the classifier's.
    #[command(after_help = "Example:\n  floorguard train anchors --scenes 40 --out anchors.bin")]
    Anchors {
        /// Rooms.
        #[arg(long, default_value_t = 40, value_parser = clap::value_parser!(u64).range(4..=400))]
        scenes: u64,
        /// How many, half of them people.
        #[arg(long, default_value_t = 1_024)]
        count: usize,
        /// Where they go.
        #[arg(long)]
        out: PathBuf,
    },
    /// A small detector of people for `detect-people`, from rendered pictures: it knows nothing of real people.
    #[cfg(feature = "detector")]
    #[command(after_help = "Example:\n  floorguard train detector --out people.onnx")]
    Detector(super::train_detector::TrainDetectorArguments),
    /// Legs in scans, from labelled recordings.
    #[command(after_help = "Example:\n  floorguard train legs --scans scans.csv --out legs.rs")]
    Legs {
        /// Lines of source, scan, number of legs, legs `x:y;x:y`, ranges; the first line names the geometry.
        #[arg(long)]
        scans: PathBuf,
        /// Where the table goes.
        #[arg(long)]
        out: PathBuf,
        /// Keep the committee for a scanner near the floor, which learns from simulated rooms, as this program has it.
        #[arg(long)]
        recorded_only: bool,
    },
}

/// How to learn people.
#[derive(Clone, Debug, Args)]
pub struct TrainPeopleArguments {
    /// Where the table goes.
    #[arg(long)]
    pub out: PathBuf,
    /// First seed; a quarter of as many scenes again, with later seeds, is held out for the figures.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Random rooms to learn from; half as many built-in scenes are added.
    #[arg(long, default_value_t = 400, value_parser = clap::value_parser!(u64).range(4..))]
    pub scenes: u64,
}

/// How to learn online.
#[derive(Clone, Debug, Args)]
pub struct TrainOnlineArguments {
    /// A built-in scenario, or a scenario file; the robot stands at its start.
    #[arg(long, default_value = "supermarket")]
    pub place: String,
    /// Seed of the run.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How long the robot stands there.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub seconds: u32,
    /// Every length is multiplied by this: people and objects of other sizes than those that the shipped table
    /// knows.
    #[arg(long, default_value_t = 1.0)]
    pub scale: f32,
    /// Simulate so many rooms for the anchors, on which nothing may get worse, instead of those that ship with the program. What is
    /// learned beside them is of no use to `[learning]`.
    #[arg(long, value_parser = clap::value_parser!(u64).range(4..=400))]
    pub anchor_scenes: Option<u64>,
    /// What was learned: read if it is there, written at the end.
    #[arg(long)]
    pub model: Option<PathBuf>,
    /// A folder for the picture of precision and recall over time.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// One JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// The table cannot be written.
pub fn run(arguments: &TrainArguments) -> anyhow::Result<()> {
    match &arguments.what {
        TrainWhat::People(arguments) => people(arguments),
        TrainWhat::Online(arguments) => online(arguments),
        TrainWhat::Anchors { scenes, count, out } => write_anchors(*scenes, *count, out),
        #[cfg(feature = "detector")]
        TrainWhat::Detector(arguments) => super::train_detector::run(arguments),
        TrainWhat::Legs { scans, out, recorded_only } => legs(scans, out, *recorded_only),
    }
}

fn people(arguments: &TrainPeopleArguments) -> anyhow::Result<()> {
    let TrainPeopleArguments { out, seed, scenes } = arguments;
    let draw = |first: u64, count: u64| {
        let mut runs = random_scenes(first, count);
        runs.extend(built_in_scenes(first, count / 2));
        stretched(&person_samples(&runs), first)
    };
    let (training, held_out) = (draw(*seed, *scenes), draw(seed + scenes, (scenes / 4).max(1)));
    let forest = boost(&training, &Boosting::DEFAULT);
    let (seen, unseen) = (quality(&forest, &training), quality(&forest, &held_out));
    say!("on what it learnt from: {seen:?}\non other seeds:         {unseen:?}");
    print_use(&forest);
    let provenance = [
        format!("Simulated only: {scenes} random rooms and {} built-in scenes from seed {seed};", scenes / 2),
        format!(
            "{} candidates, {} of them people. On {} of later seeds:",
            seen.samples, seen.positives, unseen.samples
        ),
        format!(
            "precision {:.3}, recall {:.3}, calibration error {:.3}.",
            unseen.precision, unseen.recall, unseen.calibration_error
        ),
    ];
    std::fs::write(out, person_table(&forest, &provenance))
        .map_err(|error| BadInput(format!("{}: {error}", out.display())).into())
}

fn online(arguments: &TrainOnlineArguments) -> anyhow::Result<()> {
    let bad = |error: anyhow::Error| anyhow::Error::from(BadInput(format!("{error:#}")));
    if !(0.3..=3.0).contains(&arguments.scale) {
        return Err(WrongUsage(format!("--scale {}: 0.3 to 3", arguments.scale)).into());
    }
    let name = Path::new(&arguments.place).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let scenario = if Path::new(&arguments.place).is_file() {
        let text = std::fs::read_to_string(&arguments.place)
            .map_err(|error| BadInput(format!("{}: {error}", arguments.place)))?;
        Scenario::from_toml(&text)
    } else {
        Scenario::named(&arguments.place)
    };
    let scenario = scenario.map_err(|error| BadInput(format!("{}: {error}", arguments.place)))?;
    let anchors = arguments.anchor_scenes.map_or_else(shipped_anchors, anchors);
    let fingerprint = anchors_fingerprint(&anchors);
    let before = arguments.model.as_deref().map(|path| load_weights(path, fingerprint));
    let before = before.transpose().map_err(bad)?.flatten();
    let place = OnlinePlace {
        name,
        scenario,
        seed: arguments.seed,
        seconds: arguments.seconds as usize,
        scale: arguments.scale,
        sensor_height_m: 0.8,
    };
    let (report, weights) = learn_place(&place, &anchors, before.as_ref().map(|kept| &kept.weights));
    if let Some(model) = &arguments.model {
        save_weights(model, &weights, fingerprint).map_err(bad)?;
    }
    if let Some(folder) = &arguments.out {
        draw_online(folder, &report)?;
    }
    if arguments.json {
        tell!("{}", serde_json::to_string(&report)?)?;
        return Ok(());
    }
    for window in &report.windows {
        let [[precision, recall], [learned_precision, learned_recall]] = window.precision_recall;
        tell!(
            "{:6.0} s  shipped {precision:.3} {recall:.3}  learned {learned_precision:.3} {learned_recall:.3}  people, nobody, silent {:?}  taken, refused {:?}",
            window.until_s,
            window.labelled,
            window.judged
        )?;
    }
    Ok(())
}

fn write_anchors(scenes: u64, count: usize, out: &Path) -> anyhow::Result<()> {
    let all = anchors(scenes);
    // Pairs of a person and another, evenly from all rooms.
    let (pairs, _) = all.as_chunks::<2>();
    let wanted = (count / 2).clamp(1, pairs.len().max(1));
    let chosen: Vec<_> =
        (0..wanted).filter_map(|index| pairs.get(index * pairs.len() / wanted)).flatten().copied().collect();
    std::fs::write(out, anchors_file(&chosen)?)
        .map_err(|error| BadInput(format!("{}: {error}", out.display())))?;
    say!("{}: {} anchors of {}", out.display(), chosen.len(), all.len());
    Ok(())
}

fn legs(scans: &Path, out: &Path, recorded_only: bool) -> anyhow::Result<()> {
    let recordings = recordings(read_leg_scans(scans)?);
    let learnt_from = |map, before| training_samples(recordings.iter(), KnownPlaces { map, before });
    let kinds = [(true, false), (false, false), (true, true), (false, true)];
    let samples = kinds.map(|(map, before)| in_any_room(&learnt_from(map, before)));
    let [with_map, without_map, with_both, with_places] =
        samples.each_ref().map(|samples| learn_legs(samples));
    let (learnt_near_floor, near_floor) = if recorded_only {
        (near_floor_committee().to_vec(), "as it was before, from recorded and simulated scans".to_owned())
    } else {
        learn_near_floor(&learnt_from(false, false))
    };
    let sources: Vec<&str> = recordings.iter().map(|each| each.source.as_str()).collect();
    let provenance = [
        format!("From the labelled recordings {}, each scan as it is", sources.join(", ")),
        format!("and with every second beam. With a map: {};", count_of(&samples[0])),
        format!("without: {}. At places that earlier scans", count_of(&samples[1])),
        format!("showed, with a map: {}; without:", count_of(&samples[2])),
        format!("{}.", count_of(&samples[3])),
        format!("Near the floor: {near_floor}."),
    ];
    let committees: [&[Stump]; 5] = [&with_map, &without_map, &with_both, &with_places, &learnt_near_floor];
    std::fs::write(out, leg_table(committees, &provenance))
        .map_err(|error| BadInput(format!("{}: {error}", out.display())).into())
}

/// Half recorded, half simulated: what is learnt must not depend on the appearance of one source alone. With a word on
/// what it learnt from.
fn learn_near_floor(recorded: &[LegSample]) -> (Vec<Stump>, String) {
    let mut samples = simulated_leg_samples(&random_scenes(0, LEG_SCENES));
    samples.extend(simulated_leg_samples(&built_in_scenes(0, LEG_SCENES)));
    let simulated = samples.len();
    let every = (recorded.len() / simulated.max(1)).max(1);
    samples.extend(recorded.iter().map(|each| each.sample).step_by(every));
    let words = format!("{}, of which {simulated} come from simulated scans", count_of(&samples));
    (learn_legs(&samples), words)
}

fn count_of(samples: &[Sample<LEG_CUES>]) -> String {
    let positives = samples.iter().filter(|sample| sample.positive).count();
    format!("{positives} legs among {} segments", samples.len())
}

/// Simulated scenes of either kind in which legs are learnt.
const LEG_SCENES: u64 = 100;

/// How often each number is examined.
fn print_use(forest: &Forest) {
    for (index, name) in SHAPE_NAMES.iter().enumerate() {
        let nodes = forest.trees.iter().flat_map(|tree| tree.features.iter().zip(tree.thresholds));
        let used =
            nodes.filter(|(feature, border)| usize::from(**feature) == index && *border < f32::MAX).count();
        say!("{used:5} decisions by {name}");
    }
}
