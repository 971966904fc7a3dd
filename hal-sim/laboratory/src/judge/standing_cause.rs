//! Why a robot on its way to a goal stands, by what would have to change for it to drive.

use floorguard_guard::Decision;
use floorguard_navigation::recovery::{Measure, Obstruction, RecoveryStep};
use floorguard_robot::navigator::StandingReason;

/// A person whose body is nearer to the outline than this can be what the planner yields to, metres: what a person walks and the
/// robot drives within the three seconds that are planned ahead.
const PERSON_M: f32 = 4.0;

/// What the judges know while the robot stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct StandingMoment {
    /// What the robot says, if that is true.
    pub(super) reason: Option<StandingReason>,
    /// What the guard permits.
    pub(super) decision: Option<Decision>,
    /// From the outline to the nearest person, truly, metres.
    pub(super) nearest_person_m: f32,
}

impl StandingMoment {
    /// The cause in a few words: the guard's with its own, the planner's with or without a person near.
    pub(super) fn cause(&self) -> String {
        match self.reason {
            Some(StandingReason::Starting) => "starting: no pose or no plan yet".to_owned(),
            Some(StandingReason::Paused) => "paused".to_owned(),
            Some(StandingReason::Looking) => "looks beyond known floor".to_owned(),
            Some(StandingReason::Ended) => "ended".to_owned(),
            Some(StandingReason::Guard(_)) => self.guard(),
            Some(StandingReason::Recovery(step)) => self.obstruction(step),
            // It starts, stops, or its wheel is turned across.
            None => "between two motions".to_owned(),
        }
    }

    fn obstruction(&self, step: RecoveryStep) -> String {
        let people = if self.nearest_person_m < PERSON_M { "a person near" } else { "no person near" };
        let cause = match step.obstruction {
            Some(Obstruction::Held) => self.guard(),
            Some(Obstruction::Yields) => format!("planner: standing is better, {people}"),
            Some(Obstruction::NoVelocity) => format!("planner: no free motion, {people}"),
            Some(Obstruction::NoPath(_)) => format!("planner: no path, {people}"),
            Some(Obstruction::Lost) => "looks for its place on the map".to_owned(),
            None => "recovery".to_owned(),
        };
        match step.measure {
            Measure::BackOut | Measure::OtherWay | Measure::ClearCostmap => {
                format!("recovery ({})", step.measure.words())
            }
            _ => cause,
        }
    }

    fn guard(&self) -> String {
        let held = self.decision.and_then(|decision| decision.holding_cause.or(decision.primary_cause));
        match held {
            Some(record) => format!("guard: {}", record.cause),
            None => "guard: permits nothing yet".to_owned(),
        }
    }
}
