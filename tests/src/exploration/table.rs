//! All buildings, both sets of rules, in one table.

use std::fmt::Write as _;
use std::path::Path;

use rayon::prelude::*;

use super::building::{BUILDINGS, Building};
use super::drive::{Explored, explore};
use super::hindsight::best_tour_m;
use super::rules::Rules;
use crate::data::recording;

/// Known of the reachable floor at least.
const COVERED_MIN: f64 = 0.99;
/// Way beside the best tour of the same view points at most.
const EXCESS_MAX: f64 = 1.3;

/// A line of the table.
struct Line {
    name: String,
    rules: Rules,
    area_m2: f64,
    explored: Explored,
    tour_m: f64,
}

impl Line {
    fn of(building: &Building, rules: Rules) -> anyhow::Result<Self> {
        let explored = explore(building, rules)?;
        let tour_m = best_tour_m(building, &explored.view_points)?;
        eprintln!("{} by {rules:?}: {} decisions", building.name, explored.decisions);
        Ok(Self { name: building.name.clone(), rules, area_m2: building.reachable_m2(), explored, tour_m })
    }

    fn excess(&self) -> f64 {
        self.explored.way_m / self.tour_m.max(0.1)
    }

    fn holds(&self) -> bool {
        let explored = &self.explored;
        explored.covered_share >= COVERED_MIN && self.excess() <= EXCESS_MAX && explored.has_ended
    }
}

/// Explores all buildings at hand and writes the table into `folder`. The second value says whether everything that must show
/// did.
///
/// # Errors
/// A map that cannot be read, or a folder that cannot be written.
pub fn exploration(folder: &Path) -> anyhow::Result<(String, bool)> {
    std::fs::create_dir_all(folder)?;
    let present = BUILDINGS.iter().filter_map(|(name, file)| Some((*name, recording(file)?)));
    let jobs: Vec<_> = present.flat_map(|at| [(at.clone(), Rules::Ours), (at, Rules::Published)]).collect();
    let lines: anyhow::Result<Vec<Line>> =
        jobs.par_iter().map(|((name, path), rules)| Line::of(&Building::load(name, path)?, *rules)).collect();
    let lines = lines?;
    let mut text = String::from(
        "building                  rules      floor m²  known %   way m  best tour m  ratio  view points  ended\n",
    );
    let mut holds = !lines.is_empty();
    for line in &lines {
        let is_ours = line.rules == Rules::Ours;
        holds &= !is_ours || line.holds();
        let explored = &line.explored;
        writeln!(
            text,
            "{:25} {:9} {:9.0} {:8.2} {:7.1} {:12.1} {:6.2} {:12} {:>6}{}",
            line.name,
            if is_ours { "ours" } else { "published" },
            line.area_m2,
            100.0 * explored.covered_share,
            explored.way_m,
            line.tour_m,
            line.excess(),
            explored.view_points.len(),
            if explored.has_ended { "yes" } else { "no" },
            if is_ours && !line.holds() { "  MISSED" } else { "" },
        )?;
    }
    for rules in [Rules::Ours, Rules::Published] {
        let of = || lines.iter().filter(|line| line.rules == rules);
        let (way_m, tour_m): (f64, f64) =
            (of().map(|line| line.explored.way_m).sum(), of().map(|line| line.tour_m).sum());
        writeln!(
            text,
            "all, {rules:?}: {way_m:.0} m driven, {:.2} times the tours",
            way_m / tour_m.max(0.1)
        )?;
    }
    print!("{text}");
    std::fs::write(folder.join("exploration.txt"), &text)?;
    Ok((text, holds))
}
