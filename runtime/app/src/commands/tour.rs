//! `floorguard tour FILE.csv`: the robot stands at each place of a list and looks, one after another.

use std::path::{Path, PathBuf};

use clap::Args;
use floorguard_robot::navigator::{NavigationPhase, NavigationProgress};
use floorguard_types::geometry::Pose2;

use super::exit::{BadInput, NotFinished};
use super::map_here::MapHere;
use super::run::{self, Errand, RunArguments, RunOutputs};

/// The first line of a tour, as `clean-map` writes it.
const HEADER: &str = "x_m,y_m,heading_rad";
/// Places at most: as many sightings as the removal of people keeps.
const PLACES_MAX: usize = 1_024;
/// Beyond this a number is no place of a building, metres.
const FAR_M: f32 = 10_000.0;

/// Where to look from.
#[derive(Clone, Debug, Args)]
pub struct TourArguments {
    /// The places: a line `x_m,y_m,heading_rad`, then a place a line, of the robot in its map; `revisits.csv` of `clean-map`.
    pub places: PathBuf,
    /// The configuration, with the map in [navigation].
    #[arg(default_value = "robot.toml")]
    pub file: PathBuf,
    /// How long, and what is written of it.
    #[command(flatten)]
    pub outputs: RunOutputs,
}

/// Runs the command.
///
/// # Errors
/// As `run`; and the robot did not look from every place.
pub fn run(arguments: &TourArguments) -> anyhow::Result<()> {
    let places = read_places(&arguments.places)?;
    let TourArguments { file, outputs, .. } = arguments.clone();
    let json = outputs.json;
    let arguments = RunArguments { file, learn: None, map_here: MapHere::default(), outputs };
    let drive = run::run_to(&arguments, Some(Errand::Tour(places)))?;
    match drive.and_then(|drive| drive.watch.get()) {
        Some(progress) => conclude(&progress, json),
        None => Err(NotFinished("the drive never began".to_owned()).into()),
    }
}

fn conclude(progress: &NavigationProgress, json: bool) -> anyhow::Result<()> {
    let tour = progress.tour.unwrap_or_default();
    let is_single = progress.tour.is_none();
    let is_whole = progress.phase == NavigationPhase::Reached && (is_single || tour.seen_from == tour.places);
    if json {
        let line = serde_json::json!({
            "type": "tour", "whole": is_whole, "phase": progress.phase.name(), "reason": progress.words,
            "places": tour.places, "seen_from": tour.seen_from, "left_out": tour.left_out,
            "distance_m": progress.distance_m, "plans": progress.plans,
        });
        tell!("{line}")?;
    }
    say!("floorguard tour: {}, {:.1} m driven", progress.words, progress.distance_m);
    if is_whole {
        return Ok(());
    }
    Err(NotFinished(format!("the tour is not finished: {}", progress.words)).into())
}

/// The places of a file.
///
/// # Errors
/// It cannot be read, holds no place or too many, or a line is no place: its number and what is expected.
pub(super) fn read_places(path: &Path) -> Result<Vec<Pose2>, BadInput> {
    let bad = |line: usize, what: String| BadInput(format!("{}: line {line}: {what}", path.display()));
    let text =
        std::fs::read_to_string(path).map_err(|error| BadInput(format!("{}: {error}", path.display())))?;
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let Some((_, HEADER)) = lines.next() else {
        return Err(bad(1, format!("a tour begins with the line `{HEADER}`")));
    };
    let mut places = Vec::new();
    for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
        places.push(place(line).ok_or_else(|| {
            bad(number, format!("`{line}` is no place; write metres, metres and radians: 14.5,4.5,1.57"))
        })?);
        if places.len() > PLACES_MAX {
            return Err(bad(number, format!("more than {PLACES_MAX} places; cut the tour")));
        }
    }
    if places.is_empty() {
        return Err(bad(2, "there is no place to look from".to_owned()));
    }
    Ok(places)
}

fn place(line: &str) -> Option<Pose2> {
    let numbers: Vec<f32> = line.split(',').map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    match numbers.as_slice() {
        &[x_m, y_m, heading_rad]
            if x_m.abs() <= FAR_M && y_m.abs() <= FAR_M && heading_rad.abs() <= std::f32::consts::TAU =>
        {
            Some(Pose2::new(x_m, y_m, heading_rad))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_line_of_a_tour_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("tour.csv");
        let read = |text: &str| {
            std::fs::write(&file, text).unwrap();
            read_places(&file).map_err(|error| error.to_string())
        };
        let places = read("x_m,y_m,heading_rad\n1.0,-2.5,0.5\n\n3, 4, 0\n").unwrap();
        assert_eq!(places, [Pose2::new(1.0, -2.5, 0.5), Pose2::new(3.0, 4.0, 0.0)]);
        for (text, what) in [
            ("1,2,3\n", "line 1: a tour begins with the line `x_m,y_m,heading_rad`"),
            ("x_m,y_m,heading_rad\n", "there is no place to look from"),
            ("x_m,y_m,heading_rad\n1,2,3\n1,nan,0\n", "line 3: `1,nan,0` is no place"),
            ("x_m,y_m,heading_rad\n1,2\n", "line 2"),
            ("x_m,y_m,heading_rad\n1,2,90\n", "radians"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }
}
