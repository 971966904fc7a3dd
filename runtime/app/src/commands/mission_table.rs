//! The live table of `mission`: how far each strategy is, and what its missions came to so far. It fits 80 columns.

use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};

use floorguard_laboratory::mission::{Strategy, TrialResult};

/// What the missions of a strategy have come to.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    missions: u64,
    successes: u64,
    time_s: f64,
    distance_m: f64,
    dirty_cells: u64,
    claimed_cells: u64,
    falsely_claimed_cells: u64,
}

/// Rows in the order of the strategies.
pub(super) struct MissionTable {
    asked: u64,
    rows: Mutex<Vec<(Strategy, Tally)>>,
}

impl MissionTable {
    pub(super) fn new(strategies: &[Strategy], asked: u64) -> Self {
        let rows = strategies.iter().map(|strategy| (*strategy, Tally::default())).collect();
        Self { asked, rows: Mutex::new(rows) }
    }

    /// A mission is done; gives the table with it.
    pub(super) fn add(&self, strategy: Strategy, result: &TrialResult) -> String {
        let mut rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, tally)) = rows.iter_mut().find(|(known, _)| *known == strategy) {
            tally.missions += 1;
            tally.successes += u64::from(result.success);
            tally.time_s += f64::from(result.time_s);
            tally.distance_m += f64::from(result.distance_m);
            tally.dirty_cells += u64::from(result.dirty_cells);
            tally.claimed_cells += u64::from(result.claimed_cells);
            tally.falsely_claimed_cells += u64::from(result.falsely_claimed_cells);
        }
        self.text(&rows)
    }

    fn text(&self, rows: &[(Strategy, Tally)]) -> String {
        let mut text = format!(
            "{:<16} {:>11} {:>9} {:>9} {:>9} {:>9} {:>8}",
            "strategy", "missions", "success", "time s", "path m", "claimed", "falsely"
        );
        for (strategy, tally) in rows {
            let mean = |sum: f64| if tally.missions > 0 { sum / tally.missions as f64 } else { 0.0 };
            let claimed = 100.0 * tally.claimed_cells as f64 / tally.dirty_cells.max(1) as f64;
            let _infallible = write!(
                text,
                "\n{:<16} {:>11} {:>7.1} % {:>9.1} {:>9.1} {:>7.1} % {:>8}",
                strategy.name(),
                format!("{}/{}", tally.missions, self.asked),
                100.0 * mean(tally.successes as f64),
                mean(tally.time_s),
                mean(tally.distance_m),
                claimed,
                tally.falsely_claimed_cells
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_counts_missions_and_fits_80_columns() {
        let strategies = [Strategy::Guarantee, Strategy::NoReplanning];
        let table = MissionTable::new(&strategies, 10_000);
        let good = TrialResult {
            success: true,
            time_s: 12_345.6,
            distance_m: 1_000.0,
            dirty_cells: 200,
            claimed_cells: 150,
            ..TrialResult::default()
        };
        table.add(Strategy::Guarantee, &good);
        let text = table.add(Strategy::Guarantee, &TrialResult { success: false, ..good });
        let row = text.lines().nth(1).expect("a row");
        for words in ["2/10000", "50.0 %", "12345.6", "1000.0", "75.0 %"] {
            assert!(row.contains(words), "{words}: {row}");
        }
        assert_eq!(text.lines().count(), 3);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    }
}
