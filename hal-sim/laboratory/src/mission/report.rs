//! The mission report as text.

use std::fmt::Write as _;

use super::campaign::StrategySummary;
use floorguard_robot::site::Floor;

/// A table with a line for each strategy.
pub fn table(summaries: &[StrategySummary]) -> String {
    let mut text = format!(
        "{:<14} {:>8} {:>6} {:>8} {:>7} {:>7} {:>7} {:>13}\n",
        "strategy", "success", "q99", "path m", "time s", "replans", "claimed", "falsely"
    );
    for s in summaries {
        let _infallible = writeln!(
            text,
            "{:<14} {:>6.1} % {:>6.2} {:>8.2} {:>7.1} {:>7.1} {:>7} {:>4} = {:>4.2} %",
            s.strategy,
            100.0 * s.success_rate,
            s.quantile99,
            s.distance_m,
            s.time_s,
            s.replannings,
            s.claimed_cells,
            s.falsely_claimed_cells,
            100.0 * s.falsely_claimed_share,
        );
    }
    text
}

/// What the claims are worth, with intervals, for each strategy.
pub fn proof(summaries: &[StrategySummary], delta: f64) -> String {
    let mut text = String::new();
    for s in summaries {
        let percent = |(low, high): (f64, f64)| format!("{:.3}–{:.3} %", 100.0 * low, 100.0 * high);
        let _infallible = writeln!(
            text,
            "{}: falsely claimed {} of {} cells = {:.3} % (95 %: {}; allowed {:.3} %); of the truly clean cells {:.2} % \
             claimed (95 %: {}); complete {:.1} % of the missions; not claimed, cells a mission: {:.2} uncertain, {:.2} given up, {:.2} unreachable",
            s.strategy,
            s.falsely_claimed_cells,
            s.claimed_cells,
            100.0 * s.falsely_claimed_share,
            percent(s.falsely_claimed_interval95),
            100.0 * delta,
            100.0 * s.claimed_fraction,
            percent(s.claimed_interval95),
            100.0 * s.completion,
            s.uncertain_cells,
            s.given_up_cells,
            s.unreachable_cells,
        );
        if s.waited_for_people_s > 0.0 || s.avoidable_contacts > 0 {
            let _infallible = writeln!(
                text,
                "{}: people cost {:.0} s of {:.0} s; {} avoidable contacts",
                s.strategy, s.waited_for_people_s, s.time_s, s.avoidable_contacts
            );
        }
    }
    text
}

/// What the mission answers for, and what not.
pub fn scope(floor: &Floor) -> String {
    let reachable = floor.reachable.iter().filter(|&&r| r).count();
    let mut text = format!(
        "{}: {:.1} m² in {reachable} cells can be reached; {} cells of free floor cannot: nothing is claimed for them",
        floor.name,
        floor.reachable_m2(),
        floor.free_cells.saturating_sub(reachable + floor.unseen_cells),
    );
    if floor.unseen_cells > 0 {
        let _infallible = write!(
            text,
            "\n{} cells see no wall: nobody knows where a robot is there, and nothing is claimed for them",
            floor.unseen_cells
        );
    }
    if floor.beyond_capacity_m2 > 0.0 {
        let _infallible = write!(
            text,
            "\n{:.1} m² lie beyond the {} cells of one mission: nothing is claimed for them",
            floor.beyond_capacity_m2,
            floorguard_robot::site::CELLS_MAX
        );
    }
    text
}
