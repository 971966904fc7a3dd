//! From a decision to a command to the drives. What lies between them stands in memory until the next tick, and the numbers of
//! the steering for good: both are kept twice (FG-REQ-058).

use floorguard_drivers::three_wheel_base::StopKind;
use floorguard_guard::{Action, Decision};
use floorguard_types::geometry::Twist2;

use super::bus_base::BaseKinematics;
use crate::doubled::Doubled;

/// What the drives need to know of a decision.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Order {
    permitted: Twist2,
    action: Action,
    torque_off: bool,
}

/// The newest decision, and what makes a command of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveOrder<K> {
    order: Doubled<Order>,
    kinematics: Doubled<K>,
    /// As the steering drive reported it last, radians.
    pub(super) steering_rad: f32,
}

impl<K: BaseKinematics> DriveOrder<K> {
    /// Before the first decision: no torque.
    pub(super) fn new(kinematics: K) -> Self {
        let order = Order { permitted: Twist2::ZERO, action: Action::Category0, torque_off: true };
        Self { order: Doubled::new(order), kinematics: Doubled::new(kinematics), steering_rad: 0.0 }
    }

    /// A decision was taken.
    pub(super) fn follow(&mut self, decision: &Decision) {
        let Decision { permitted, action, torque_off, .. } = *decision;
        self.order.set(Order { permitted, action, torque_off });
    }

    /// What it means for the drives now; `None` when something that is kept twice differs.
    pub(super) fn command(&self) -> Option<K::Command> {
        let (order, kinematics) = (self.order.get()?, self.kinematics.get()?);
        if order.torque_off {
            return Some(K::TORQUE_OFF);
        }
        let permitted = order.permitted;
        let moves = permitted.linear_mps != 0.0 || permitted.angular_radps != 0.0;
        Some(match order.action {
            Action::Category1 if !moves => K::stopping(StopKind::Ramp),
            Action::Category2 if !moves => K::stopping(StopKind::Hold),
            _ => kinematics.moving(permitted, self.steering_rad),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_drivers::three_wheel_base::DriveCommand;
    use floorguard_guard::GuardState;
    use floorguard_localisation::odometry::Tricycle;
    use floorguard_types::time::Stamp;

    type Change<'a> = &'a dyn Fn(&mut DriveOrder<Tricycle>);

    fn flipped(number: f32, bit: u32) -> f32 {
        f32::from_bits(number.to_bits() ^ (1 << bit))
    }

    /// Every bit of the numbers between a decision and the frames on the bus.
    #[test]
    fn fg_req_058_flipped_order_gives_no_command() {
        let mut order = DriveOrder::new(Tricycle { wheelbase_m: 1.1, steering_max_rad: 1.57 });
        assert_eq!(order.command(), Some(DriveCommand::Stop(StopKind::TorqueOff)), "before a decision");
        order.follow(&Decision {
            stamp: Stamp::ZERO,
            permitted: Twist2 { linear_mps: 0.5, angular_radps: 0.1 },
            action: Action::None,
            speed_limit_mps: 1.0,
            state: GuardState::Run,
            primary_cause: None,
            holding_cause: None,
            torque_off: false,
            escaping: false,
            field_set: 0,
        });
        assert!(matches!(order.command(), Some(DriveCommand::Move { wheel_mps, .. }) if wheel_mps > 0.4));
        let changed = |change: Change<'_>| {
            let mut order = order;
            change(&mut order);
            order.command()
        };
        for bit in 0..32 {
            let flips: [Change<'_>; 5] = [
                &|order| {
                    let speed_mps = &mut order.order.value.permitted.linear_mps;
                    *speed_mps = flipped(*speed_mps, bit);
                },
                &|order| {
                    let turn_radps = &mut order.order.copy.permitted.angular_radps;
                    *turn_radps = flipped(*turn_radps, bit);
                },
                &|order| {
                    let wheelbase_m = &mut order.kinematics.value.wheelbase_m;
                    *wheelbase_m = flipped(*wheelbase_m, bit);
                },
                &|order| {
                    let steering_max_rad = &mut order.kinematics.copy.steering_max_rad;
                    *steering_max_rad = flipped(*steering_max_rad, bit);
                },
                &|order| order.order.value.torque_off = true,
            ];
            for (index, flip) in flips.into_iter().enumerate() {
                assert_eq!(changed(flip), None, "bit {bit} of {index}");
            }
        }
        assert_eq!(changed(&|order| order.order.copy.action = Action::Category2), None);
    }
}
