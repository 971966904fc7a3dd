//! `floorguard learn`: recorded tracks of people into the environment model of a place.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use floorguard_mapping::environment::WallTime;
use floorguard_types::geometry::Point2;

use floorguard_host::outcome::BadInput;
use floorguard_robot::environment::{
    Calendar, Lesson, Model, ReadTracks, TrackFormat, TrackReading, load, merge, pictures, read_tracks,
    read_zones, save, teach_recording,
};
use floorguard_robot::site::ros_map;

/// What to learn from.
#[derive(Clone, Debug, Args)]
pub struct LearnArguments {
    /// Make one model of those of several robots in this building, whatever their order: `--merge a.floorguard b.floorguard --model
    /// all.floorguard`. A model that is there already under that name is replaced.
    #[arg(long, num_args = 1.., value_name = "MODEL", conflicts_with_all = ["tracks", "start", "format", "rate"])]
    pub merge: Vec<PathBuf>,
    /// Recorded tracks, .gz or not: the layouts of ETH, UCY, L-CAS and HERMES, a table whose heading names time_s or frame,
    /// id, x_m and y_m (or as OpenTraj names them), or JSON with these names.
    pub tracks: Vec<PathBuf>,
    /// The model.
    #[command(flatten)]
    pub place: PlaceArguments,
    /// When the recordings began, on the clock on the wall: 2026-04-06T08:00; once for each, or once for the first,
    /// with the others following.
    #[arg(long)]
    pub start: Vec<String>,
    /// Layout of the recordings.
    #[arg(long, default_value = "auto")]
    pub format: TrackFormat,
    /// Frames a second of the recordings; without it, what a file tells or its layout is known for.
    #[arg(long, value_name = "FRAMES_PER_SECOND")]
    pub rate: Option<f64>,
    /// Write the heat map of all hours to this picture.
    #[arg(long)]
    pub picture: Option<PathBuf>,
}

/// The model, and what it is made with when it is new.
#[derive(Clone, Debug, Args)]
pub struct PlaceArguments {
    /// The model; made if there is none.
    #[arg(long, default_value = DEFAULT_MODEL)]
    pub model: PathBuf,
    /// For a new model: the clock on the wall, such as Europe/Berlin or +02:00.
    #[arg(long, default_value = "UTC")]
    pub timezone: String,
    /// For a new model: the ROS map whose floor it covers; without one, that of the tracks.
    #[arg(long)]
    pub map: Option<PathBuf>,
    /// Zones by name: a TOML file with [[zone]] name, corners_m.
    #[arg(long)]
    pub zones: Option<PathBuf>,
}

/// Where the model is kept unless another file is named.
pub const DEFAULT_MODEL: &str = "environment.floorguard";

pub(crate) fn bad(error: anyhow::Error) -> anyhow::Error {
    BadInput(format!("{error:#}")).into()
}

/// Runs the command.
///
/// # Errors
/// Files or times that cannot be used.
pub fn run(arguments: &LearnArguments) -> anyhow::Result<()> {
    if arguments.merge.is_empty() {
        return learn(arguments).map_err(bad);
    }
    merge_models(arguments).map_err(bad)
}

/// One model of several robots'.
fn merge_models(arguments: &LearnArguments) -> anyhow::Result<()> {
    let PlaceArguments { model: path, zones, .. } = &arguments.place;
    let read = |file: &PathBuf| {
        let loaded = load(file)?.with_context(|| format!("{}: there is no model", file.display()))?;
        loaded.passed_over.iter().for_each(|what| say!("passed over: {what}"));
        Ok(loaded.model)
    };
    let models = arguments.merge.iter().map(read).collect::<anyhow::Result<Vec<Model>>>()?;
    let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let mut merged = merge(&stem, models)?;
    if let Some(zones) = zones {
        merged.zones = read_zones(zones)?;
    }
    save(path, &mut merged)?;
    if let Some(picture) = &arguments.picture {
        pictures::write(picture, &merged, pictures::Layer::Trajectories, None)?;
    }
    say!("{} saved, of {} models", path.display(), arguments.merge.len());
    Ok(())
}

fn learn(arguments: &LearnArguments) -> anyhow::Result<()> {
    let reading = TrackReading { format: arguments.format, frames_per_second: arguments.rate };
    let recordings = arguments
        .tracks
        .iter()
        .map(|path| Ok((path, read_tracks(path, reading)?)))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let bounds = bounds(recordings.iter().filter_map(|(_, read)| read.recording.bounds()));
    let mut model = open(&arguments.place, bounds)?;
    let starts: Vec<WallTime> =
        arguments.start.iter().map(|text| model.calendar.parse(text)).collect::<anyhow::Result<_>>()?;
    let mut follows = None;
    for (index, (path, read)) in recordings.iter().enumerate() {
        let recording = &read.recording;
        let start = starts.get(index).copied().or(follows).with_context(|| {
            format!(
                "{}: recordings do not say when they were made; add --start 2026-04-06T08:00",
                path.display()
            )
        })?;
        let lesson =
            teach_recording(&mut model, recording, start).with_context(|| format!("{}", path.display()))?;
        follows = Some(start.plus_micros(recording.length_us().saturating_add(1_000_000)));
        tell(&model, (path, read), (start, lesson));
    }
    save(&arguments.place.model, &mut model)?;
    if let Some(picture) = &arguments.picture {
        pictures::write(picture, &model, pictures::Layer::Trajectories, None)?;
    }
    say!("{} saved, update {}", arguments.place.model.display(), model.generation);
    Ok(())
}

fn tell(model: &Model, (path, read): (&Path, &ReadTracks), (start, lesson): (WallTime, Lesson)) {
    let ReadTracks { recording, format, frames_per_second } = read;
    say!(
        "{} ({format:?}, {frames_per_second} frames a second): {} people, {} positions, {:.0} s from {}{}{}",
        path.display(),
        recording.people(),
        lesson.positions,
        lesson.seconds,
        model.calendar.words(start),
        if lesson.outside > 0 {
            format!("; {} positions outside the map", lesson.outside)
        } else {
            String::new()
        },
        if lesson.lost > 0 { format!("; {} entries did not fit", lesson.lost) } else { String::new() },
    );
}

pub(crate) fn bounds(all: impl Iterator<Item = (Point2, Point2)>) -> Option<(Point2, Point2)> {
    all.reduce(|(low, high), (a, b)| {
        (
            Point2::new(low.x_m.min(a.x_m), low.y_m.min(a.y_m)),
            Point2::new(high.x_m.max(b.x_m), high.y_m.max(b.y_m)),
        )
    })
}

/// The model on the disk, or a new one over the map or `bounds`.
pub(crate) fn open(place: &PlaceArguments, bounds: Option<(Point2, Point2)>) -> anyhow::Result<Model> {
    let loaded = load(&place.model)?;
    let mut model = match loaded {
        Some(loaded) => {
            loaded.passed_over.iter().for_each(|what| say!("passed over: {what}"));
            loaded.model
        }
        None => {
            let bounds = match &place.map {
                Some(map) => {
                    let map = ros_map::load(map)?;
                    let geometry = map.geometry();
                    Some((geometry.centre(0), geometry.centre(geometry.cell_count().saturating_sub(1))))
                }
                None => bounds,
            };
            let bounds =
                bounds.context("a new model needs tracks or a map to know how large the place is")?;
            let name =
                place.model.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            Model::over(&name, Calendar::named(&place.timezone)?, bounds)?
        }
    };
    if let Some(zones) = &place.zones {
        model.zones = read_zones(zones)?;
    }
    Ok(model)
}
