//! What somebody outside orders to be cleaned, one cleaning after another, and how far the newest is.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError, TryLockError};

use super::ordered::CleaningCounts;

/// Orders that wait for the next step; more are refused.
const ORDERS_MAX: usize = 16;

/// A part of the floor to clean.
#[derive(Clone, Debug, PartialEq)]
pub struct CleaningOrder {
    /// Counts the cleanings; the status names it.
    pub number: u32,
    /// Corners of the area in order, map frame, metres; none: the whole floor.
    pub corners_m: Vec<[f32; 2]>,
    /// Units that may stay in a clean cell, τ; none: as the mission says.
    pub tolerated_units: Option<u8>,
    /// Probability with which a cell called clean may hold more, δ; none: as the mission says.
    pub delta: Option<f64>,
    /// It was broken off when the computer lost its power: what was cleaned stays cleaned.
    pub goes_on: bool,
}

/// What somebody outside orders of the cleaning.
#[derive(Clone, Debug, PartialEq)]
pub enum CleaningCommand {
    /// Clean there.
    Clean(CleaningOrder),
    /// Give up what is being cleaned.
    End,
}

/// How a cleaning stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CleaningStage {
    /// The robot cleans, or is held.
    Cleaning,
    /// It is done, with everything that was asked for.
    Done,
    /// It has ended with less than was asked for, and why.
    Failed(String),
}

/// The newest cleaning.
#[derive(Clone, Debug, PartialEq)]
pub struct CleaningStatus {
    /// Its number.
    pub number: u32,
    /// How it stands.
    pub stage: CleaningStage,
    /// How far it is; none before it began.
    pub counts: Option<CleaningCounts>,
}

#[derive(Debug, Default)]
struct Inside {
    orders: VecDeque<CleaningCommand>,
    status: Option<CleaningStatus>,
}

/// Between somebody outside and the robot, which never waits for them. Clones share the orders.
#[derive(Clone, Debug, Default)]
pub struct CleaningOrders(Arc<Mutex<Inside>>);

impl CleaningOrders {
    /// Adds an order. False when too many wait.
    pub fn push(&self, order: CleaningCommand) -> bool {
        let mut inside = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fits = inside.orders.len() < ORDERS_MAX;
        if fits {
            inside.orders.push_back(order);
        }
        fits
    }

    /// The newest cleaning; none before the first since the robot was switched on.
    #[must_use]
    pub fn status(&self) -> Option<CleaningStatus> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).status.clone()
    }

    /// For the robot: the oldest order. `None` also while the other side holds them; it comes with the next step.
    pub(crate) fn take(&self) -> Option<CleaningCommand> {
        match self.0.try_lock() {
            Ok(mut inside) => inside.orders.pop_front(),
            Err(TryLockError::Poisoned(inside)) => inside.into_inner().orders.pop_front(),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// For the robot: makes the status known. False while the other side holds it.
    pub(crate) fn publish(&self, status: &Option<CleaningStatus>) -> bool {
        match self.0.try_lock() {
            Ok(mut inside) => inside.status.clone_from(status),
            Err(TryLockError::Poisoned(inside)) => inside.into_inner().status.clone_from(status),
            Err(TryLockError::WouldBlock) => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cleanings_come_in_turn_and_are_bounded() {
        let orders = CleaningOrders::default();
        let order = CleaningOrder {
            number: 1,
            corners_m: Vec::new(),
            tolerated_units: None,
            delta: None,
            goes_on: false,
        };
        assert!(orders.push(CleaningCommand::Clean(order.clone())) && orders.push(CleaningCommand::End));
        assert_eq!(orders.take(), Some(CleaningCommand::Clean(order)));
        assert_eq!((orders.take(), orders.take()), (Some(CleaningCommand::End), None));
        assert!((0..ORDERS_MAX).all(|_| orders.push(CleaningCommand::End)));
        assert!(!orders.push(CleaningCommand::End));
    }
}
