//! The virtual world's base that takes velocities: its line to the robot, and how it moves the simulated body.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_time::Timer;
use floorguard_host::executor::TaskSet;
use floorguard_robot::assembly::spawn_velocity_base;
use floorguard_runtime::clock;
use floorguard_runtime::configuration::BaseKind;
use floorguard_runtime::io::{FramePort, PortFrame};
use floorguard_runtime::shared::Shared;
use floorguard_sim::Simulation;
use floorguard_sim::robot::VelocityBase;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use crate::plan::Plan;

/// Time between two reports, milliseconds.
const REPORT_MS: u64 = 20;

/// The base, and what it measures; shared by its line and the world.
#[derive(Clone, Default)]
pub(super) struct BaseInWorld(Rc<RefCell<(VelocityBase, Twist2)>>);

impl BaseInWorld {
    /// The robot's task of this base.
    pub fn spawn<'a>(&self, tasks: &mut TaskSet<'a>, plan: &Plan, shared: &'a Shared<NoopRawMutex>) {
        spawn_velocity_base(tasks, shared, (BasePort { base: self.clone(), next_us: 0 }, &plan.robot));
    }
}

/// Moves the simulated body by what the base drives now, if the robot has such a one.
pub(super) fn attend(base: Option<&BaseInWorld>, (simulation, now_us): (&mut Simulation, u64)) {
    let Some(base) = base else { return };
    let (base, measured) = &mut *base.0.borrow_mut();
    *measured = simulation.robot().1;
    let driven = base.step(now_us);
    simulation.tow_at(driven);
}

/// The drives of a plan's robot are on a bus: it has no base that takes velocities.
pub(super) fn has_bus(plan: &Plan) -> bool {
    plan.robot.base == BaseKind::CanBus
}

/// The robot's end of the line.
struct BasePort {
    base: BaseInWorld,
    next_us: u64,
}

impl FramePort for BasePort {
    type Error = Infallible;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<PortFrame, Infallible> {
        let now = clock::now();
        self.next_us = self.next_us.max(now.as_micros());
        Timer::at(clock::instant(Stamp::from_micros(self.next_us))).await;
        self.next_us += REPORT_MS * 1_000;
        let (base, measured) = &mut *self.base.0.borrow_mut();
        let bytes = base.report(*measured, 0);
        buffer[..bytes.len()].copy_from_slice(&bytes);
        Ok(PortFrame { length: bytes.len(), arrival: clock::now(), peer: 0 })
    }

    fn follow(&mut self) {}

    async fn send(&mut self, frame: &[u8]) -> Result<(), Infallible> {
        self.base.0.borrow_mut().0.receive(frame, clock::now().as_micros());
        Ok(())
    }
}
