//! The virtual world's link to a program outside: it sends what was planned when it was planned.

use std::convert::Infallible;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_time::Timer;
use floorguard_host::executor::TaskSet;
use floorguard_robot::assembly::{spawn_commanded, velocity_rules};
use floorguard_runtime::clock;
use floorguard_runtime::io::{FramePort, PortFrame};
use floorguard_runtime::shared::Shared;
use floorguard_types::time::Stamp;

use super::velocity_base::{BaseInWorld, has_bus};
use crate::plan::{OutsideProgram, Plan};

/// The task that lets the plan's program drive, if there is one, and that of a base that takes velocities, which is given.
pub(super) fn spawn_outside<'a>(
    tasks: &mut TaskSet<'a>,
    plan: &Plan,
    shared: &'a Shared<NoopRawMutex>,
) -> Option<BaseInWorld> {
    let base = (!has_bus(plan)).then(BaseInWorld::default);
    if let Some(base) = &base {
        base.spawn(tasks, plan, shared);
    }
    if let (Some(command), Some(program)) = (&plan.command, &plan.outside) {
        let rules = velocity_rules(&plan.robot, command);
        spawn_commanded(tasks, shared, (ScriptedPort::new(program), rules));
    }
    base
}

/// The robot's end of the link. A computer that is switched on again has missed what was sent meanwhile.
struct ScriptedPort {
    program: OutsideProgram,
    next: usize,
}

impl ScriptedPort {
    fn new(program: &OutsideProgram) -> Self {
        let now_us = clock::now().as_micros();
        let next = program.sent.partition_point(|frame| frame.at_us < now_us);
        Self { program: program.clone(), next }
    }
}

impl FramePort for ScriptedPort {
    type Error = Infallible;

    async fn receive(&mut self, buffer: &mut [u8]) -> Result<PortFrame, Infallible> {
        let Some(frame) = self.program.sent.get(self.next) else { return std::future::pending().await };
        Timer::at(clock::instant(Stamp::from_micros(frame.at_us))).await;
        let length = frame.bytes.len().min(buffer.len());
        buffer[..length].copy_from_slice(&frame.bytes[..length]);
        self.next += 1;
        Ok(PortFrame { length, arrival: clock::now(), peer: frame.peer })
    }

    fn follow(&mut self) {}

    async fn send(&mut self, frame: &[u8]) -> Result<(), Infallible> {
        self.program.hear(clock::now().as_micros(), frame);
        Ok(())
    }
}
