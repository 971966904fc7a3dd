//! The task that lets a program outside drive the robot.

use std::io;

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_configuration::CommandConfiguration;
use floorguard_drivers::velocity_link::AcceptanceRules;
use floorguard_host::carriers::BoundCommand;
use floorguard_host::executor::{StopFlag, TaskSet};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::io::FramePort;
use floorguard_runtime::shared::Shared;
use floorguard_runtime::tasks::{VelocityRules, velocity_input};

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

/// The same on what `[command]` names. Nothing is heard any more once `closed` is stopped.
pub(super) fn spawn_bound_command<'a, M: RawMutex>(
    tasks: &mut TaskSet<'a>,
    (shared, robot): (&'a Shared<M>, &RobotConfiguration),
    (command, closed): (BoundCommand, StopFlag),
) -> io::Result<()> {
    let rules = velocity_rules(robot, command.configuration());
    let (link, problem) = command.open(closed)?;
    if let Some(error) = problem {
        say!("  command line: not there yet ({error}); waiting for it, the robot stands until then");
    }
    spawn_commanded(tasks, shared, (link, rules));
    Ok(())
}
