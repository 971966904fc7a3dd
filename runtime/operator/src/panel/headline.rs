//! What the robot does or waits for, in a few words.

use floorguard_guard::{Cause, GuardState};
use floorguard_runtime::shared::RobotStatus;
use serde::Serialize;

use crate::surroundings::Holder;

/// Slower counts as standing, m/s.
const STANDING_MPS: f32 = 0.02;

/// What the robot does or waits for: a sentence with a gap, so that a page can say it in another language.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Headline {
    /// The sentence; `{}` stands for the cause, or for the person or obstacle that holds it.
    pub key: &'static str,
    /// The name of the cause; empty where the holder stands in the gap, or where there is no gap.
    pub cause: String,
}

impl Headline {
    fn plain(key: &'static str) -> Self {
        Self { key, cause: String::new() }
    }

    /// In English: `Waiting for a person (behind, 1.4 m)`.
    pub fn words(&self, holder: Option<&Holder>) -> String {
        let gap = if self.cause.is_empty() {
            holder.map(Holder::words).unwrap_or_default()
        } else {
            self.cause.clone()
        };
        self.key.replace("{}", &gap)
    }
}

/// For the person beside the robot.
pub fn headline(status: &RobotStatus, holder: Option<&Holder>, paused: bool) -> Headline {
    let decision = &status.decision;
    let cause = decision.holding_cause.map(|record| record.cause);
    let named = |key| Headline { key, cause: cause.map_or_else(String::new, |cause| cause.to_string()) };
    let stands = status.pose.twist.linear_mps.abs() < STANDING_MPS;
    match (decision.action.stops(), cause, holder) {
        (true, Some(Cause::StartNeeded), _) => Headline::plain("Waiting for the start command"),
        (true, _, Some(_)) => Headline::plain("Waiting for {}"),
        (true, _, None) if decision.state == GuardState::Latched => named("Stopped: {}"),
        (true, ..) => named("Waiting: {}"),
        (false, ..) if paused => Headline::plain("Paused by the operator"),
        (false, Some(_), Some(_)) => Headline::plain("Slow because of {}"),
        (false, Some(_), None) => named("Slow: {}"),
        (false, None, _) if stands => Headline::plain("Standing"),
        (false, None, _) => Headline::plain("Driving"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_guard::{Action, CauseRecord, Decision, ResetReport, Supervisor};
    use floorguard_types::geometry::Twist2;
    use floorguard_types::time::Stamp;

    fn status(holding: Option<Cause>, state: GuardState) -> RobotStatus {
        let record = holding.map(|cause| CauseRecord::new(cause, Stamp::ZERO));
        let decision = Decision {
            stamp: Stamp::ZERO,
            permitted: Twist2::ZERO,
            action: holding.map_or(Action::None, Cause::action),
            speed_limit_mps: 0.0,
            state,
            primary_cause: record,
            holding_cause: record,
            torque_off: false,
            escaping: false,
            field_set: 0,
        };
        let sources = Supervisor::UNCONFIGURED.health();
        RobotStatus { decision, sources, pose: Default::default(), resets: ResetReport::NONE }
    }

    #[test]
    fn headline_names_who_holds_the_robot() {
        let holder = Holder {
            what: "a person",
            id: Some(3),
            x_m: -2.0,
            y_m: 0.0,
            distance_m: 1.4,
            direction: "behind",
        };
        let stopped = status(Some(Cause::CollisionStop), GuardState::Stop);
        let words = |status: &RobotStatus, holder, paused| headline(status, holder, paused).words(holder);
        assert_eq!(words(&stopped, Some(&holder), false), "Waiting for a person (behind, 1.4 m)");
        let pressed = status(Some(Cause::EmergencyStop), GuardState::Latched);
        assert_eq!(words(&pressed, None, false), "Stopped: emergency stop pressed");
        let near = status(Some(Cause::PersonNear), GuardState::Slow);
        assert_eq!(words(&near, Some(&holder), false), "Slow because of a person (behind, 1.4 m)");
        assert_eq!(words(&status(None, GuardState::Run), None, true), "Paused by the operator");
    }
}
