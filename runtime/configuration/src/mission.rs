//! The cleaning mission: which floor, what is dirty, how to clean it, and where it is kept.

use std::path::PathBuf;

use super::reader::Reader;

/// How a robot decides where to clean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CleaningStrategy {
    /// Visits what is dirty and plans again until the belief says that all is clean.
    Guarantee,
    /// Lanes over the whole floor.
    Systematic,
}

/// A cleaning mission. Paths are relative to the folder of the file that names them.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionConfiguration {
    /// A ROS `map_server` map, or a picture of 0.05 m a pixel.
    pub map: PathBuf,
    /// How to decide.
    pub strategy: CleaningStrategy,
    /// Lines of x_m, y_m, expected units, map frame; without it nothing is known to be dirty.
    pub dirt: Option<PathBuf>,
    /// Where the robot is switched on: x, y in metres and heading in radians, map frame.
    pub start: [f32; 3],
    /// Units that may stay in a clean cell, τ.
    pub tolerated_units: u8,
    /// Probability with which a cell called clean may hold more, δ.
    pub delta: f32,
    /// Where the mission is kept, so that a power cut forgets nothing.
    pub save: PathBuf,
}

pub(super) fn read_mission(section: Reader<'_>) -> Option<MissionConfiguration> {
    let map = section.text("map", "maps/hall.yaml").map(|(text, _)| PathBuf::from(text));
    let strategy = section.choice(
        "strategy",
        &[("guarantee", CleaningStrategy::Guarantee), ("systematic", CleaningStrategy::Systematic)],
    );
    let optional = |key: &'static str, example: &str, without: &str| {
        section.text_or_absent(key, example, without).map(|(text, _)| PathBuf::from(text))
    };
    let dirt = optional("dirt", "dirt.csv", "nothing is known to be dirty; not for `guarantee`");
    let save = optional("save", "mission.fgm", "mission.fgm").unwrap_or_else(|| PathBuf::from("mission.fgm"));
    let place = |key: &'static str| section.number_or(key, -10_000.0..=10_000.0, 0.0);
    let start = [place("start_x_m"), place("start_y_m")];
    let yaw_deg = section.number_or("start_yaw_deg", -360.0..=360.0, 0.0);
    let tolerated = section.number_or("tolerated_units", 0.0..=50.0, 5.0);
    let delta = section.number_or("delta", 0.000_1..=0.5, 0.01);
    let span = section.span().clone();
    if strategy == Some(CleaningStrategy::Guarantee) && dirt.is_none() {
        section.refuse(
            &span,
            "[mission]: the guarantee visits what is expected to be dirty, and `dirt` is missing",
            "write dirt = \"FILE.csv\" with lines of x_m,y_m,units, or strategy = \"systematic\"",
        );
    }
    section.finish();
    Some(MissionConfiguration {
        map: map?,
        strategy: strategy?,
        dirt,
        start: [start[0], start[1], yaw_deg.to_radians()],
        tolerated_units: tolerated as u8,
        delta,
        save,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    #[test]
    fn guarantee_without_dirt_is_refused() {
        let text = format!(
            "{EXAMPLE}\n[mission]\nmap = \"hall.yaml\"\nstrategy = \"guarantee\"\ndirt = \"dirt.csv\"\nstart_yaw_deg = 90.0\n"
        );
        let mission = parse("robot.toml", &text).unwrap().mission.unwrap();
        assert_eq!((mission.map, mission.tolerated_units), (PathBuf::from("hall.yaml"), 5));
        assert!((mission.start[2] - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert_eq!(mission.save, PathBuf::from("mission.fgm"));
        let refusal =
            |from: &str, to: &str| parse("robot.toml", &text.replace(from, to)).unwrap_err().to_string();
        assert!(refusal("dirt = \"dirt.csv\"\n", "").contains("`dirt` is missing"));
        assert!(refusal("\"guarantee\"", "\"random\"").contains("not known"));
        assert!(refusal("hall.yaml\"", "hall.yaml\"\nmpa = 1").contains("mpa"));
        assert!(parse("robot.toml", EXAMPLE).unwrap().mission.is_none());
    }
}
