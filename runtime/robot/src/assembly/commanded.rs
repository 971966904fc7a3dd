//! The tasks that speak in frames: a program outside that drives the robot, and a base that takes velocities.

use std::io;

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_configuration::CommandConfiguration;
use floorguard_drivers::velocity_link::AcceptanceRules;
use floorguard_host::carriers::{BoundFrames, FrameLink};
use floorguard_host::executor::{StopFlag, TaskSet};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::io::FramePort;
use floorguard_runtime::shared::Shared;
use floorguard_runtime::tasks::{VelocityRules, velocity_base, velocity_input};

/// Milliseconds of a second.
const SECOND_MS: u64 = 1_000;

/// What the robot's file says of requests from outside: none holds for longer than the guard believes a command.
#[must_use]
pub fn velocity_rules(robot: &RobotConfiguration, command: &CommandConfiguration) -> VelocityRules {
    VelocityRules {
        acceptance: AcceptanceRules {
            sender: command.sender_id,
            deadline_max_us: robot.deadlines.command_us,
        },
        period_ms: SECOND_MS / u64::from(command.permits_hz.max(1)),
    }
}

/// The task on any port. It belongs to the guard ring, behind all tasks of the guard.
pub fn spawn_commanded<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    shared: &'a Shared<M>,
    (port, rules): (impl FramePort + 'a, VelocityRules),
) {
    tasks.spawn(velocity_input(shared, port, rules));
}

/// The same on what `[command]` names, and the task of the base on what `[base]` names. Nothing is heard of the command any more
/// once `closed` is stopped.
pub(super) fn spawn_frame_links<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    (shared, robot): (&'a Shared<M>, &RobotConfiguration),
    links: FrameLinks,
    closed: StopFlag,
) -> io::Result<()> {
    if let Some((command, configuration)) = links.command {
        let rules = velocity_rules(robot, &configuration);
        let port = open(command, "command line", closed)?;
        spawn_commanded(tasks, shared, (port, rules));
    }
    if let Some(base) = links.base {
        let port = open(base, "base", StopFlag::default())?;
        spawn_velocity_base(tasks, shared, (port, robot));
    }
    Ok(())
}

/// What is spoken in frames, before the guard's thread opens it.
#[derive(Debug)]
pub(super) struct FrameLinks {
    /// `[command]`.
    pub command: Option<(BoundFrames, CommandConfiguration)>,
    /// `[base]`.
    pub base: Option<BoundFrames>,
}

/// The task of a base that takes velocities, on any port. It belongs to the guard ring.
pub fn spawn_velocity_base<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    shared: &'a Shared<M>,
    (port, robot): (impl FramePort + 'a, &RobotConfiguration),
) {
    tasks.spawn(velocity_base(shared, port, robot.geometry.wheelbase_m));
}

fn open(bound: BoundFrames, name: &str, closed: StopFlag) -> io::Result<FrameLink> {
    let (link, problem) = bound.open(closed)?;
    if let Some(error) = problem {
        say!("  {name}: not there yet ({error}); waiting for it, the robot stands until then");
    }
    Ok(link)
}
