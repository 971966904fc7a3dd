//! Robots with one protection taken away: named worlds, each of which the whole robot gets through, and drawn ones. The judge knows true
//! geometry alone.

use std::collections::BTreeMap;

use floorguard_contact_judge::JobOutcome;
use floorguard_sim::FaultSpec;

use super::contacts::contact_plan;
use super::removal::Removal;
use super::true_path::{fast_until_m, stray_m, too_fast_s};
use super::{STACK_BYTES, watched};
use crate::judge::Verdict;
use crate::plan::Plan;
use crate::world::{Observation, load_scenario};

/// By then what stands on the way is reached, microseconds.
const DURATION_US: u64 = 14_000_000;
/// Somebody presses the emergency stop on the way to the box, until the run is over, microseconds.
const EMERGENCY_STOP_US: (u64, u64) = (3_500_000, 60_000_000);

/// What shows that something is missing.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    /// The run does not pass.
    Fails,
    /// The guard does not take such a configuration.
    Refused,
    /// The headline counts a contact that the whole robot has not. The run may pass, where no sensor could see the object.
    Touches,
    /// The body leaves its route.
    Strays,
    /// The body is faster than its file permits at all.
    Speeds,
    /// The body is still fast where the whole robot has slowed down for what is ahead.
    Rushes,
}

/// A world, what goes on in it with every robot, and the protection without which it is lost.
struct Case {
    world: &'static str,
    fault: Option<&'static str>,
    emergency_stop: bool,
    removal: Removal,
    sign: Sign,
}

const fn case(world: &'static str, removal: Removal) -> Case {
    Case { world, fault: None, emergency_stop: false, removal, sign: Sign::Fails }
}

const CASES: [Case; 21] = [
    Case { sign: Sign::Refused, ..case("box-aside", Removal::Fields) },
    case("post-30", Removal::ScannerReturns),
    case("board-70", Removal::LidarReturns),
    case("box-160", Removal::Scanner),
    case("box-160", Removal::Lidar),
    case("box-160", Removal::Imu),
    case("box-160", Removal::Encoders),
    case("box-160", Removal::Inputs),
    case("low-box-4", Removal::Bumpers),
    case("edge", Removal::FloorSwitches),
    Case { emergency_stop: true, sign: Sign::Touches, ..case("low-box-4", Removal::EmergencyStop) },
    case("box-30", Removal::ScanRule),
    case("board-70", Removal::LidarRule),
    case("board-70", Removal::ProtectiveRules),
    case("board-30", Removal::MemoryRules),
    Case { sign: Sign::Touches, ..case("step-in", Removal::PersonRule) },
    Case { sign: Sign::Rushes, ..case("box-30", Removal::WarningRule) },
    Case { sign: Sign::Speeds, ..case("runaway", Removal::OverspeedRule) },
    Case { sign: Sign::Strays, ..case("dead-encoders", Removal::SpeedRule) },
    Case { sign: Sign::Strays, ..case("turning-gyroscope", Removal::TurnRules) },
    Case {
        // Nothing sees the box: the robot stands before it because its scanner is lost.
        fault: Some("scanner:drop=100%,from=3s"),
        sign: Sign::Touches,
        ..case("low-box-4", Removal::ScannerLostRule)
    },
];

/// It speeds if it is too fast for longer than this, seconds.
const SPEEDING_S: f32 = 1.0;
/// The body is off its route from this distance on, metres.
const STRAY_M: f32 = 0.3;
/// It rushes if it is fast so much farther than the whole robot, metres.
const RUSH_M: f32 = 0.3;

fn plan(case: &Case) -> Plan {
    let path = format!("{}/../scenarios/hazards/{}.toml", env!("CARGO_MANIFEST_DIR"), case.world);
    let scenario = load_scenario(path.as_ref()).unwrap_or_else(|error| panic!("{path}: {error:#}"));
    let mut plan = Plan::of(case.world, scenario, 1, DURATION_US).expect("a plan");
    plan.lidar_grain = 2;
    plan.faults.extend(case.fault.map(|fault| FaultSpec::parse(fault).expect("a fault")));
    plan.emergency_stop_us.extend(case.emergency_stop.then_some(EMERGENCY_STOP_US));
    plan
}

fn observation(plan: &Plan, removal: Option<Removal>) -> Observation {
    let mut plan = plan.clone();
    if let Some(removal) = removal {
        removal.apply(&mut plan).expect("a line of that name");
    }
    watched(&plan).unwrap_or_else(|error| panic!("{}: {error:#}", plan.name))
}

fn verdict(plan: &Plan, removal: Option<Removal>) -> Verdict {
    observation(plan, removal).verdict
}

/// Why the guard does not take the robot without a protection; none if it does.
fn refusal(plan: &Plan, removal: Removal) -> Option<String> {
    let mut plan = plan.clone();
    removal.apply(&mut plan).expect("a line of that name");
    watched(&plan).err().map(|error| format!("{error:#}"))
}

fn with_room<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().stack_size(STACK_BYTES).build();
    pool.expect("threads").install(work)
}

/// What is wrong with a case.
fn complaint(case: &Case) -> Option<String> {
    let plan = plan(case);
    if case.sign == Sign::Refused {
        let refusal = refusal(&plan, case.removal).unwrap_or_default();
        let names_the_gap = refusal.contains("leaves out what the body sweeps");
        return (!names_the_gap).then(|| format!("{} without {:?}: {refusal}", case.world, case.removal));
    }
    let (whole_seen, without_seen) =
        rayon::join(|| observation(&plan, None), || observation(&plan, Some(case.removal)));
    let strays_m = [stray_m(&plan, &whole_seen), stray_m(&plan, &without_seen)];
    let fast_m = [fast_until_m(&plan, &whole_seen), fast_until_m(&plan, &without_seen)];
    let too_fast_s = [too_fast_s(&plan, &whole_seen), too_fast_s(&plan, &without_seen)];
    println!(
        "{} without {:?}: off the route by {strays_m:?} m, fast until {fast_m:?} m, too fast for {too_fast_s:?} s",
        case.world, case.removal
    );
    let (whole, without) = (whole_seen.verdict, without_seen.verdict);
    let touches = |verdict: &Verdict| verdict.bodies.counts.while_moving() > 0;
    let words = |what: &str, verdict: &Verdict| {
        let (failures, contacts) = (&verdict.failures, verdict.contacts_in_words());
        Some(format!("{} without {:?}: {what}: {failures:?}, {contacts}", case.world, case.removal))
    };
    match case.sign {
        _ if !whole.passed => words("the whole robot fails", &whole),
        Sign::Touches if touches(&whole) => words("the whole robot touches something", &whole),
        Sign::Fails if without.passed => words("it passes", &without),
        Sign::Touches if !touches(&without) => words("it touches nothing", &without),
        Sign::Strays if strays_m[0] > STRAY_M => words("the whole robot leaves its route", &whole),
        Sign::Strays if strays_m[1] <= STRAY_M => words("it stays on its route", &without),
        Sign::Speeds if too_fast_s[0] > SPEEDING_S => words("the whole robot is too fast", &whole),
        Sign::Speeds if too_fast_s[1] <= SPEEDING_S => words("it is not too fast", &without),
        Sign::Rushes if fast_m[1] < fast_m[0] + RUSH_M => words("it slows down as early", &without),
        _ => None,
    }
}

#[test]
fn each_removed_protection_is_noticed() {
    let complaints: Vec<String> = with_room(|| {
        use rayon::prelude::*;
        CASES.par_iter().filter_map(complaint).collect()
    });
    assert!(complaints.is_empty(), "{complaints:#?}");
}

#[test]
fn every_removal_has_a_world() {
    for removal in Removal::ALL {
        let cases = CASES.iter().filter(|case| case.removal == removal).count();
        assert_eq!(cases, 1, "{removal:?}");
    }
}

/// Boards that sink under the lidar's rays as the robot comes near, and a box behind a robot that drives backwards: each holds
/// the robot, and each is touched without the memory, if a sensor is all that could have seen it.
#[test]
fn memory_holds_what_sinks_out_of_sight() {
    let worlds = [("board-30", true), ("board-45", true), ("board-55", false), ("reverse-45", true)];
    for (world, needs_memory) in worlds {
        let plan = plan(&case(world, Removal::MemoryRules));
        let (whole, without) =
            rayon::join(|| verdict(&plan, None), || verdict(&plan, Some(Removal::MemoryRules)));
        assert!(whole.passed, "{world}: {:?}", whole.failures);
        assert_eq!(whole.bodies.counts.while_moving(), 0, "{world}: {}", whole.contacts_in_words());
        assert_eq!(without.bodies.counts.while_moving() > 0, needs_memory, "{world} without the memory");
    }
}

/// A thin bar across the way is seen by many rays, one that points at the robot by one of a hundred: this one is met often enough.
#[test]
fn memory_holds_bars_across_and_ahead() {
    for (world, touched) in [("bar-across-29", 0), ("bar-across-45", 0), ("bar-ahead-29", 0)] {
        let whole = verdict(&plan(&case(world, Removal::MemoryRules)), None);
        assert_eq!(whole.bodies.counts.while_moving(), touched, "{world}: {}", whole.contacts_in_words());
    }
}

/// Soap on the floor: what brakes with 0.75 and with 0.5 m/s², less than the 0.8 m/s² that the fields are computed with, still stands before
/// the box.
#[test]
fn robot_on_soap_stands_before_a_box() {
    for grip in [0.3, 0.2] {
        let mut plan = plan(&case("box-160", Removal::ScanRule));
        plan.scenario.grip = Some(grip);
        let whole = verdict(&plan, None);
        let (contacts, stops) = (whole.bodies.counts.while_moving(), whole.stops);
        assert!(whole.passed && contacts == 0 && stops > 0, "{grip}: {stops}, {:?}", whole.failures);
    }
}

/// The trials that the campaign asks for, with its seed. Otherwise: every silent sensor in the first world.
fn slice() -> (u64, std::ops::Range<u64>) {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let from = number("FLOORGUARD_CAMPAIGN_FROM").unwrap_or(3);
    let to = number("FLOORGUARD_CAMPAIGN_TO").unwrap_or(8);
    (number("FLOORGUARD_CAMPAIGN_SEED").unwrap_or(1), from..to)
}

/// Plays a drawn world with the whole robot and without one protection: what is counted.
fn drawn_trial(seed: u64, trial: u64) -> Vec<String> {
    let kinds = Removal::ALL.len() as u64;
    let removal = Removal::ALL[(trial % kinds) as usize];
    let plan = contact_plan(seed, trial / kinds).expect("a world");
    if removal == Removal::Fields {
        assert!(refusal(&plan, removal).is_some(), "seed {seed} trial {trial}: the guard takes needles");
        return vec![format!("without {removal:?} refused")];
    }
    let (whole, without) = (verdict(&plan, None), verdict(&plan, Some(removal)));
    let is_blocked = matches!(without.bodies.job, JobOutcome::Blocked(_));
    assert!(
        !removal.is_silence() || !without.passed || is_blocked,
        "seed {seed} trial {trial}: nobody notices that {removal:?} is silent"
    );
    let contacts = |verdict: &Verdict| verdict.bodies.counts.while_moving();
    let noticed = whole.passed && (!without.passed || contacts(&without) > contacts(&whole));
    let names = [("runs", true), ("that the whole robot passes", whole.passed), ("noticed", noticed)];
    let counted = names.into_iter().filter(|(_, holds)| *holds);
    counted.map(|(name, _)| format!("without {removal:?} {name}")).collect()
}

#[test]
fn silent_sensors_never_pass_in_drawn_worlds() {
    let (seed, trials) = slice();
    let counted: Vec<Vec<String>> = with_room(|| {
        use rayon::prelude::*;
        trials.into_par_iter().map(|trial| drawn_trial(seed, trial)).collect()
    });
    let mut counts = BTreeMap::<String, u64>::new();
    counted.into_iter().flatten().for_each(|name| *counts.entry(name).or_default() += 1);
    for (name, count) in &counts {
        println!("campaign: {name} = {count}");
    }
    assert!(!counts.is_empty());
}
