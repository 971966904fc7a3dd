//! Dirt that arrives in a room by hidden rates, day after day, and a robot that learns what to expect where.

use std::fmt::Write as _;

use floorguard_cleaning::CleanRule;
use floorguard_laboratory::mission::{MissionConfig, Robot, Strategy, run_believing};
use floorguard_laboratory::mission::{expected_units, teach_cleaning};
use floorguard_mapping::DirtCell;
use floorguard_mapping::poisson_tail;
use floorguard_robot::environment::{Calendar, Model};
use floorguard_robot::site::{Floor, rooms};
use rayon::prelude::*;

/// Days, the first two with lanes over everything: the first sets the clock, the second shows the rates.
pub const DAYS: usize = 7;
const DAYS_OF_LANES: usize = 2;
/// The first evening.
const FIRST: &str = "2026-04-06T22:00";
const DAY_US: i64 = 86_400_000_000;
const TOLERATED: u8 = 5;
const DELTA: f64 = 0.01;

/// One evening, summed over runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Evening {
    /// Units that lie on the floor in truth, and that the model expects, in all.
    pub truth: f64,
    /// See `truth`.
    pub expected: f64,
    /// Sum of the absolute differences, cell by cell.
    pub error: f64,
    /// Cells that must be cleaned, and those claimed to be clean.
    pub dirty: u64,
    /// See `dirty`.
    pub claimed: u64,
    /// Of those, in truth dirtier than tolerated.
    pub falsely: u64,
    /// Metres.
    pub path_m: f64,
    /// Seconds.
    pub time_s: f64,
}

/// Units that arrive in a day in each cell: a busy corner, a path through the room, and little elsewhere.
fn arriving(floor: &Floor) -> Vec<f32> {
    (0..floor.cells.cell_count())
        .map(|cell| {
            let point = floor.cells.centre(cell);
            let is_free = floor.clearance.clearance_m(point) >= 0.5 * floor.cells.resolution_m();
            match (point.x_m, point.y_m) {
                _ if !is_free => 0.0,
                (..2.0, ..2.0) => 8.0,
                (..4.0, ..2.0) => 3.0,
                _ => 0.1,
            }
        })
        .collect()
}

fn run(seed: u64) -> anyhow::Result<[Evening; DAYS]> {
    let floor = Floor::new("plain", rooms::plain()?, Robot::PUBLISHED.radius_m)?;
    let arriving = arriving(&floor);
    let count = floor.cells.cell_count();
    let mut model =
        Model::over("room", Calendar::default(), (floor.cells.centre(0), floor.cells.centre(count - 1)))?;
    let first = model.calendar.parse(FIRST)?;
    let rule = CleanRule::per_cell(TOLERATED, DELTA);
    let mut lying = arriving.clone();
    let mut evenings = [Evening::default(); DAYS];
    for (day, evening) in evenings.iter_mut().enumerate() {
        let now = first.plus_micros(day as i64 * DAY_US);
        let believed = expected_units(&model, &floor, now, Some(DELTA));
        let plain = expected_units(&model, &floor, now, None);
        let strategy = if day < DAYS_OF_LANES { Strategy::Systematic } else { Strategy::Guarantee };
        let config =
            MissionConfig { tolerated_units: TOLERATED, delta: DELTA, ..MissionConfig::published(strategy) };
        let result = run_believing(&floor, &config, (&lying, &believed), seed + day as u64)?;
        teach_cleaning(
            &mut model,
            (&floor, &result),
            (config.assumed_pickup, config.robot.brush.width_m),
            now,
        );
        let needs = |units: f32| {
            let tail = poisson_tail(u32::from(TOLERATED), f64::from(units)) as f32;
            rule.needs_cleaning(&DirtCell::poisson(units, tail))
        };
        for cell in 0..count {
            evening.truth += f64::from(lying[cell]);
            evening.expected += f64::from(plain[cell]);
            evening.error += f64::from((lying[cell] - plain[cell]).abs());
            evening.dirty += u64::from(floor.reachable[cell] && needs(lying[cell]));
            // What is left lies there tomorrow, with what arrives until then.
            lying[cell] = result.left[cell] as f32 + arriving[cell];
        }
        evening.claimed += u64::from(result.claimed_cells);
        evening.falsely += u64::from(result.falsely_claimed_cells);
        evening.path_m += f64::from(result.distance_m);
        evening.time_s += f64::from(result.time_s);
    }
    Ok(evenings)
}

/// Several runs, summed evening by evening.
///
/// # Errors
/// None in practice: the room is built in.
pub fn dirt_days(runs: u64, seed: u64) -> anyhow::Result<[Evening; DAYS]> {
    let all: Vec<[Evening; DAYS]> = (0..runs)
        .into_par_iter()
        .map(|index| run(seed.wrapping_add(100 * index)))
        .collect::<anyhow::Result<_>>()?;
    let mut sum = [Evening::default(); DAYS];
    for evenings in all {
        for (sum, one) in sum.iter_mut().zip(evenings) {
            sum.truth += one.truth;
            sum.expected += one.expected;
            sum.error += one.error;
            sum.dirty += one.dirty;
            sum.claimed += one.claimed;
            sum.falsely += one.falsely;
            sum.path_m += one.path_m / runs as f64;
            sum.time_s += one.time_s / runs as f64;
        }
    }
    Ok(sum)
}

/// The table.
#[must_use]
pub fn table(evenings: &[Evening; DAYS], runs: u64) -> String {
    let mut text = format!(
        "Dirt that arrives by hidden rates, learned from what is picked up; {runs} runs; τ = {TOLERATED}, δ = {DELTA}\n\
         evening  strategy    expected of truth  error a cell  dirty cells  claimed  falsely        way m  time s\n"
    );
    for (day, one) in evenings.iter().enumerate() {
        let strategy = if day < DAYS_OF_LANES { "systematic" } else { "guarantee" };
        let _infallible = writeln!(
            text,
            "{:>7}  {strategy:<11} {:>15.0} % {:>11.0} % {:>12} {:>8} {:>5} = {:>4.2} % {:>8.1} {:>7.0}",
            day + 1,
            100.0 * one.expected / one.truth,
            100.0 * one.error / one.truth,
            one.dirty,
            one.claimed,
            one.falsely,
            100.0 * one.falsely as f64 / one.claimed.max(1) as f64,
            one.path_m,
            one.time_s
        );
    }
    text
}

/// What knowing the rates must save of the distance of lanes: a tenth.
const DISTANCE_MAX: f64 = 0.9;

/// Once the rates are known, no more than δ of the claimed cells are claimed falsely, with a tenth less distance than
/// lanes on every evening.
#[must_use]
pub fn holds(evenings: &[Evening; DAYS]) -> bool {
    let learned = || evenings.iter().skip(DAYS_OF_LANES);
    let claimed: u64 = learned().map(|one| one.claimed).sum();
    let falsely: u64 = learned().map(|one| one.falsely).sum();
    falsely as f64 <= DELTA * claimed as f64
        && learned().all(|one| one.path_m <= DISTANCE_MAX * evenings[0].path_m)
}
