//! Missions one after another: what runs, what waits, and the operator's orders to them.
//!
//! Between missions the last one goes on telling where the robot is. A new one begins where the robot stands and with what the
//! plan expects; areas that change while it runs take nothing from what was cleaned.

use std::collections::VecDeque;

use anyhow::ensure;
use floorguard_mapping::{DirtCell, NO_SLOT};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tasks::{Mission, MissionMoment};
use floorguard_types::geometry::{Pose2, Twist2};

use super::areas::{Area, AreaKind};
use super::mission::{Cleaner, SharedWatch};
use super::ordered::prepared;
use super::orders::{MissionOrder, MissionOrders, QUEUE_MAX, QueueStatus};
use super::plan::MissionPlan;
use super::progress::MissionPhase;
use super::setup::MissionSetup;
use super::store::Store;

/// A mission that waits.
struct Waiting {
    name: String,
    areas: Vec<Area>,
}

/// What the robot cleans, now and next.
pub struct MissionQueue {
    robot: RobotConfiguration,
    base: MissionPlan,
    watch: SharedWatch,
    store: Store,
    orders: MissionOrders,
    current: Cleaner,
    waiting: VecDeque<Waiting>,
    status: QueueStatus,
    is_reported: bool,
}

impl MissionQueue {
    /// Begins with the mission of a setup.
    ///
    /// # Errors
    /// The plan has no floor for this robot.
    pub fn new(setup: &MissionSetup, robot: &RobotConfiguration) -> anyhow::Result<Self> {
        Ok(Self {
            robot: robot.clone(),
            base: setup.plan.clone(),
            watch: setup.watch.clone(),
            store: setup.store.clone(),
            orders: setup.orders.clone(),
            current: setup.begin(robot)?,
            waiting: VecDeque::new(),
            status: QueueStatus::default(),
            is_reported: false,
        })
    }

    fn obey(&mut self, order: MissionOrder) -> anyhow::Result<()> {
        match order {
            MissionOrder::Begin { name, areas } => {
                ensure!(self.waiting.len() < QUEUE_MAX, "{QUEUE_MAX} missions wait already");
                self.waiting.push_back(Waiting { name, areas });
            }
            MissionOrder::Cancel { place: 0 } => {
                ensure!(!self.current.phase.is_over(), "no mission runs");
                self.current.cancel();
            }
            MissionOrder::Cancel { place } => {
                ensure!(self.waiting.remove(place - 1).is_some(), "no mission waits there");
            }
            MissionOrder::Areas { areas } => self.change_areas(areas)?,
            MissionOrder::Locate { x_m, y_m, heading_rad } => {
                self.current.place_at(Pose2::new(x_m, y_m, heading_rad))?;
            }
        }
        Ok(())
    }

    /// A mission on the plan with these areas, where the robot is now.
    fn prepared(&self, areas: Vec<Area>) -> anyhow::Result<Cleaner> {
        let mut plan = self.base.clone();
        plan.areas = areas;
        let mut next = prepared((&plan, &self.robot), &self.watch, &self.current.whereabouts())?;
        next.go_on_from(&self.current);
        next.store = self.store.clone();
        Ok(next)
    }

    /// The areas of the mission that runs are others now: its own area to clean stays.
    fn change_areas(&mut self, areas: Vec<Area>) -> anyhow::Result<()> {
        let own = self.current.plan.areas.iter().filter(|area| area.kind == AreaKind::Clean).cloned();
        let areas: Vec<Area> =
            own.chain(areas.into_iter().filter(|area| area.kind != AreaKind::Clean)).collect();
        if areas == self.current.plan.areas {
            return Ok(());
        }
        let mut next = self.prepared(areas)?;
        next.keep_cleaned_of(&self.current);
        self.current = next;
        Ok(())
    }

    fn begin_next(&mut self) -> anyhow::Result<()> {
        let Some(Waiting { name, areas }) = self.waiting.pop_front() else { return Ok(()) };
        let next = self.prepared(areas).map_err(|error| error.context(format!("mission {name}")))?;
        self.store.forget();
        self.current = next;
        self.status.name = name;
        Ok(())
    }

    fn answer(&mut self, outcome: anyhow::Result<()>) {
        self.status.answered = self.status.answered.wrapping_add(1);
        self.status.refused = outcome.err().map(|error| format!("{error:#}")).unwrap_or_default();
        self.is_reported = false;
    }

    fn hear_operator(&mut self) {
        for order in self.orders.take().unwrap_or_default() {
            let outcome = self.obey(order);
            self.answer(outcome);
        }
        if self.current.phase.is_over() && !self.waiting.is_empty() {
            let outcome = self.begin_next();
            self.answer(outcome);
        }
        if !self.is_reported {
            self.status.waiting = self.waiting.iter().map(|mission| mission.name.clone()).collect();
            self.is_reported = self.orders.publish(&self.status);
        }
    }
}

impl Mission for MissionQueue {
    fn step(&mut self, moment: &MissionMoment<'_>) -> Twist2 {
        self.hear_operator();
        self.current.step(moment)
    }
}

impl Cleaner {
    /// The operator has given the mission up.
    pub(crate) fn cancel(&mut self) {
        self.phase = MissionPhase::Cancelled;
        self.track = super::track::Track::default();
        self.next_report_s = 0.0;
    }

    /// The operator says where the robot stands.
    pub(crate) fn place_at(&mut self, pose_in_map: Pose2) -> anyhow::Result<()> {
        let is_free = self.ground.is_free(pose_in_map, floorguard_types::motion::Gear::Ahead);
        ensure!(is_free, "the robot does not fit there: a wall or a no-go area is too near");
        self.localiser.place_at(pose_in_map, self.odometry.pose_in_odometry);
        self.track = super::track::Track::default();
        self.lost_s = 0.0;
        self.next_report_s = 0.0;
        Ok(())
    }

    /// Goes on with what another mission's senses know; where the robot is it knows already.
    fn go_on_from(&mut self, before: &Self) {
        self.dirt = before.dirt;
        self.people_seen.clone_from(&before.people_seen);
    }

    /// The same mission with other areas: what is known of its floor stays, and so do its figures.
    pub(crate) fn keep_cleaned_of(&mut self, before: &Self) {
        let known = before.localiser.map.values();
        if known.len() == self.localiser.map.values().len() {
            for (cell, known) in self.localiser.map.values_mut().iter_mut().zip(known) {
                *cell = DirtCell { slot: NO_SLOT, ..*known };
            }
        }
        self.began = before.began;
        self.last_s = before.last_s;
        self.times = before.times;
        self.distance_m = before.distance_m;
        self.detours = before.detours;
        self.phase = before.phase;
    }
}

#[cfg(test)]
#[path = "queue_tests.rs"]
mod tests;
