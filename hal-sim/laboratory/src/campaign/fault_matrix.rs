//! {fault class} × {source} × {mission phase}: every possible cell in turn, judged by the simulator's truth.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use floorguard_sim::FaultSpec;
use floorguard_types::random::Pcg32;

use super::fault_class::{self, CLASSES, SOURCES, is_possible};
use super::fault_phase::{self, PHASES, PhaseRun};
use super::summary::RunOutcome;
use super::{watched, watched_by};
use crate::world::{Observation, Plan};
use floorguard_operator::telemetry::{RunSinks, Tape};
use floorguard_robot::assembly::Stages;

/// A cell of the matrix: indices of class, source and phase.
pub type Cell = (usize, usize, usize);

/// Every cell that can be.
#[must_use]
pub fn cells() -> Vec<Cell> {
    let pairs = (0..CLASSES.len()).flat_map(|class| (0..SOURCES.len()).map(move |source| (class, source)));
    pairs
        .filter(|(class, source)| is_possible(*class, *source))
        .flat_map(|(class, source)| (0..PHASES.len()).map(move |phase| (class, source, phase)))
        .collect()
}

/// The cell of a trial: a walk over all of them, in an order in which neighbours differ.
#[must_use]
pub fn cell_of(trial: u64) -> Cell {
    let cells = cells();
    // 127 pairs × 7 phases: a stride without a common factor visits every cell once in a round.
    let stride = (cells.len() as u64 * 618 / 1_000..)
        .find(|stride| gcd(*stride, cells.len() as u64) == 1)
        .unwrap_or(1);
    cells[(trial.wrapping_mul(stride) % cells.len() as u64) as usize]
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// `class | source | phase`.
#[must_use]
pub fn name((class, source, phase): Cell) -> String {
    format!("{} | {} | {}", CLASSES[class], SOURCES[source], PHASES[phase])
}

/// A trial that is ready to be played.
struct Trial {
    cell: Cell,
    run: PhaseRun,
    /// What repeats it.
    command: String,
}

/// Draws what a trial is.
fn draw(seed: u64, trial: u64) -> Result<Trial, Box<RunOutcome>> {
    let cell = cell_of(trial);
    let (class, source, phase) = cell;
    let mut random = Pcg32::new(seed ^ trial.wrapping_mul(0x9e37_79b9_7f4a_7c15), 61);
    let world_seed = u64::from(random.next_u32());
    let broken = |error: String| {
        Box::new(RunOutcome {
            command: format!("trial {trial} of seed {seed} ({})", name(cell)),
            failure: Some(error),
            ..RunOutcome::default()
        })
    };
    let mut run =
        fault_phase::draw(phase, world_seed, &mut random).map_err(|error| broken(error.to_string()))?;
    let text = fault_class::draw(class, source, &mut random);
    let tenths = |tenths: u64| format!("{}.{}s", tenths / 10, tenths % 10);
    let text = format!("{text},from={},to={}", tenths(run.from_ds), tenths(run.to_ds));
    let command = format!(
        "floorguard campaign faults --seed {seed} --first {trial} --trials 1   # {}, {} --seed {world_seed} --fault {text}",
        PHASES[phase], run.plan.name
    );
    run.plan.faults.push(FaultSpec::parse(&text).map_err(|error| broken(error.to_string()))?);
    Ok(Trial { cell, run, command })
}

impl Trial {
    fn outcome(self, seen: anyhow::Result<Observation>) -> RunOutcome {
        let undisturbed = || watched(&undisturbed(&self.run.plan));
        match seen {
            Ok(seen) => RunOutcome {
                command: self.command,
                failure: self.run.judge(&seen, undisturbed),
                verdict: Some(seen.verdict),
                ..RunOutcome::default()
            },
            Err(error) => RunOutcome {
                command: self.command,
                failure: Some(error.to_string()),
                ..RunOutcome::default()
            },
        }
    }
}

/// The same run without its fault.
fn undisturbed(plan: &Plan) -> Plan {
    let mut plan = plan.clone();
    plan.faults.clear();
    plan
}

/// Plays one trial.
#[must_use]
pub fn fault_trial(seed: u64, trial: u64) -> (Cell, RunOutcome) {
    match draw(seed, trial) {
        Ok(trial) => {
            let seen = watched(&trial.run.plan);
            (trial.cell, trial.outcome(seen))
        }
        Err(broken) => (cell_of(trial), *broken),
    }
}

/// Plays one trial with the stages of the microcontroller, and gives the tape of all input of the robot.
///
/// `None` where the fault is in the computer itself, or somebody drives by hand: a tape holds only what comes from devices, and a route.
#[must_use]
pub fn taped_fault_trial(seed: u64, trial: u64) -> Option<(Cell, RunOutcome, Vec<u8>)> {
    let cell = cell_of(trial);
    if fault_class::is_computer(cell.1) {
        return None;
    }
    let mut trial = match draw(seed, trial) {
        Ok(trial) => trial,
        Err(broken) => return Some((cell, *broken, Vec::new())),
    };
    if !trial.run.plan.scenario.manoeuvre.is_empty() {
        return None;
    }
    trial.run.plan.stages = Stages::AsOnBoard;
    // Most of the time goes into the emulator: the board receives every firing.
    trial.run.plan.lidar_grain = 1;
    let mut sinks = RunSinks::default();
    sinks.tape = Tape::new(&trial.run.plan.robot, trial.run.plan.duration_us);
    let seen = watched_by(&trial.run.plan, &mut sinks);
    Some((cell, trial.outcome(seen), sinks.tape.finish()))
}

/// How often each cell was run, as a table: a row for each class, a column for each source, `-` where the class cannot
/// be. Gives the table and the share of possible cells that have a run.
#[must_use]
pub fn coverage(counts: &BTreeMap<Cell, u64>) -> (String, f64) {
    let mut table = format!("{:18}", "");
    for source in SOURCES {
        let _ = write!(table, " {source:>16}");
    }
    for (class, class_name) in CLASSES.iter().enumerate() {
        let _ = write!(table, "\n{class_name:18}");
        for source in 0..SOURCES.len() {
            let runs = (0..PHASES.len()).map(|phase| counts.get(&(class, source, phase)).copied());
            let text = if is_possible(class, source) {
                runs.map(|runs| runs.unwrap_or(0).to_string()).collect::<Vec<_>>().join("/")
            } else {
                "-".to_owned()
            };
            let _ = write!(table, " {text:>16}");
        }
    }
    let cells = cells();
    let filled = cells.iter().filter(|cell| counts.get(*cell).is_some_and(|runs| *runs > 0)).count();
    (table, filled as f64 / cells.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::geometry::Pose2;
    use std::collections::BTreeSet;

    #[test]
    fn a_round_of_trials_visits_every_cell_once() {
        let cells = cells();
        let visited: BTreeSet<Cell> = (0..cells.len() as u64).map(cell_of).collect();
        assert_eq!(visited.len(), cells.len());
        let counts = visited.into_iter().map(|cell| (cell, 1)).collect();
        let (table, share) = coverage(&counts);
        assert!(share == 1.0 && table.contains("1/1/1/1/1/1/1") && table.lines().count() == 21, "{table}");
    }

    /// A robot that rolls under the fault is held against a run without any: its own would excuse it.
    #[test]
    fn required_standstill_is_compared_without_the_fault() {
        let trial = (0..).map(|trial| draw(2, trial).expect("a trial"));
        let trial = trial.into_iter().find(|trial| PHASES[trial.cell.2] == "hold").expect("a trial");
        assert_eq!((trial.run.plan.faults.len(), undisturbed(&trial.run.plan).faults.len()), (1, 0));
        let mut rolls = Observation::default();
        rolls.verdict.passed = true;
        rolls.robot_path = (0..44_u8).map(|step| Pose2::new(f32::from(step), 0.0, 0.0)).collect();
        let judge = move || trial.outcome(Ok(rolls)).failure;
        let judge = std::thread::Builder::new().stack_size(32 << 20).spawn(judge).expect("a thread");
        assert!(judge.join().expect("no panic").is_some_and(|failure| failure.contains("rolled 15.00 m")));
    }
}
