//! Simulator on one thread, robot on two, and between them what a real robot has: UDP over the loopback, serial lines
//! and an SLCAN adapter as pseudo-terminals. Nothing repeats bit for bit here; the verdict must be the same all the same.

use floorguard_mapping::sliding_window::{CellContent, WindowPoint};
use floorguard_runtime::clock;
use floorguard_runtime::shared::StopRecord;
use floorguard_sim::FaultLayer;
use floorguard_sim::Simulation;
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::time::Stamp;

use super::actuated_end::ActuatedEnd;
use super::ends::Ends;
use super::lines::to_robot;
use super::observer::Observer;
use super::operator::Operator;
use crate::plan::Plan;
use floorguard_host::executor::{LatenessFigures, Ring, StopFlag, take_priority};
use floorguard_operator::telemetry::RunSinks;
use floorguard_operator::telemetry::{TelemetrySender, with_telemetry};
use floorguard_robot::actuated::{WindowReport, WindowWatch, watch_window};
use floorguard_robot::assembly::new_shared;
use floorguard_robot::assembly::{HostedShared, run_rings};
use floorguard_robot::cleaner::{MissionPhase, MissionSetup, Store};
use floorguard_robot::learning::{LearningSetup, LearningWriter};

/// How often truth is compared with what the robot does, microseconds.
const JUDGE_US: u64 = 10_000;
/// What the real carriers did to the run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarrierFigures {
    /// The simulator was behind the clock by at most this, microseconds.
    pub latest_us: u64,
    /// Bytes and datagrams that a full line refused.
    pub refused: u64,
    /// How late the guard ring answered its timers.
    pub guard: LatenessFigures,
    /// The window around the robot at the end, of a robot with a lidar that a motor turns.
    pub window: Option<WindowReport>,
    /// Its surfaces in odometry, metres.
    pub surfaces: Vec<Point3>,
}

/// Plays a plan in real time over real carriers. The CAN bus is an interface of the kernel, if one is named, otherwise an
/// SLCAN adapter.
///
/// # Errors
/// A carrier could not be opened, or a ring failed.
pub fn run_real(
    plan: &Plan,
    can_interface: Option<&str>,
    observer: &mut Observer<'_>,
) -> anyhow::Result<CarrierFigures> {
    run_real_recorded((plan, can_interface), observer, &mut RunSinks::default())
}

/// The same, with a recording or a panel.
///
/// # Errors
/// As [`run_real`]; and the recording could not be written.
pub fn run_real_recorded(
    (plan, can_interface): (&Plan, Option<&str>),
    observer: &mut Observer<'_>,
    sinks: &mut RunSinks,
) -> anyhow::Result<CarrierFigures> {
    let mut simulation = plan.simulation()?;
    let (mut ends, links) = Ends::open(&plan.robot, can_interface)?;
    let mut links = links.commanded(plan.command.as_ref())?;
    if let Some(address) = links.command.as_ref().and_then(|(command, _)| command.local_address()) {
        say!("  waits for velocities at udp:{address}");
    }
    let (actuated, window_links) = ActuatedEnd::open(plan)?.unzip();
    let window = WindowWatch::default();
    let start = clock::now();
    observer.set_clock_start(start);
    if let Some(panel) = &mut sinks.panel {
        panel.set_clock_start(start);
    }
    let operated = sinks.panel.is_some();
    let shared: Box<HostedShared> = new_shared(&plan.robot, start)
        .map_err(|error| anyhow::anyhow!("the guard refuses the robot: {error}"))?;
    let flag = StopFlag::default();
    let mission = plan.mission.clone().map(|mission| MissionSetup::new(mission, Store::None));
    if let Some(setup) = &mission {
        sinks.set_mission(setup);
    }
    observer.begin(plan, &simulation);
    say!("  {}", take_priority(Ring::World));
    let ended = sinks.ended.clone();
    with_telemetry(sinks, &shared, |tap, notes| {
        links.tap = tap.inspect(|tap| tap.began(start));
        links.mission.clone_from(&mission);
        links.learning.clone_from(&plan.learning);
        let mut world = World {
            plan,
            start,
            operated,
            simulation: &mut simulation,
            ends: &mut ends,
            actuated,
            ended,
            mission: mission.clone(),
            learned: plan.learning.as_ref().map(LearningSetup::writer),
        };
        let (lateness, inbox) = (links.lateness.clone(), links.people.clone());
        let figures = run_rings((&plan.robot, links), &shared, &flag, || {
            watch_window(window_links, (&shared, &inbox), &window, || {
                world.play((&shared, &flag, notes), observer)
            })
        })??;
        Ok(CarrierFigures {
            guard: lateness.figures(),
            window: window.report(),
            surfaces: surfaces(&window),
            ..figures
        })
    })
}

fn surfaces(window: &WindowWatch) -> Vec<Point3> {
    let Some(map) = window.take_map() else { return Vec::new() };
    let frame = map.window.frame_in_odometry();
    let place = |one: WindowPoint| {
        let flat = frame.transform(Point2::new(one.point.x_m, one.point.y_m));
        Point3::new(flat.x_m, flat.y_m, one.point.z_m)
    };
    map.window.points().filter(|one| one.content == CellContent::Surface).map(place).collect()
}

/// The mission has reported its progress.
fn tell(
    (observer, notes): (&mut Observer<'_>, &TelemetrySender<'_>),
    (simulation, shared): (&Simulation, &HostedShared),
    setup: &MissionSetup,
) {
    if let (Some(progress), Some(pose)) = (setup.watch.get(), shared.pose.get()) {
        observer.on_mission(&progress, (simulation, pose.pose_in_odometry));
        notes.mission(&progress);
    }
}

/// The simulated surroundings of the robot.
struct World<'a> {
    plan: &'a Plan,
    start: Stamp,
    /// Somebody at the panel presses reset; the plan's operator does not.
    operated: bool,
    /// Somebody wants the run to end.
    ended: StopFlag,
    /// What the robot cleans.
    mission: Option<MissionSetup>,
    /// Writes what is learned.
    learned: Option<LearningWriter>,
    simulation: &'a mut Simulation,
    ends: &'a mut Ends,
    actuated: Option<ActuatedEnd>,
}

impl World<'_> {
    fn play(
        &mut self,
        (shared, flag, notes): (&HostedShared, &StopFlag, &TelemetrySender<'_>),
        observer: &mut Observer<'_>,
    ) -> anyhow::Result<CarrierFigures> {
        let Self { plan, start, operated, ended, mission, learned, simulation, ends, actuated } = self;
        let mut reported = 0;
        let mut faults = FaultLayer::new(&plan.faults, plan.seed);
        let mut operator = Operator::new(plan.emergency_stop_us.clone());
        let mut judge_us = 0;
        let mut latest_us = 0;
        let clock_us = || clock::now().as_micros().saturating_sub(start.as_micros());
        while !flag.is_stopped() {
            let now_us = clock_us();
            if now_us > plan.duration_us || ended.is_stopped() {
                break;
            }
            // Truth is examined every 10 ms of the world's time, however late this thread is.
            let to_us = now_us.min(judge_us);
            latest_us = latest_us.max(now_us - to_us);
            simulation.advance_to(to_us, &mut |event| faults.pass(event, &mut |event| ends.deliver(event)));
            faults.release(to_us, &mut |event| ends.deliver(event));
            let (frames, written) = ends.receive();
            for frame in frames {
                observer.on_frame(&to_robot(&frame), to_us);
                simulation.receive_can(frame, to_us);
            }
            for (stream, bytes) in written {
                simulation.receive(stream, &bytes);
            }
            actuated.iter_mut().for_each(|actuated| actuated.play(simulation, to_us));
            observer.after_tasks(shared);
            if to_us >= judge_us {
                judge_us += JUDGE_US;
                let state = shared.decision.get().map(|decision| decision.state).unwrap_or_default();
                let action = operator.act(to_us, state);
                simulation.press_emergency_stop(action.pressed);
                observer.on_emergency_stop(action.pressed, to_us);
                action.orders(*operated).into_iter().for_each(|order| notes.order(order));
                let stops: Vec<StopRecord> = std::iter::from_fn(|| shared.stops.try_pop()).collect();
                stops.iter().for_each(|stop| notes.stop(stop));
                observer.observe(simulation, shared, &stops);
                if let Some(update) = learned.as_mut().and_then(LearningWriter::attend) {
                    say!("  {update}");
                }
                if let Some(setup) = mission.as_ref().filter(|setup| setup.watch.published() != reported) {
                    reported = setup.watch.published();
                    tell((observer, notes), (simulation, shared), setup);
                    if plan.until_clean
                        && setup.watch.get().is_some_and(|reported| reported.phase == MissionPhase::Done)
                    {
                        ended.stop();
                    }
                }
            }
            let due_us = simulation.next_event_us().min(faults.next_event_us()).min(judge_us);
            ends.wait(due_us.saturating_sub(clock_us()))?;
        }
        observer.finish_mission(simulation);
        if let Some(report) = learned.as_ref().and_then(LearningWriter::report) {
            observer.on_learning(report);
        }
        observer.finish(operator.resets());
        let refused = ends.refused + actuated.as_ref().map_or(0, |actuated| actuated.refused);
        Ok(CarrierFigures { latest_us, refused, ..CarrierFigures::default() })
    }
}
