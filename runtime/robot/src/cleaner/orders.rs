//! What an operator orders of the mission, and what is known of the missions that wait.

use std::sync::{Arc, Mutex, PoisonError, TryLockError};

use anyhow::ensure;
use floorguard_types::geometry::Pose2;
use serde::{Deserialize, Serialize};

use super::areas::{Area, check_areas};

/// Missions that may wait for the one before.
pub const QUEUE_MAX: usize = 8;
/// Orders that wait for the mission's next step; more are refused.
const ORDERS_MAX: usize = 16;
/// Letters of an order at most.
const TEXT_MAX: usize = 24_000;
/// Letters of a mission's name at most.
const NAME_MAX: usize = 80;

/// An order to the mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum MissionOrder {
    /// Clean, after what is being cleaned and what waits.
    Begin {
        /// What people call the mission.
        name: String,
        /// What it cleans, and the areas that it keeps to; without an area to clean it is the whole floor.
        areas: Vec<Area>,
    },
    /// Give up the mission of this place: 0 is the one that runs, 1 the first that waits.
    Cancel {
        /// The place.
        place: usize,
    },
    /// The areas have changed; what was cleaned stays cleaned.
    Areas {
        /// No-go and slow areas.
        areas: Vec<Area>,
    },
    /// The robot stands here.
    Locate {
        /// Map frame, metres.
        x_m: f32,
        /// Map frame, metres.
        y_m: f32,
        /// Map frame, radians.
        heading_rad: f32,
    },
}

impl MissionOrder {
    /// Refuses what no mission can do.
    ///
    /// # Errors
    /// An unusable area, a name that is too long, a place that is no number, or a text that is too long for a recording.
    pub fn check(&self) -> anyhow::Result<()> {
        match self {
            Self::Begin { name, areas } => {
                ensure!(name.chars().count() <= NAME_MAX, "a name has {NAME_MAX} letters at most");
                check_areas(areas)?;
            }
            Self::Areas { areas } => check_areas(areas)?,
            Self::Cancel { place } => ensure!(*place <= QUEUE_MAX, "no mission waits there"),
            Self::Locate { x_m, y_m, heading_rad } => {
                let pose = Pose2::new(*x_m, *y_m, *heading_rad);
                ensure!(
                    [pose.x_m, pose.y_m, pose.heading_rad].iter().all(|part| part.is_finite()),
                    "the place is no place"
                );
            }
        }
        ensure!(self.to_text().len() <= TEXT_MAX, "too many corners for one order");
        Ok(())
    }

    /// As one line of text, for recordings.
    #[must_use]
    pub fn to_text(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// From such a line.
    ///
    /// # Errors
    /// It is no order, or one that [`Self::check`] refuses.
    pub fn from_text(text: &[u8]) -> anyhow::Result<Self> {
        let order: Self = serde_json::from_slice(text)?;
        order.check()?;
        Ok(order)
    }
}

/// What runs and what waits.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct QueueStatus {
    /// The mission that runs, or ran last.
    pub name: String,
    /// Those that wait, in their order.
    pub waiting: Vec<String>,
    /// Why the last order was refused; empty after one that was carried out.
    pub refused: String,
    /// Counts orders that were answered.
    pub answered: u32,
}

#[derive(Debug, Default)]
struct Inside {
    orders: Vec<MissionOrder>,
    status: QueueStatus,
}

/// Between the operator's side and the mission, which never waits for the other.
#[derive(Clone, Debug, Default)]
pub struct MissionOrders(Arc<Mutex<Inside>>);

impl MissionOrders {
    /// Adds an order. False when too many wait.
    pub fn push(&self, order: MissionOrder) -> bool {
        let mut inside = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fits = inside.orders.len() < ORDERS_MAX;
        if fits {
            inside.orders.push(order);
        }
        fits
    }

    /// What runs and what waits.
    #[must_use]
    pub fn status(&self) -> QueueStatus {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).status.clone()
    }

    /// For the mission: the orders so far. `None` while the other side holds them; they come with the next step.
    pub(crate) fn take(&self) -> Option<Vec<MissionOrder>> {
        match self.0.try_lock() {
            Ok(mut inside) => Some(std::mem::take(&mut inside.orders)),
            Err(TryLockError::Poisoned(inside)) => Some(std::mem::take(&mut inside.into_inner().orders)),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// For the mission: makes the status known. False while the other side holds it.
    pub(crate) fn publish(&self, status: &QueueStatus) -> bool {
        match self.0.try_lock() {
            Ok(mut inside) => inside.status.clone_from(status),
            Err(TryLockError::Poisoned(inside)) => inside.into_inner().status.clone_from(status),
            Err(TryLockError::WouldBlock) => return false,
        }
        true
    }
}
