//! All reachable states of the whole supervisor, by breadth-first search that drives the real code.
//!
//! Abstraction: a step is 200 ms of the robot on the bench under one of a few events; times are counted in steps up to
//! the longest that a rule uses, speeds in steps of 0.05 m/s. States that agree in this are the same.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::string::String;
use std::vec::Vec;
use std::{format, vec};

use super::fixtures::{Rig, forward};
use crate::state::State;
use crate::*;
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::SafetyInput;
use floorguard_types::time::{Age, Stamp};

const STEP_MS: u64 = 200;

/// The names of what can happen, once for the type and for the list of all.
macro_rules! events {
    ($($(#[$meaning:meta])* $name:ident,)*) => {
        /// What happens during a step.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum StepEvent {
            $($(#[$meaning])* $name,)*
        }
        use StepEvent::*;

        const ALL: &[StepEvent] = &[$($name),*];
    };
}

events! {
    Nothing,
    Obstacle,
    Warning,
    EmergencyStop,
    Contact,
    Person,
    ImuSilent,
    Start,
    Reset,
    ResetBesideObstacle,
    ResetWhilePressed,
    /// Backwards, away from an obstacle ahead.
    Leave,
    LeaveWhilePressed,
}

impl StepEvent {
    const fn is_pressed(self) -> bool {
        matches!(self, EmergencyStop | ResetWhilePressed | LeaveWhilePressed)
    }

    const fn is_obstacle(self) -> bool {
        matches!(self, Obstacle | ResetBesideObstacle | Leave)
    }
}

/// On the robot's path, and approaching.
fn person_ahead() -> AdvisedPerson {
    AdvisedPerson {
        position: Point2::new(1.8, 0.0),
        velocity_mps: Point2::new(-1.0, 0.0),
        ..AdvisedPerson::default()
    }
}

/// The state, and how fast the bench really goes.
type Node = (State, Twist2);

/// Steps since a moment, as far as a rule may look back.
fn steps_since(stamp: Stamp, now: Stamp, most: u64) -> u64 {
    match stamp.age(now) {
        Age::Past(us) => (us / (STEP_MS * 1_000)).min(most),
        Age::Future(_) => 99,
    }
}

/// What makes a difference.
fn key((state, measured): &Node, config: &GuardConfig) -> String {
    let now = state.decided_at;
    let health: Vec<Health> =
        Source::ALL.map(|source| state.monitors[source.index()].health(&config.rules(source), now)).into();
    let speed = |mps: f32| (mps * 20.0).round() as i32;
    let blocked =
        [state.blocked_forward, state.blocked_backward].map(|at| at.map(|at| steps_since(at, now, 5)));
    let persists = [&state.checks.overspeed, &state.checks.speed, &state.checks.turn, &state.checks.steering]
        .map(|check| check.since.map(|since| steps_since(since, now, 3)));
    format!(
        "{:?} {health:?} {:?} {} {} {} {:?} {blocked:?} {persists:?} {} {}",
        state.machine.abstracted_in(now, STEP_MS * 1_000),
        (state.started, state.scans_with_hit.min(2), now < state.selection.held_until),
        speed(state.permitted.linear_mps),
        speed(measured.linear_mps),
        speed(state.checks.envelope_mps),
        state.selection.candidate,
        state.selection.active,
        state.wanted.linear_mps > 0.0,
    )
}

/// One step on the bench; the decision at its end.
fn play(rig: &mut Rig, (state, measured): Node, event: StepEvent) -> (Node, Decision) {
    (rig.guard.state, rig.guard.copy) = (state, state);
    (rig.now, rig.measured) = (state.decided_at, measured);
    rig.obstacles = match event {
        Warning => vec![Point2::new(1.8, 0.0)],
        obstacle if obstacle.is_obstacle() => vec![Point2::new(1.1, 0.0)],
        _ => vec![],
    };
    rig.inputs.emergency_stop = if event.is_pressed() { SafetyInput::Active } else { SafetyInput::Clear };
    rig.inputs.bumper_front = if event == Contact { SafetyInput::Active } else { SafetyInput::Clear };
    rig.people = if event == Person { vec![person_ahead()] } else { vec![] };
    rig.wanted = if matches!(event, Leave | LeaveWhilePressed) { forward(-0.2) } else { forward(0.6) };
    rig.silent = if event == ImuSilent { vec![Source::Imu] } else { vec![] };
    let decision = rig.run_ms(STEP_MS / 2);
    let stands = |decision: &Decision| decision.permitted == Twist2::ZERO;
    assert!(!event.is_pressed() || stands(&decision), "{event:?}: {decision:?}");
    if matches!(event, Reset | ResetBesideObstacle | ResetWhilePressed) {
        rig.guard.request_reset(rig.now);
    }
    if event == Start {
        rig.guard.request_start(rig.now);
    }
    let decision = rig.run_ms(STEP_MS / 2);
    ((rig.guard.state, rig.measured), decision)
}

/// What must hold of every transition.
fn judge(before: &State, (after, decision): (&State, &Decision), event: StepEvent) {
    let stands = decision.permitted == Twist2::ZERO;
    let latched = |state: &State| state.machine.held().any(|held| held.cause.is_latching());
    let awaits_start = |state: &State| state.machine.holds(Cause::StartNeeded);
    let leaves = decision.escaping && (-0.1 - 1.0e-6..=0.0).contains(&decision.permitted.linear_mps);
    if event == Leave {
        // The field behind is free: the obstacle ahead is no hazard to a robot that goes backwards.
        assert!(decision.permitted.linear_mps <= 0.0, "towards the obstacle: {decision:?}");
    } else if event.is_obstacle() || event == Person {
        // Standing is enough: while the direction changes, no field lets it go anyway.
        assert!(stands, "{event:?} and moving: {decision:?}");
    } else if event.is_pressed() || matches!(event, ImuSilent | Contact) {
        assert!(stands && decision.action.stops(), "{event:?} and moving: {decision:?}");
    }
    if latched(after) {
        // After contact at the front the robot may leave backwards.
        assert!(
            (stands || leaves) && decision.state == GuardState::Latched,
            "latched and moving: {decision:?}"
        );
    }
    if latched(before) && !latched(after) {
        assert!(after.machine.resets() > before.machine.resets(), "released without reset and self-test");
        assert!(awaits_start(after), "reset and start were one act");
        assert!(event != ImuSilent, "released while a source was lost");
    }
    if awaits_start(before) {
        assert!(awaits_start(after) || event == Start, "released without the start command");
    }
    assert!(!awaits_start(after) || stands, "moving before the start command: {decision:?}");
    if !after.started {
        assert!(stands, "moving before the start-up check: {decision:?}");
    }
    assert!(decision.permitted.linear_mps <= 0.6 + 1.0e-6);
}

/// What an event leads to.
struct Outcome {
    key: String,
    next: Node,
    shown: GuardState,
}

/// A bench where the operator does nothing that is not asked of it.
fn bench() -> Rig {
    let mut rig = Rig::new();
    (rig.wanted, rig.operator_starts) = (forward(0.6), false);
    rig
}

/// What each event leads to from each of these states, judged, in order.
fn outcomes(nodes: &[Node]) -> Vec<Outcome> {
    let mut rig = bench();
    let config = rig.guard.config.clone();
    let mut all = Vec::new();
    for &node in nodes {
        for event in ALL.iter().copied() {
            let (next, decision) = play(&mut rig, node, event);
            judge(&node.0, (&next.0, &decision), event);
            all.push(Outcome { key: key(&next, &config), next, shown: decision.state });
        }
    }
    all
}

/// The same on all cores: each block of states has a bench of its own.
fn outcomes_on_all_cores(nodes: &[Node]) -> Vec<Outcome> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let block = nodes.len().div_ceil(cores).max(1);
    std::thread::scope(|scope| {
        let workers: Vec<_> = nodes.chunks(block).map(|block| scope.spawn(move || outcomes(block))).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("an event was judged bad")).collect()
    })
}

/// States of a level that are played at once: bounds the memory for what comes after them.
const AT_ONCE: usize = 512;

#[test]
fn fg_req_005_every_reachable_state_stops_and_latches() {
    let rig = bench();
    let config = rig.guard.config.clone();
    let start: Node = (rig.guard.state, Twist2::ZERO);
    let (mut seen, mut queue) = (BTreeSet::from([key(&start, &config)]), VecDeque::from([start]));
    let mut transitions = BTreeMap::<String, u64>::new();
    let mut shown = BTreeMap::from([(key(&start, &config), GuardState::Init)]);
    while !queue.is_empty() {
        let nodes: Vec<Node> = queue.drain(..queue.len().min(AT_ONCE)).collect();
        let outcomes = outcomes_on_all_cores(&nodes);
        for (node, outcomes) in nodes.iter().zip(outcomes.chunks(ALL.len())) {
            let from = shown.get(&key(node, &config)).copied().unwrap_or_default();
            for outcome in outcomes {
                *transitions.entry(format!("{from:?} to {:?}", outcome.shown)).or_default() += 1;
                if seen.insert(outcome.key.clone()) {
                    shown.insert(outcome.key.clone(), outcome.shown);
                    queue.push_back(outcome.next);
                }
            }
        }
        assert!(seen.len() < 100_000, "the abstraction is not finite");
    }
    let count: u64 = transitions.values().sum();
    std::println!("campaign: states = {}\ncampaign: transitions = {count}", seen.len());
    for (transition, count) in &transitions {
        std::println!("campaign: {transition} = {count}");
    }
    assert!(seen.len() > 500 && transitions.len() >= 12, "{} states, {transitions:?}", seen.len());
}
