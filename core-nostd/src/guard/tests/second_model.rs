//! A second model of the decision machine, written from the rules in `docs/requirements.md` and not from the code, run
//! against it. `FLOORGUARD_DIFFERENTIAL_STEPS` sets the number of random steps.

use std::vec::Vec;

use crate::guard::*;
use crate::time::Stamp;

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
                | BumperFront
                | BumperRear
                | CliffFront
                | CliffRear
                | Overspeed
                | SpeedDisagreement
                | TurnDisagreement
                | DriveFault
                | ClockFault
        )
    }

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
            if *cause == Cause::StateCorrupted {
                true
            } else if Self::needs_operator(*cause) {
                !released
            } else {
                let wait = if cause.action().stops() { 1_000_000 } else { 500_000 };
                now - at < wait
            }
        });
        let action = self.evidence.iter().map(|(cause, _)| cause.action()).max().unwrap_or(Action::None);
        let latched = |cause: &Cause| Self::needs_operator(*cause) || *cause == Cause::StateCorrupted;
        (action, self.evidence.iter().any(|(cause, _)| latched(cause)))
    }
}

/// SplitMix64: the test needs no more than that.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn fg_req_005_two_models_agree_on_every_random_step() {
    let steps: u64 = std::env::var("FLOORGUARD_DIFFERENTIAL_STEPS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(1_000_000);
    let causes = Cause::all();
    let mut seed = 7_u64;
    let mut now = 10_000_000_u64;
    let mut machine = DecisionMachine::new(Stamp::from_micros(now));
    let mut model = Model { evidence: [(Cause::StartUp, now)].into(), pressed: None };
    let mut reached = [0_u64; 5];
    for step in 0..steps {
        if step % 2_000 == 0 {
            machine = DecisionMachine::new(Stamp::from_micros(now));
            model = Model { evidence: [(Cause::StartUp, now)].into(), pressed: None };
        }
        now += 1 + random(&mut seed) % 150_000;
        if random(&mut seed).is_multiple_of(12) {
            let cause = causes[(random(&mut seed) % causes.len() as u64) as usize];
            // A corrupted state never clears: seldom, or nothing else would be seen.
            if cause != Cause::StateCorrupted || random(&mut seed).is_multiple_of(50) {
                machine.raise(CauseRecord::new(cause, Stamp::from_micros(now)));
                model.raise(cause, now);
            }
        }
        if random(&mut seed).is_multiple_of(9) {
            machine.request_reset(Stamp::from_micros(now));
            model.pressed = Some(now);
        }
        let fit = !random(&mut seed).is_multiple_of(30);
        let verdict = machine.settle(fit, Stamp::from_micros(now));
        let (action, latched) = model.step(fit, now);
        assert_eq!((verdict.action, verdict.state == GuardState::Latched), (action, latched), "step {step}");
        reached[action as usize] += 1;
    }
    assert!(reached.iter().all(|count| *count > steps / 1_000), "{reached:?}");
}
