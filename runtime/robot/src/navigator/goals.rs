//! Places that somebody outside sends the robot to, one after another: a fleet's master.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError, TryLockError};

use floorguard_types::geometry::{Pose2, Twist2};

use crate::cleaner::Whereabouts;

use super::course::Course;
use super::drive::Navigator;
use super::model::times_of;
use super::progress::NavigationPhase;
use floorguard_navigation::recovery::Recovery;

/// Orders that wait for the drive's next step; more are refused.
const ORDERS_MAX: usize = 16;

/// A place to go to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderedGoal {
    /// Counts the goals; the drive's progress names it.
    pub number: u32,
    /// Where, map frame.
    pub goal_in_map: Pose2,
    /// It counts as reached within, metres.
    pub within_m: f32,
    /// And within, radians; π: any heading is good.
    pub within_rad: f32,
    /// On the way there it requests no more.
    pub way: WayLimits,
}

/// What a drive requests at most on its way to a goal, beside what its settings say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayLimits {
    /// Ahead and back, m/s.
    pub speed_mps: f32,
    /// Turning, rad/s.
    pub turn_radps: f32,
}

impl WayLimits {
    /// The settings alone say how fast.
    pub const NONE: Self = Self { speed_mps: f32::INFINITY, turn_radps: f32::INFINITY };

    /// The same curve, no faster than both.
    #[must_use]
    pub fn limit(&self, requested: Twist2) -> Twist2 {
        let share = |most: f32, asked: f32| if asked.abs() > most { most / asked.abs() } else { 1.0 };
        let along = share(self.speed_mps, requested.linear_mps);
        let share = along.min(share(self.turn_radps, requested.angular_radps));
        Twist2 { linear_mps: share * requested.linear_mps, angular_radps: share * requested.angular_radps }
    }
}

/// What somebody outside orders the drive to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveOrder {
    /// Drive there, instead of anywhere else.
    Goto(OrderedGoal),
    /// Stand, and wait for another order.
    Stand,
    /// The robot stands here, map frame.
    Relocate(Pose2),
}

/// Between somebody outside and the drive, which never waits for them. Clones share the orders.
#[derive(Clone, Debug, Default)]
pub struct DriveOrders(Arc<Mutex<VecDeque<DriveOrder>>>);

impl DriveOrders {
    /// Adds an order. False when too many wait.
    pub fn push(&self, order: DriveOrder) -> bool {
        let mut orders = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fits = orders.len() < ORDERS_MAX;
        if fits {
            orders.push_back(order);
        }
        fits
    }

    /// The oldest order. `None` also while the other side holds them; it comes with the next step.
    fn take(&self) -> Option<DriveOrder> {
        match self.0.try_lock() {
            Ok(mut orders) => orders.pop_front(),
            Err(TryLockError::Poisoned(orders)) => orders.into_inner().pop_front(),
            Err(TryLockError::WouldBlock) => None,
        }
    }
}

impl Navigator {
    /// What was ordered since the last step.
    pub(super) fn take_orders(&mut self) {
        let Some(orders) = self.orders.clone() else { return };
        for _ in 0..ORDERS_MAX {
            let Some(order) = orders.take() else { break };
            match order {
                DriveOrder::Goto(goal) => self.begin_goal(&goal),
                DriveOrder::Stand => self.wait_for_order(),
                DriveOrder::Relocate(pose) => self.place_at(pose),
            }
        }
    }

    fn begin_goal(&mut self, ordered: &OrderedGoal) {
        let goal = ordered.goal_in_map;
        self.plan.goal = [goal.x_m, goal.y_m, goal.heading_rad];
        self.plan.settings.within_m = ordered.within_m;
        self.plan.settings.within_rad = ordered.within_rad;
        self.goal_number = ordered.number;
        self.way = ordered.way;
        self.steering.limit(ordered.way);
        self.begin_anew(NavigationPhase::Starting);
    }

    pub(crate) fn wait_for_order(&mut self) {
        self.begin_anew(NavigationPhase::Waiting);
    }

    /// The robot has no reason of the drive to move.
    pub(crate) const fn stands(&self) -> bool {
        self.phase.stands()
    }

    /// Somebody outside says where the robot stands, map frame.
    pub(crate) fn place_at(&mut self, pose_in_map: Pose2) {
        self.senses.relocate(pose_in_map);
        self.course = Course::default();
    }

    /// Where the robot is, for what drives it next.
    pub(crate) fn whereabouts(&self) -> Whereabouts {
        self.senses.whereabouts()
    }

    pub(super) fn begin_anew(&mut self, phase: NavigationPhase) {
        self.phase = phase;
        self.course = Course::default();
        self.recovery = Recovery::new(times_of(&self.plan.settings));
        self.back.clear();
        self.failure = None;
        self.step = None;
        // The map alone is asked again for each goal.
        self.is_proved = false;
        self.next_plan_s = 0.0;
        self.steering.restart();
        // Progress is reported at once.
        self.reported = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It can only tighten, and it leaves the curve as it is.
    #[test]
    fn limited_request_keeps_its_curve() {
        let asked = Twist2 { linear_mps: -0.6, angular_radps: 0.3 };
        assert_eq!(WayLimits::NONE.limit(asked), asked);
        let slow = WayLimits { speed_mps: 0.2, turn_radps: 0.3 }.limit(asked);
        assert!((slow.linear_mps + 0.2).abs() < 1.0e-6 && (slow.angular_radps - 0.1).abs() < 1.0e-6);
        let turning = WayLimits { speed_mps: 1.0, turn_radps: 0.1 }.limit(asked);
        assert!((turning.linear_mps + 0.2).abs() < 1.0e-6 && (turning.angular_radps - 0.1).abs() < 1.0e-6);
    }

    #[test]
    fn orders_come_in_turn_and_are_bounded() {
        let orders = DriveOrders::default();
        let here = DriveOrder::Relocate(Pose2::default());
        assert!(orders.push(here) && orders.push(DriveOrder::Stand));
        assert_eq!(
            (orders.take(), orders.take(), orders.take()),
            (Some(here), Some(DriveOrder::Stand), None)
        );
        assert!((0..ORDERS_MAX).all(|_| orders.push(DriveOrder::Stand)) && !orders.push(here));
    }
}
