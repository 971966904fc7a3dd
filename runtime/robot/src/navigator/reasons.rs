//! Why the robot stands, in one sentence.

use floorguard_guard::{Cause, Decision};
use floorguard_navigation::recovery::{Measure, RecoveryStep};
use floorguard_runtime::tasks::MissionMoment;
use floorguard_types::geometry::Twist2;

use super::docking::Docking;
use super::drive::Navigator;
use super::exploring::Exploring;
use super::progress::NavigationPhase;
use super::touring::Tour;

/// Why the robot stands. Everything that the drive can do about it has a name here; a robot that stands for no such reason is at
/// fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StandingReason {
    /// Nothing is known yet: the pose or the first plan is missing.
    Starting,
    /// The operator has paused it.
    Paused,
    /// The guard permits less than standing still would need: its cause, if it names one.
    Guard(Option<Cause>),
    /// It does something about an obstruction.
    Recovery(RecoveryStep),
    /// It is where a frontier is in sight, at a place of a tour, or at its dock, and waits for the scans that show more.
    Looking,
    /// It is at its goal, was given up, or waits for an order.
    Ended,
}

impl StandingReason {
    /// The guard's reason, where its decision lets nothing move.
    pub(super) fn of_guard(decision: &Decision) -> Self {
        Self::Guard(decision.holding_cause.or(decision.primary_cause).map(|record| record.cause))
    }
}

impl std::fmt::Display for StandingReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Starting => write!(f, "the pose or the first plan is missing"),
            Self::Paused => write!(f, "the operator has paused the robot"),
            Self::Guard(Some(cause)) => write!(f, "the guard holds the robot: {cause}"),
            Self::Guard(None) => write!(f, "the guard does not permit motion yet"),
            Self::Recovery(step) => match step.obstruction {
                Some(obstruction) if step.measure == Measure::CallHelp => {
                    write!(f, "calls for help after {:.0} s: {obstruction}", step.obstructed_s)
                }
                Some(obstruction) => write!(f, "{}: {obstruction}", step.measure.words()),
                None => write!(f, "{}", step.measure.words()),
            },
            Self::Looking => write!(f, "observes what can be seen from here"),
            Self::Ended => write!(f, "the drive has ended"),
        }
    }
}

impl Navigator {
    /// Why the robot stands, if it is to stand or is not let.
    pub(super) fn standing_reason(&self, moment: &MissionMoment<'_>) -> Option<StandingReason> {
        let is_held = moment.decision.is_none_or(|decision| is_standing(decision.permitted));
        let is_asked = !is_standing(self.requested);
        match (self.phase, self.step) {
            _ if moment.is_paused => Some(StandingReason::Paused),
            (phase, _) if phase.stands() => Some(StandingReason::Ended),
            _ if self.docking.as_ref().is_some_and(Docking::has_failed) => Some(StandingReason::Ended),
            (_, Some(step)) if step.measure != Measure::Drive && (is_held || !is_asked) => {
                Some(StandingReason::Recovery(step))
            }
            _ if is_asked && is_held => Some(
                moment
                    .decision
                    .map_or(StandingReason::Starting, |decision| StandingReason::of_guard(&decision)),
            ),
            _ if self.tour.as_ref().is_some_and(Tour::is_looking) => Some(StandingReason::Looking),
            _ if self.docking.as_ref().is_some_and(Docking::is_looking) => Some(StandingReason::Looking),
            (NavigationPhase::Starting, _) => Some(StandingReason::Starting),
            _ if self.exploring.as_ref().is_some_and(Exploring::is_observing) => {
                Some(StandingReason::Looking)
            }
            _ => None,
        }
    }
}

/// Slower requests are standing, m/s and rad/s.
const STANDS: (f32, f32) = (0.03, 0.06);

/// Slower than what counts as motion.
pub(super) fn is_standing(twist: Twist2) -> bool {
    twist.linear_mps.abs() < STANDS.0 && twist.angular_radps.abs() < STANDS.1
}
