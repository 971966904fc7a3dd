//! From the measurement that made the robot stop to the order on the bus: what the robot itself is answerable for.

use floorguard_guard::{Cause, CauseRecord};
use std::collections::VecDeque;

/// A decision and its frame are in the same cycle of 10 ms; frames older than this answer nothing, microseconds.
const KEPT_US: u64 = 500_000;
/// Orders differ when they do so by more than this, m/s.
const SAME_MPS: f32 = 1.0e-3;

/// An order to the traction drive.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Order {
    at_us: u64,
    speed_mps: f32,
}

/// A stop that no order has answered yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pending {
    measured_us: u64,
    decided_us: u64,
}

/// When the robot could first know the reason of a stop that it decided at this moment. Silence of a source is known at the end of
/// the time that it may take, not at its last message.
#[must_use]
pub fn known_us(cause: &CauseRecord, decided_us: u64) -> u64 {
    let is_silence = matches!(cause.cause, Cause::SourceLost(_) | Cause::SourceLate(_));
    let allowed_us = if is_silence { (f64::from(cause.limit) * 1.0e6) as u64 } else { 0 };
    decided_us.saturating_sub(cause.age_us.saturating_sub(allowed_us))
}

/// Watches orders and stops; both may come to its notice in either order.
#[derive(Clone, Debug, Default)]
pub struct StopOrders {
    orders: VecDeque<Order>,
    pending: Vec<Pending>,
    latencies_us: Vec<u64>,
}

impl StopOrders {
    /// An order on the bus: the speed of the front wheel, 0 for any kind of stop.
    pub fn order(&mut self, at_us: u64, speed_mps: f32) {
        let first = self.orders.len() < 2;
        self.orders.push_back(Order { at_us, speed_mps });
        while !first && self.orders.front().is_some_and(|order| order.at_us + KEPT_US < at_us) {
            self.orders.pop_front();
        }
        let pending = std::mem::take(&mut self.pending);
        self.pending = pending.into_iter().filter(|stop| !self.answer(stop)).collect();
    }

    /// The robot decided to stop at one moment, for what was measured at an earlier one, microseconds.
    pub fn stop(&mut self, measured_us: u64, decided_us: u64) {
        let stop = Pending { measured_us, decided_us };
        if !self.answer(&stop) {
            self.pending.push(stop);
        }
    }

    /// The first order of less after the decision; a stop of a robot that was not commanded to move needs
    /// none.
    fn answer(&mut self, stop: &Pending) -> bool {
        let before = self.orders.iter().rev().find(|order| order.at_us < stop.decided_us);
        let speed_mps = before.map_or(0.0, |order| order.speed_mps.abs());
        if speed_mps < SAME_MPS {
            return true;
        }
        let less =
            |order: &&Order| order.at_us >= stop.decided_us && order.speed_mps.abs() < speed_mps - SAME_MPS;
        let Some(order) = self.orders.iter().find(less) else { return false };
        self.latencies_us.push(order.at_us - stop.measured_us.min(order.at_us));
        true
    }

    /// From measurement to order, microseconds.
    #[must_use]
    pub fn latencies_us(&self) -> &[u64] {
        &self.latencies_us
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_guard::{Source, Unit};
    use floorguard_types::time::Stamp;

    #[test]
    fn silence_is_known_at_its_limit() {
        let of = |cause| CauseRecord::new(cause, Stamp::ZERO).aged(209_000);
        assert_eq!(known_us(&of(Cause::ScanProtective), 1_000_000), 791_000);
        let lost = of(Cause::SourceLost(Source::Lidar)).measured(0.209, 0.2, Unit::Seconds);
        assert!(known_us(&lost, 1_000_000).abs_diff(991_000) <= 1);
    }

    #[test]
    fn first_lower_order_answers_the_first_cause() {
        let mut orders = StopOrders::default();
        for tick in 0..100_u64 {
            orders.order(tick * 10_000, 0.5);
        }
        // Noticed before its order.
        orders.stop(980_000, 1_000_000);
        orders.order(1_000_000, 0.5);
        orders.order(1_003_000, 0.4);
        assert_eq!(orders.latencies_us(), [23_000]);
        orders.order(2_000_000, 0.5);
        orders.order(2_010_000, 0.0);
        // Noticed after it.
        orders.stop(1_990_000, 2_010_000);
        assert_eq!(orders.latencies_us(), [23_000, 20_000]);
        // It stands: nothing to order.
        orders.stop(2_100_000, 2_110_000);
        orders.order(2_120_000, 0.0);
        assert_eq!(orders.latencies_us().len(), 2);
    }
}
