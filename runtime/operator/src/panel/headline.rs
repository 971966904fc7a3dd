//! What the robot does or waits for, in a few words.

use floorguard_guard::{Cause, GuardState};
use floorguard_runtime::shared::RobotStatus;

use crate::surroundings::Holder;

/// Slower counts as standing, m/s.
const STANDING_MPS: f32 = 0.02;

/// For the person beside the robot: `Waiting for a person (behind, 1.4 m)`.
pub fn headline(status: &RobotStatus, holder: Option<&Holder>, paused: bool) -> String {
    let decision = &status.decision;
    let cause = decision.holding_cause.map(|record| record.cause);
    let name = || cause.map_or_else(String::new, |cause| cause.to_string());
    let stands = status.pose.twist.linear_mps.abs() < STANDING_MPS;
    match (decision.action.stops(), cause, holder) {
        (true, Some(Cause::StartNeeded), _) => "Waiting for the start command".to_owned(),
        (true, _, Some(holder)) => format!("Waiting for {}", holder.words()),
        (true, _, None) if decision.state == GuardState::Latched => format!("Stopped: {}", name()),
        (true, ..) => format!("Waiting: {}", name()),
        (false, ..) if paused => "Paused by the operator".to_owned(),
        (false, Some(_), Some(holder)) => format!("Slow because of {}", holder.words()),
        (false, Some(_), None) => format!("Slow: {}", name()),
        (false, None, _) if stands => "Standing".to_owned(),
        (false, None, _) => "Driving".to_owned(),
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
        assert_eq!(headline(&stopped, Some(&holder), false), "Waiting for a person (behind, 1.4 m)");
        let pressed = status(Some(Cause::EmergencyStop), GuardState::Latched);
        assert_eq!(headline(&pressed, None, false), "Stopped: emergency stop pressed");
        let near = status(Some(Cause::PersonNear), GuardState::Slow);
        assert_eq!(headline(&near, Some(&holder), false), "Slow because of a person (behind, 1.4 m)");
        assert_eq!(headline(&status(None, GuardState::Run), None, true), "Paused by the operator");
    }
}
