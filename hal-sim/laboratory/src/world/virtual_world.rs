//! Simulator and robot in one thread on a virtual clock: a day of robot time in minutes, every run repeatable.

use std::sync::Arc;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_runtime::shared::{Shared, StopRecord};
use floorguard_sim::{CanFrame as SimCanFrame, FaultKind, FaultLayer, FaultSpec, FaultTarget};
use floorguard_sim::{Payload, Simulation, Stream, WireEvent};
use floorguard_types::time::Stamp;

use super::floor_camera::SimulatedCamera;
use super::lidar_playback::LidarPlayback;
use super::lines::{Ends, IMU_BAUD, Lines, to_devices};
use super::observer::Observer;
use super::operator::Operator;
use super::outside::spawn_outside;
use super::planning::{begin_mission, spawn_planning};
use super::surveying::judge_survey;
use super::true_state::TrueRecord;
use super::velocity_base::{attend, has_bus};
use crate::plan::Plan;
use floorguard_host::carriers::PipeReader;
use floorguard_host::executor::{TaskSet, advance_virtual, next_timer_us, use_real_clock, use_virtual_clock};
use floorguard_operator::panel::PanelOrder;
use floorguard_operator::telemetry::RunSinks;
use floorguard_robot::assembly::{GuardCarriers, new_perception, new_shared_for, spawn_guard_ring};
use floorguard_robot::cleaner::{MissionPhase, MissionSetup, Store};
use floorguard_robot::learning::{LearningSetup, LearningWriter};
use floorguard_robot::navigator::NavigationSetup;

/// How often truth is compared with what the robot does, microseconds.
const JUDGE_US: u64 = 10_000;

/// The map of seen dirt is reported this often, microseconds.
const SEEN_DIRT_US: u64 = 5_000_000;

/// Plays a plan to its end. The observer sees every moment of 10 ms.
///
/// # Errors
/// The robot cannot be configured, or one of its tasks spins.
pub fn run_virtual(plan: &Plan, observer: &mut Observer<'_>) -> anyhow::Result<()> {
    run_recorded(plan, observer, &mut RunSinks::default())
}

/// The same, with run sinks.
///
/// # Errors
/// As [`run_virtual`].
pub fn run_recorded(plan: &Plan, observer: &mut Observer<'_>, sinks: &mut RunSinks) -> anyhow::Result<()> {
    let mut simulation = plan.simulation()?;
    use_virtual_clock(0);
    let outcome = play(plan, &mut simulation, (observer, sinks));
    use_real_clock();
    outcome
}

/// Everything around the robot's computer; it outlives the computer's lives.
struct World<'a, 'b> {
    simulation: &'a mut Simulation,
    observer: &'a mut Observer<'b>,
    sinks: &'a mut RunSinks,
    faults: FaultLayer,
    /// On the way from the computer to the bus.
    output_faults: FaultLayer,
    operator: Operator,
    lidar: LidarPlayback,
    /// What the robot cleans, with the disk that outlives its computer's lives.
    mission: Option<MissionSetup>,
    /// Where the robot drives.
    navigation: Option<NavigationSetup>,
    camera: Option<SimulatedCamera>,
    /// What is latched, on the disk that outlives the computer's lives.
    latches: u64,
    /// Writes what is learned; the file outlives the computer's lives.
    learned: Option<LearningWriter>,
    /// The map of seen dirt is reported again from here on.
    next_map_us: u64,
    /// What of the true state is recorded.
    truth: TrueRecord,
    judge_us: u64,
    now_us: u64,
    /// The run ends with the mission.
    until_clean: bool,
    /// The plan's duration, or when somebody ended the run.
    end_us: u64,
}

/// Why the computer stopped.
#[derive(PartialEq, Eq)]
enum End {
    OfThePlan,
    PowerLost,
}

fn play(
    plan: &Plan,
    simulation: &mut Simulation,
    (observer, sinks): (&mut Observer<'_>, &mut RunSinks),
) -> anyhow::Result<()> {
    let mut world = World {
        simulation,
        observer,
        sinks,
        faults: FaultLayer::new(&plan.faults, plan.seed),
        output_faults: FaultLayer::for_output(&plan.faults, plan.seed),
        operator: Operator::new(plan.emergency_stop_us.clone()),
        lidar: LidarPlayback::new(plan.lidar.clone()),
        mission: plan
            .mission
            .clone()
            .map(|mission| MissionSetup::new(mission, Store::Memory(Arc::default())))
            .map(|setup| setup.ordered_by(plan.cleaning_orders.clone())),
        navigation: plan
            .navigation
            .clone()
            .map(|drive| NavigationSetup::new(drive).ordered_by(plan.drive_orders.clone())),
        latches: 0,
        camera: plan.has_camera.then(|| SimulatedCamera::new(plan)).flatten(),
        learned: plan.learning.as_ref().map(LearningSetup::writer),
        next_map_us: 0,
        truth: TrueRecord::default(),
        judge_us: 0,
        now_us: 0,
        until_clean: plan.until_clean,
        end_us: plan.duration_us,
    };
    let dead = |at_us| plan.faults.iter().any(|fault| is_reset(fault) && fault.applies(at_us));
    if let Some(setup) = &world.mission {
        world.sinks.set_mission(setup);
    }
    world.observer.begin(plan, world.simulation);
    world.truth = TrueRecord::begin(plan, world.simulation, world.sinks);
    while live(plan, &mut world, dead)? == End::PowerLost {
        let off = plan.faults.iter().filter(|fault| is_reset(fault) && fault.applies(world.now_us));
        let until_us = off.map(|fault| fault.to_us).max().unwrap_or(world.now_us).min(world.end_us);
        world.without_computer(until_us);
    }
    world.observer.finish_mission(world.simulation);
    if let Some(camera) = &world.camera {
        let seen = camera.seen(world.now_us);
        world.sinks.seen_dirt(&seen);
        world.observer.on_seen_dirt(seen);
    }
    if let Some(learned) = world.learned.as_ref().and_then(LearningWriter::report) {
        world.observer.on_learning(learned);
    }
    judge_survey(plan, world.navigation.as_ref(), world.observer);
    world.observer.finish(world.operator.resets());
    if let Some(folder) = world.sinks.pictures.take() {
        folder.finish()?;
    }
    Ok(world.sinks.finish((world.end_us, world.observer.digest().value()))?)
}

fn is_reset(fault: &FaultSpec) -> bool {
    fault.target == FaultTarget::Computer && fault.kind == FaultKind::Reset
}

/// What reports progress, and how often it has.
struct Watches {
    mission: Option<MissionSetup>,
    navigation: Option<NavigationSetup>,
    reported: u32,
    driven: u32,
}

impl Watches {
    fn of(mission: Option<MissionSetup>, navigation: Option<NavigationSetup>) -> Self {
        let reported = mission.as_ref().map_or(0, |setup| setup.watch.published());
        let driven = navigation.as_ref().map_or(0, |setup| setup.watch.published());
        Self { mission, navigation, reported, driven }
    }
}

/// One life of the robot's computer, from power on.
fn live(plan: &Plan, world: &mut World<'_, '_>, dead: impl Fn(u64) -> bool) -> anyhow::Result<End> {
    let now = Stamp::from_micros(world.now_us);
    let shared: Box<Shared<NoopRawMutex>> = new_shared_for(&plan.robot, plan.stages, now)
        .map_err(|error| anyhow::anyhow!("the guard refuses the robot: {error}"))?;
    shared.restore_latches(world.latches, now);
    let mut perception = new_perception(&plan.robot, plan.stages);
    let space = world.navigation.as_ref().map(|navigation| navigation.space.clone());
    perception.motion.show_space_to(space);
    perception.motion.learn(plan.learning.as_ref().map(LearningSetup::again).as_ref());
    let (setup, navigation) = (world.mission.clone(), world.navigation.clone());
    let mut mission = begin_mission(&plan.robot, (&setup, &navigation))?;
    let mut watches = Watches::of(setup, navigation);
    let (lines, Ends { scanner, rear_scanner, imu, from_imu_line }) = Lines::new(plan.robot.scanner.model);
    let (mut tasks, mut orders) = (TaskSet::new(), Vec::new());
    let carriers = GuardCarriers {
        lidar: plan.robot.has_lidar.then(|| lines.lidar.clone()),
        scanner,
        rear_scanner: plan.robot.rear_scanner.map(|_| rear_scanner),
        imu: Some((imu, IMU_BAUD)),
        can: has_bus(plan).then(|| lines.can.clone()),
        tap: None,
    };
    spawn_guard_ring(&mut tasks, &shared, &plan.robot, carriers);
    let (base, guard_tasks) = (spawn_outside(&mut tasks, plan, &shared), tasks.len());
    spawn_planning(&mut tasks, plan, &shared, (&mut perception, mission.as_deref_mut()));
    loop {
        let now_us = world.next_us().min(next_timer_us().unwrap_or(u64::MAX)).max(world.now_us);
        if world.sinks.ended.is_stopped() {
            world.end_us = world.end_us.min(world.now_us); // It still happens: a replay knows moments only.
        }
        if now_us > world.end_us {
            return Ok(End::OfThePlan);
        }
        world.now_us = now_us;
        if dead(now_us) {
            return Ok(End::PowerLost);
        }
        world.advance(&lines);
        advance_virtual(now_us);
        orders.drain(..).for_each(|order| world.sinks.order(order, &shared, now_us));
        let halted = |target| halts(plan, target, now_us);
        let runs =
            |task| !halted(if task < guard_tasks { FaultTarget::Guard } else { FaultTarget::Perception });
        tasks.poll_until_quiet_if(runs)?;
        world.observer.after_tasks(&shared);
        world.take_from_robot(&lines, &from_imu_line);
        world.sinks.after_tasks(&shared, (now_us, world.observer.digest().value()));
        if now_us >= world.judge_us {
            world.judge_us += JUDGE_US;
            attend(base.as_ref(), (world.simulation, now_us));
            orders = world.operate(&shared); // They reach the tasks with the next moment.
            world.latches = shared.latches.get().unwrap_or(world.latches);
            let stops: Vec<StopRecord> = std::iter::from_fn(|| shared.stops.try_pop()).collect();
            stops.iter().for_each(|stop| world.sinks.stop(stop));
            world.tell_news(&shared, &mut watches);
            world.observer.observe(world.simulation, &shared, &stops);
            world.truth.tell(world.now_us, world.simulation, world.sinks);
            world.observe_floor(&shared)?;
            world.keep_learned();
        }
    }
}

/// A fault keeps these tasks from running.
fn halts(plan: &Plan, ring: FaultTarget, now_us: u64) -> bool {
    let concerned = |fault: &&FaultSpec| fault.target == ring || fault.target == FaultTarget::Computer;
    plan.faults.iter().filter(concerned).any(|fault| fault.halts_at(now_us))
}

impl World<'_, '_> {
    fn next_us(&self) -> u64 {
        self.simulation
            .next_event_us()
            .min(self.faults.next_event_us())
            .min(self.output_faults.next_event_us())
            .min(self.judge_us)
            .min(self.lidar.next_us())
    }

    /// What the computer has sent: frames, and requests to the inertial sensor and to the scanner.
    fn take_from_robot(&mut self, lines: &Lines, from_imu_line: &PipeReader) {
        for frame in lines.can.drain() {
            self.observer.on_frame(&frame, self.now_us);
            self.sinks.sent(&frame, self.now_us);
            self.send(to_devices(&frame));
        }
        let (to_imu, to_scanner) = (from_imu_line.drain(), lines.scanner.asked());
        for (stream, bytes) in [(Stream::ImuSerial, to_imu), (Stream::ScannerSerial, to_scanner)] {
            if !bytes.is_empty() {
                self.simulation.receive(stream, &bytes);
            }
        }
    }

    /// The operator's hands, of the plan or at the panel; gives the buttons that were pressed.
    fn operate(&mut self, shared: &Shared<NoopRawMutex>) -> Vec<PanelOrder> {
        let state = shared.decision.get().map(|decision| decision.state).unwrap_or_default();
        let action = self.operator.act(self.now_us, state);
        self.simulation.press_emergency_stop(action.pressed);
        self.observer.on_emergency_stop(action.pressed, self.now_us);
        let mut orders = self.sinks.attend(shared, self.now_us);
        let operated = self.sinks.panel.is_some();
        orders.extend(action.orders(operated).map(PanelOrder::from));
        orders
    }

    /// Plays up to now; what reaches the computer goes into its lines.
    fn advance(&mut self, lines: &Lines) {
        let Self { simulation, faults, output_faults, sinks, now_us, lidar, .. } = self;
        let now_us = *now_us;
        output_faults.release(now_us, &mut |event| hear(simulation, event, now_us));
        simulation.advance_to(now_us, &mut |event| {
            if !lidar.replaces(&event) {
                faults.pass(event, &mut |event| lines.deliver(event, now_us, sinks));
            }
        });
        lidar.release(now_us, &mut |event| {
            faults.pass(event, &mut |event| lines.deliver(event, now_us, sinks));
        });
        faults.release(now_us, &mut |event| lines.deliver(event, now_us, sinks));
    }

    /// Mission and drive have reported something new.
    fn tell_news(&mut self, shared: &Shared<NoopRawMutex>, watches: &mut Watches) {
        let reported = watches.mission.as_ref().map_or(0, |setup| setup.watch.published());
        let driven = watches.navigation.as_ref().map_or(0, |setup| setup.watch.published());
        let before = (watches.reported, watches.driven);
        (watches.reported, watches.driven) = (reported, driven);
        if let Some(setup) = watches.mission.as_ref().filter(|_| reported != before.0) {
            self.tell(shared, setup);
        }
        if let Some(setup) = watches.navigation.as_ref().filter(|_| driven != before.1) {
            self.tell_drive(setup);
        }
    }

    /// The mission has reported its progress.
    fn tell(&mut self, shared: &Shared<NoopRawMutex>, setup: &MissionSetup) {
        let (Some(progress), Some(pose)) = (setup.watch.get(), shared.pose.get()) else { return };
        self.observer.on_mission(&progress, (self.simulation, pose.pose_in_odometry));
        self.sinks.mission(&progress);
        if self.until_clean && progress.phase == MissionPhase::Done {
            self.sinks.ended.stop();
        }
    }

    /// The drive to a goal has reported its progress.
    fn tell_drive(&mut self, setup: &NavigationSetup) {
        let Some(progress) = setup.watch.get() else { return };
        self.observer.on_navigation(&progress);
        self.sinks.navigation(&progress);
        if progress.phase.is_over() && setup.ends_run() {
            self.sinks.ended.stop();
        }
    }

    /// What was learned goes into its file.
    fn keep_learned(&mut self) {
        if let Some(update) = self.learned.as_mut().and_then(LearningWriter::attend) {
            say!("  {:.0} s: {update}", self.now_us as f64 * 1.0e-6);
        }
    }

    /// The floor camera, if there is one; its map goes to the run sinks now and then.
    fn observe_floor(&mut self, shared: &Shared<NoopRawMutex>) -> anyhow::Result<()> {
        let Some(camera) = &mut self.camera else { return Ok(()) };
        let folder = self.sinks.pictures.as_mut();
        let is_new = camera.attend(self.simulation, shared, (self.now_us, folder))?;
        if let Some(picture) = camera.take_picture() {
            self.sinks.camera_picture(&picture);
        }
        if is_new && self.now_us >= self.next_map_us {
            self.next_map_us = self.now_us + SEEN_DIRT_US;
            if self.sinks.listen() {
                self.sinks.seen_dirt(&camera.seen(self.now_us));
            }
        }
        Ok(())
    }

    /// A frame of the computer on its way to the bus.
    fn send(&mut self, frame: SimCanFrame) {
        let Self { simulation, output_faults, now_us, .. } = self;
        let now_us = *now_us;
        let event = WireEvent { at_us: now_us, stream: Stream::Can, payload: Payload::Frame(frame) };
        output_faults.pass(event, &mut |event| hear(simulation, event, now_us));
    }

    /// The computer is off: no input and no output, and the judge goes on.
    fn without_computer(&mut self, until_us: u64) {
        while self.now_us < until_us {
            self.now_us = self.next_us().clamp(self.now_us, until_us);
            let now_us = self.now_us;
            let Self { simulation, faults, output_faults, .. } = self;
            output_faults.release(now_us, &mut |event| hear(simulation, event, now_us));
            simulation.advance_to(now_us, &mut |event| faults.pass(event, &mut |_| {}));
            faults.release(now_us, &mut |_| {});
            advance_virtual(now_us);
            if now_us >= self.judge_us {
                self.judge_us += JUDGE_US;
                self.observer.observe_without_computer(self.simulation);
            }
        }
    }
}

/// The devices hear a frame.
fn hear(simulation: &mut Simulation, event: WireEvent, now_us: u64) {
    if let Payload::Frame(frame) = event.payload {
        simulation.receive_can(frame, now_us);
    }
}
