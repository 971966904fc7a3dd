//! Two threads, one for each ring, and an orderly end: first the mission ends, the robot stops, then the guard ends.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Context;
use floorguard_runtime::clock;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::shared::Shared;
use floorguard_types::time::Stamp;

use floorguard_runtime::tasks::{Mission, drive_mission, perceive};

use super::commanded::{FrameLinks, spawn_frame_links};
use super::guard_task::GuardTask;
use super::links::{Links, Missing};
use super::tap::{Poll, Tap};
use crate::assembly::{PeopleInbox, Stages, new_perception, spawn_guard_ring, spawn_perception_ring};
use crate::learning::LearningSetup;
use crate::navigator::SpaceInbox;
use crate::ordered::OrderedWork;
use floorguard_host::executor::{
    PollObserver, PriorityLock, Ring, RingObserver, StopFlag, run_until, run_until_observed, take_priority,
};

/// What both threads share: each slot behind a lock of its own, which lends the holder the priority of who waits.
pub type HostedShared = Shared<PriorityLock>;

/// The guard's tables are built on the stack before they are placed.
const STACK_BYTES: usize = 16 * 1024 * 1024;
/// The longest wait for the robot to stand at the end: response and braking from full speed, twice.
const STANDS_WITHIN: Duration = Duration::from_secs(3);
/// Slower counts as standing, m/s.
const STANDING_MPS: f32 = 0.01;

/// Runs both rings while `beside` runs on the calling thread. When it returns, the robot is brought to a stand, the
/// rings end, and what it returned is given back. When a ring fails, `flag` is stopped: `beside` should look at it.
///
/// # Errors
/// A ring could not start, or failed.
pub fn run_rings<T>(
    (robot, mut links): (&RobotConfiguration, Links),
    shared: &HostedShared,
    flag: &StopFlag,
    beside: impl FnOnce() -> T,
) -> anyhow::Result<T> {
    let (guard_flag, perception_flag) = (StopFlag::default(), StopFlag::default());
    let space = links.navigation.as_ref().map(|navigation| navigation.space.clone());
    let mission = mission_of(robot, &mut links)?;
    let heard = (links.people.clone(), space, links.learning.take());
    // Where a program outside drives, the robot itself asks for nothing.
    let drives_route = mission.is_none() && links.command.is_none();
    let command_flag = StopFlag::default();
    let latches = links.latches.take();
    if let Some(latches) = &latches {
        let (kept, now) = (latches.read(), clock::now());
        if let Some(tap) = &links.tap {
            tap.latched(now, kept);
        }
        shared.restore_latches(kept, now);
    }
    let latches_flag = StopFlag::default();
    thread::scope(|scope| {
        let kept = latches.as_ref().map(|latches| {
            let keep = || {
                let _ = take_priority(Ring::Telemetry);
                latches.keep(shared, &latches_flag);
            };
            thread::Builder::new().name("latches".to_owned()).spawn_scoped(scope, keep)
        });
        let kept = kept.transpose()?;
        // Also when a ring cannot start: the scope waits for all its threads.
        let at_end = StopsAtEnd(latches_flag.clone());
        let guard =
            start(scope, "guard", flag, || guard_ring((robot, links), shared, (&guard_flag, &command_flag)))?;
        let perception = start(scope, "perception", flag, || {
            perception_ring((robot, drives_route, heard), shared, &perception_flag)
        })?;
        let mission = mission
            .map(|mission| start(scope, "mission", flag, || mission_ring(mission, shared, &perception_flag)))
            .transpose()?;
        // Whatever becomes of the display: nobody but this thread ends the rings.
        let answer = catch_unwind(AssertUnwindSafe(beside));
        perception_flag.stop();
        command_flag.stop();
        let seen = perception.join();
        let cleaned = mission.map_or(Ok(Ok(())), thread::ScopedJoinHandle::join);
        await_stand(shared, &guard);
        guard_flag.stop();
        finished(guard.join(), "guard")?;
        finished(seen, "perception")?;
        finished(cleaned, "mission")?;
        drop(at_end);
        finished(kept.map_or(Ok(Ok(())), |kept| kept.join().map(Ok)), "latches")?;
        Ok(answer.unwrap_or_else(|panic| resume_unwind(panic)))
    })
}

/// Stops a flag when it goes out of scope, in a panic too.
pub struct StopsAtEnd(pub StopFlag);

impl Drop for StopsAtEnd {
    fn drop(&mut self) {
        self.0.stop();
    }
}

/// A ring's thread. However it ends, the others hear of it.
fn start<'scope>(
    scope: &'scope thread::Scope<'scope, '_>,
    name: &str,
    flag: &StopFlag,
    ring: impl FnOnce() -> io::Result<()> + Send + 'scope,
) -> io::Result<thread::ScopedJoinHandle<'scope, io::Result<()>>> {
    let at_end = StopsAtEnd(flag.clone());
    let run = move || {
        let _at_end = at_end;
        ring()
    };
    thread::Builder::new().name(name.to_owned()).stack_size(STACK_BYTES).spawn_scoped(scope, run)
}

fn guard_ring(
    (robot, mut links): (&RobotConfiguration, Links),
    shared: &HostedShared,
    (flag, command_flag): (&StopFlag, &StopFlag),
) -> io::Result<()> {
    say!("  {}", take_priority(Ring::Guard));
    let lateness = links.lateness.clone();
    run_until_observed(flag, |tasks| {
        let frame_links = FrameLinks { command: links.command.take(), base: links.base.take() };
        let carriers = links.open(&mut |Missing { source, why }| {
            say!("  {source}: not there yet ({why}); waiting for it, the robot stands until then");
        })?;
        let (tap, lateness) = (carriers.tap.clone(), lateness.clone());
        let names = spawn_guard_ring(tasks, shared, robot, carriers);
        // Behind the tasks of the guard: what it asks for reaches the recording as the guard takes it.
        spawn_frame_links(tasks, (shared, robot), frame_links, command_flag.clone())?;
        Ok(RingObserver { polls: tap.map(|tap| observer(tap, names, shared)), lateness: Some(lateness) })
    })
}

/// Reports each poll and what was decided in it.
fn observer(tap: Tap, names: Vec<GuardTask>, shared: &HostedShared) -> PollObserver<'_> {
    let mut published = shared.decision.published();
    Box::new(move |index, now_us| {
        let Some(task) = names.get(index).copied() else { return };
        let now = shared.decision.published();
        let decisions = now.wrapping_sub(std::mem::replace(&mut published, now));
        let decision = if decisions > 0 { shared.decision.get() } else { None };
        tap.polled(Poll { task, at: Stamp::from_micros(now_us), decisions, decision });
    })
}

fn perception_ring(
    (robot, drives_route, (inbox, space, learning)): (
        &RobotConfiguration,
        bool,
        (PeopleInbox, Option<SpaceInbox>, Option<LearningSetup>),
    ),
    shared: &HostedShared,
    flag: &StopFlag,
) -> io::Result<()> {
    say!("  {}", take_priority(Ring::Perception));
    let mut state = new_perception(robot, Stages::All);
    state.motion.listen_to(inbox);
    state.motion.show_space_to(space);
    state.motion.learn(learning.as_ref());
    run_until(flag, |tasks| {
        if drives_route {
            spawn_perception_ring(tasks, shared, robot, &mut state);
        } else {
            tasks.spawn(perceive(shared, &mut state));
        }
        Ok(())
    })
}

/// What plans on a thread of its own: a goal comes before cleaning, unless both are ordered from outside; without both the robot drives
/// its route.
fn mission_of(
    robot: &RobotConfiguration,
    links: &mut Links,
) -> anyhow::Result<Option<Box<dyn Mission + Send>>> {
    let cleaning = links.mission.take();
    if let Some(drive) = links.navigation.take() {
        return Ok(Some(match cleaning.filter(|cleaning| OrderedWork::is_meant(&drive, cleaning)) {
            Some(cleaning) => Box::new(OrderedWork::new((&drive, &cleaning), robot)?),
            None => Box::new(drive.begin(robot)?),
        }));
    }
    let Some(setup) = cleaning else { return Ok(None) };
    Ok(Some(Box::new(setup.begin_queue(robot)?)))
}

/// A thread of its own: planning takes longer than people may wait to be seen.
fn mission_ring(
    mut mission: Box<dyn Mission + Send>,
    shared: &HostedShared,
    flag: &StopFlag,
) -> io::Result<()> {
    say!("  {}", take_priority(Ring::Mission));
    run_until(flag, |tasks| {
        tasks.spawn(drive_mission(shared, &mut *mission));
        Ok(())
    })
}

/// Without a mission the wanted command grows old and the guard stops the robot; the drives then hear it stand.
fn await_stand(shared: &HostedShared, guard: &thread::ScopedJoinHandle<'_, io::Result<()>>) {
    let began = Instant::now();
    while began.elapsed() < STANDS_WITHIN && !guard.is_finished() {
        let held = shared.decision.get().is_none_or(|decision| decision.action.stops());
        let stands = shared.pose.get().is_none_or(|pose| pose.twist.linear_mps.abs() < STANDING_MPS);
        if held && stands {
            break;
        }
        thread::sleep(Duration::from_millis(20));
    }
}

fn finished(outcome: thread::Result<io::Result<()>>, ring: &str) -> anyhow::Result<()> {
    outcome
        .map_err(|_| anyhow::anyhow!("the {ring} ring panicked; this is a defect, please report it"))?
        .with_context(|| format!("the {ring} ring failed"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::new_shared;
    use floorguard_configuration::{EXAMPLE, parse};
    use floorguard_types::geometry::Twist2;
    use std::sync::mpsc::channel;

    /// A thread that holds one slot, or the guard, holds up nobody at the others.
    #[test]
    fn slots_do_not_wait_for_each_other() {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let shared: Box<HostedShared> = new_shared(&robot, Stamp::ZERO).unwrap();
        let (published, outcome) = channel();
        let finished = thread::scope(|scope| {
            shared.inspect(|_| {
                scope.spawn(|| {
                    shared.wanted.publish((Stamp::ZERO, Twist2::ZERO));
                    shared.packets.push(|_| ());
                    shared.reset.signal(());
                    published.send(()).unwrap();
                });
                outcome.recv_timeout(Duration::from_secs(20)).is_ok()
            })
        });
        assert!(finished, "waits for the guard's lock");
    }
}
