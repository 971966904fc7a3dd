//! `floorguard tour FILE.csv`: the robot stands at each place of a list and looks, one after another.

use std::path::{Path, PathBuf};

use clap::Args;
use floorguard_robot::navigator::{NavigationPhase, NavigationProgress, TourProgress};
use floorguard_runtime::configuration::Mounting;
use floorguard_types::geometry::Pose2;

use super::exit::{BadInput, NotFinished};
use super::goto::driven;
use super::run::{Errand, RunOutputs};

/// The first line of a tour of the robot's own places.
const OF_ROBOT: &str = "x_m,y_m,heading_rad";
/// The first line of a tour of the lidar's places, as `clean-map` writes it.
const OF_LIDAR: &str = "lidar_x_m,lidar_y_m,lidar_heading_rad";
/// Places at most: as many sightings as the removal of people keeps.
const PLACES_MAX: usize = 1_024;
/// Beyond this a number is no place of a building, metres.
const FAR_M: f32 = 10_000.0;

/// Where to look from.
#[derive(Clone, Debug, Args)]
pub struct TourArguments {
    /// The places, in the map of [navigation]: a line `x_m,y_m,heading_rad`, then a place of the robot a line; or `revisits.csv` of
    /// `clean-map`, which holds places of the lidar, if the trajectory that was cleaned by is in the same map.
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
    conclude(&*driven((file, outputs), Errand::Tour(places))?, json)
}

fn conclude(progress: &NavigationProgress, json: bool) -> anyhow::Result<()> {
    let is_reached = progress.phase == NavigationPhase::Reached;
    // A tour of one place is a goal.
    let single = TourProgress { places: 1, seen_from: u32::from(is_reached), left_out: 0 };
    let tour = progress.tour.unwrap_or(single);
    let is_whole = is_reached && tour.seen_from == tour.places;
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

/// Places to look from, as a file gives them; at least one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TourPlaces {
    places_in_map: Vec<Pose2>,
    are_of_lidar: bool,
}

impl TourPlaces {
    /// Where the robot is when it looks from there, map frame.
    pub(super) fn of_robot(&self, lidar: &Mounting) -> Vec<Pose2> {
        let lidar_in_base = Pose2::new(lidar.position.x_m, lidar.position.y_m, lidar.yaw_rad);
        let offset = if self.are_of_lidar { lidar_in_base.inverse() } else { Pose2::default() };
        self.places_in_map.iter().map(|place| place.compose(offset)).collect()
    }
}

/// The places of a file.
///
/// # Errors
/// It cannot be read, holds no place or too many, or a line is no place: its number and what is expected.
pub(super) fn read_places(path: &Path) -> Result<TourPlaces, BadInput> {
    let bad = |line: usize, what: String| BadInput(format!("{}: line {line}: {what}", path.display()));
    let text =
        std::fs::read_to_string(path).map_err(|error| BadInput(format!("{}: {error}", path.display())))?;
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let are_of_lidar = match lines.next() {
        Some((_, OF_ROBOT)) => false,
        Some((_, OF_LIDAR)) => true,
        _ => return Err(bad(1, format!("a tour begins with the line `{OF_ROBOT}` or `{OF_LIDAR}`"))),
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
    Ok(TourPlaces { places_in_map: places, are_of_lidar })
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
    use floorguard_types::geometry::Point3;

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
        assert_eq!(places.places_in_map, [Pose2::new(1.0, -2.5, 0.5), Pose2::new(3.0, 4.0, 0.0)]);
        let ahead = Mounting { position: Point3::new(0.5, 0.1, 0.6), ..Mounting::default() };
        assert_eq!(places.of_robot(&ahead), places.places_in_map, "they are the robot's");
        let of_lidar = read("lidar_x_m,lidar_y_m,lidar_heading_rad\n3.0,4.0,0\n").unwrap().of_robot(&ahead);
        assert!((of_lidar[0].x_m - 2.5).abs() < 1e-6 && (of_lidar[0].y_m - 3.9).abs() < 1e-6, "{of_lidar:?}");
        for (text, what) in [
            ("1,2,3\n", "line 1: a tour begins with the line `x_m,y_m,heading_rad` or"),
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
