//! A second model of the guard's decision machine, written from the rules in `docs/requirements.md` and not from the
//! code, run against it step by step. `cargo xtask campaign model` runs as many steps as one likes.

use floorguard_guard::{Action, Cause, CauseRecord, DecisionMachine, GuardState, Source};
use floorguard_tests::campaign::{Random, Slice, report};
use floorguard_types::time::Stamp;

/// Steps of one trial: both models start anew, so that what never clears does not hide the rest.
const STEPS: u64 = 2_000;

/// Remembers, per cause, when evidence was last seen; everything else is computed from that history.
struct Model {
    evidence: Vec<(Cause, u64)>,
    pressed: Option<u64>,
}

impl Model {
    fn raise(&mut self, cause: Cause, at: u64) {
        self.evidence.retain(|(known, _)| *known != cause);
        self.evidence.push((cause, at));
    }

    fn needs_operator(cause: Cause) -> bool {
        use Cause::*;
        matches!(
            cause,
            EmergencyStop
                | InputFault
                // Who pressed while nothing could be read was not heard.
                | InputUnknown
                | BumperFront
                | BumperRear
                | CliffFront
                | CliffRear
                | Overspeed
                | StandstillLost
                | SpeedDisagreement
                | TurnDisagreement
                | DriveFault
                | ClockFault
                // Their power was gone: what comes back must not start the robot (ISO 3691-4 4.1.14).
                | SourceLost(Source::Drive | Source::Discrete)
        )
    }

    fn waits_for_reset(cause: Cause) -> bool {
        Self::needs_operator(cause) || cause == Cause::StateCorrupted
    }

    /// The start command ends the waiting for it, if nothing else waits for a person or for the first healthy sensors.
    fn start(&mut self) {
        let others = |cause: Cause| Self::waits_for_reset(cause) || cause == Cause::StartUp;
        if !self.evidence.iter().any(|(cause, _)| others(*cause)) {
            self.evidence.retain(|(cause, _)| *cause != Cause::StartNeeded);
        }
    }

    /// Action, and whether it is latched.
    fn step(&mut self, fit: bool, now: u64) -> (Action, bool) {
        let disturbed =
            self.evidence.iter().any(|(cause, at)| Self::needs_operator(*cause) && now - at < 200_000);
        let mut released = false;
        if let Some(pressed) = self.pressed {
            if !fit || disturbed {
                self.pressed = None;
            } else if now - pressed >= 300_000 {
                self.pressed = None;
                released = true;
            }
        }
        self.evidence.retain(|(cause, at)| {
            if matches!(cause, Cause::StateCorrupted | Cause::StartNeeded) {
                true
            } else if Self::needs_operator(*cause) {
                !released
            } else {
                let wait = if cause.action().stops() { 1_000_000 } else { 500_000 };
                now - at < wait
            }
        });
        if released {
            self.raise(Cause::StartNeeded, now);
        }
        let action = self.evidence.iter().map(|(cause, _)| cause.action()).max().unwrap_or(Action::None);
        (action, self.evidence.iter().any(|(cause, _)| Self::waits_for_reset(*cause)))
    }
}

/// How often each action was decided, by its order.
fn trial(mut random: Random, reached: &mut [u64; 5]) {
    let causes = Cause::all();
    let mut now = 10_000_000_u64;
    let mut machine = DecisionMachine::new(Stamp::from_micros(now));
    let mut model =
        Model { evidence: [(Cause::StartUp, now), (Cause::StartNeeded, now)].into(), pressed: None };
    for step in 0..STEPS {
        now += 1 + random.below(150_000);
        if random.seldom(12) {
            let cause = causes[random.below(causes.len() as u64) as usize];
            // A corrupted state never clears: seldom, or nothing else would be seen.
            if cause != Cause::StateCorrupted || random.seldom(50) {
                machine.raise(CauseRecord::new(cause, Stamp::from_micros(now)));
                model.raise(cause, now);
            }
        }
        if random.seldom(9) {
            machine.request_reset(Stamp::from_micros(now));
            model.pressed = Some(now);
        }
        if random.seldom(4) {
            machine.request_start();
            model.start();
        }
        let fit = !random.seldom(30);
        let verdict = machine.settle(fit, Stamp::from_micros(now));
        let (action, latched) = model.step(fit, now);
        let decided = (verdict.action, verdict.state == GuardState::Latched);
        assert_eq!(decided, (action, latched), "step {step} of the trial");
        reached[action as usize] += 1;
    }
}

#[test]
fn fg_req_005_two_models_agree_on_every_random_step() {
    let slice = Slice::from_environment(500);
    let mut reached = [0_u64; 5];
    for number in slice.trials.clone() {
        trial(slice.random(number), &mut reached);
    }
    let steps: u64 = reached.iter().sum();
    assert!(reached.iter().all(|count| *count > steps / 1_000), "an action was hardly seen: {reached:?}");
    let [none, limit, hold, ramp, off] = reached;
    report(&[("steps", steps), ("none", none), ("limit", limit), ("category 2", hold)]);
    report(&[("category 1", ramp), ("category 0", off)]);
}
