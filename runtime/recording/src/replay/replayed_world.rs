//! A recorded run once more: the raw bytes of the recording through the same tasks on the virtual clock. Same bytes at
//! the same moments give the same bits.

use std::io::Read;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_runtime::configuration::{BaseKind, RobotConfiguration};
use floorguard_runtime::digest::OutputDigest;
use floorguard_runtime::shared::Shared;
use floorguard_runtime::tape::{TapeLine, decode_route, frame_of};
use floorguard_runtime::tasks::Mission;
use floorguard_types::time::Stamp;

use super::audience::{ReplayAudience, ReplayError, ReplayOutcome};
use super::delivery::delivery;
use super::ordered_world::{OrderedRun, play_ordered};
use super::scanner_pipe::ScannerPipe;
use crate::order::{ORDER, ORDER_VERSION};
use crate::{END_METADATA, RUN_METADATA, RawStream, Recorded, Recording, octets_of, topics};
use floorguard_configuration::{HostedConfiguration, RecordedConfiguration, parse_recorded};
use floorguard_host::carriers::{CanPipe, DatagramPipe, DuplexPipe, PipeReader, PipeWriter, byte_pipe};
use floorguard_host::executor::{TaskSet, advance_virtual, next_timer_us, use_real_clock, use_virtual_clock};
use floorguard_robot::assembly::{
    GuardCarriers, Stages, new_perception, new_shared_for, spawn_guard_ring, spawn_mission_ring,
    spawn_perception_ring,
};
use floorguard_robot::cleaner::{MissionOrder, MissionOrders, MissionPlan, MissionSetup, Store};
use floorguard_robot::learning::LearningSetup;
use floorguard_robot::navigator::{NavigationPlan, NavigationSetup, SpaceInbox};

/// Name of the text that says whether the raw bytes alone tell the whole run.
pub const REPEATABLE: &str = "repeatable";
/// Name of the text that holds what the robot had learned before.
pub const LEARNED: &str = "learned_before";
/// Name of the text that holds the cleaning mission.
pub const MISSION: &str = "mission";
/// Name of the text with the drive to a goal.
pub const NAVIGATION: &str = "navigation";
/// Bit rate of the inertial sensor where a recording names none.
pub const IMU_BAUD: u32 = 115_200;

struct Lines {
    lidar: DatagramPipe,
    scanner: ScannerPipe,
    rear_scanner: PipeWriter,
    imu: PipeWriter,
    can: CanPipe,
    from_imu_line: PipeReader,
}

struct Stage<'a> {
    shared: &'a Shared<NoopRawMutex>,
    orders: MissionOrders,
    lines: Lines,
    tasks: TaskSet<'a>,
    digest: OutputDigest,
    learns: bool,
    seen: (u32, u32),
    now_us: u64,
}

/// Whether a recording says that it can be replayed: give it the recording after its first message.
pub fn is_replayable<R: Read>(recording: &Recording<R>) -> bool {
    recording.metadata(RUN_METADATA).is_some_and(|texts| texts.contains_key("robot.toml"))
}

/// Replays a recording whose first message has been read already.
///
/// # Errors
/// [`ReplayError`]. A cut recording is played up to the cut.
pub fn replay_recording<R: Read>(
    first: Recorded,
    recording: &mut Recording<R>,
    audience: &mut dyn ReplayAudience,
) -> Result<ReplayOutcome, ReplayError> {
    let texts = recording.metadata(RUN_METADATA).ok_or(ReplayError::NotOurs)?;
    let text = texts.get("robot.toml").ok_or(ReplayError::NotOurs)?;
    let RecordedConfiguration { configuration: read, findings } =
        parse_recorded("robot.toml", text).map_err(|refused| ReplayError::Robot(refused.to_string()))?;
    let findings = findings.map(|findings| findings.to_string());
    let learning = learning_of(&read, texts)?;
    let mut robot = read.robot;
    let baud = texts.get("imu_baud").and_then(|text| text.parse().ok()).unwrap_or(IMU_BAUD);
    let route = (first.topic.as_ref() == RawStream::Route.topic()).then(|| octets_of(&first.data)).flatten();
    (robot.route, robot.route_limits) = route
        .and_then(decode_route)
        .ok_or_else(|| ReplayError::Robot("the recording does not begin with its route".to_owned()))?;
    let stages = texts.get("stages").map_or(Stages::All, |text| Stages::named(text));
    let unrepeatable = texts.get(REPEATABLE).filter(|text| *text != "yes").map(|text| {
        let reason = text.strip_prefix("no: ").unwrap_or("faults of the computer itself were recorded");
        reason.to_owned()
    });
    if texts.get(ORDER).is_some_and(|version| version == ORDER_VERSION) {
        let run = OrderedRun { robot: &robot, stages, learning: learning.as_ref(), imu_baud: baud };
        let outcome = play_ordered(run, recording, audience);
        let learned = learning.and_then(|learning| learning.slot.newest()).map(|(report, _)| report);
        return outcome.map(|outcome| ReplayOutcome { learned, findings, ..outcome });
    }
    use_virtual_clock(0);
    let mission = mission_of(texts, &robot)?;
    let outcome = play((&robot, stages, (mission, learning)), baud, (recording, audience));
    use_real_clock();
    let outcome = ReplayOutcome { findings, ..outcome? };
    if unrepeatable.is_none() {
        return Ok(outcome);
    }
    Ok(ReplayOutcome { unrepeatable, recorded_digest: None, first_difference: None, compared: 0, ..outcome })
}

/// A robot that learned begins with what it had learned before, and its file stays as it is.
fn learning_of(
    read: &HostedConfiguration,
    texts: &std::collections::BTreeMap<String, String>,
) -> Result<Option<LearningSetup>, ReplayError> {
    let Some(learning) = read.learning.as_ref().filter(|learning| learning.enabled) else { return Ok(None) };
    let setup = match texts.get(LEARNED) {
        Some(text) => LearningSetup::of_recording(learning.update_us, text),
        None => Ok(LearningSetup::from_nothing(learning.update_us)),
    };
    setup.map(Some).map_err(|error| ReplayError::Robot(format!("what it had learned before: {error:#}")))
}

/// What plans in a run, none: the route; and where the operator's orders to it go.
#[derive(Default)]
struct Planner {
    mission: Option<Box<dyn Mission>>,
    space: Option<SpaceInbox>,
    orders: MissionOrders,
}

/// What planned in the recorded run, from its beginning: a drive to a goal, or cleaning.
fn mission_of(
    texts: &std::collections::BTreeMap<String, String>,
    robot: &RobotConfiguration,
) -> Result<Planner, ReplayError> {
    if let Some(text) = texts.get(NAVIGATION) {
        let wrong = |error: anyhow::Error| ReplayError::Robot(format!("its drive to a goal: {error:#}"));
        let setup = NavigationSetup::new(NavigationPlan::from_text(text).map_err(wrong)?);
        let mission = Some(Box::new(setup.begin(robot).map_err(wrong)?) as Box<dyn Mission>);
        return Ok(Planner { mission, space: Some(setup.space), ..Planner::default() });
    }
    let Some(text) = texts.get(MISSION) else { return Ok(Planner::default()) };
    let wrong = |error: anyhow::Error| ReplayError::Robot(format!("its mission: {error:#}"));
    let setup = MissionSetup::new(MissionPlan::from_text(text).map_err(wrong)?, Store::None);
    let mission = Some(Box::new(setup.begin_queue(robot).map_err(wrong)?) as Box<dyn Mission>);
    Ok(Planner { mission, space: None, orders: setup.orders })
}

fn play<R: Read>(
    (robot, stages, (mut planner, learning)): (&RobotConfiguration, Stages, (Planner, Option<LearningSetup>)),
    baud: u32,
    (recording, audience): (&mut Recording<R>, &mut dyn ReplayAudience),
) -> Result<ReplayOutcome, ReplayError> {
    let shared = new_shared_for(robot, stages, Stamp::ZERO)
        .map_err(|error| ReplayError::Robot(format!("the guard refuses the robot: {error}")))?;
    let mut perception = new_perception(robot, stages);
    perception.motion.show_space_to(planner.space.take());
    perception.motion.learn(learning.as_ref());
    let (scanner, scanner_reader) = ScannerPipe::new(robot.scanner.model);
    let (rear_scanner, rear_reader) = byte_pipe();
    let (imu, imu_reader) = byte_pipe();
    let (to_imu, from_imu_line) = byte_pipe();
    let (lidar, can) = (DatagramPipe::default(), CanPipe::default());
    let lines = Lines { lidar, scanner, rear_scanner, imu, can, from_imu_line };
    let mut tasks = TaskSet::new();
    let carriers = GuardCarriers {
        lidar: robot.has_lidar.then(|| lines.lidar.clone()),
        scanner: scanner_reader,
        rear_scanner: robot.rear_scanner.map(|_| rear_reader),
        imu: Some((DuplexPipe { reader: imu_reader, writer: to_imu }, baud)),
        can: (robot.base == BaseKind::CanBus).then(|| lines.can.clone()),
        tap: None,
    };
    spawn_guard_ring(&mut tasks, &shared, robot, carriers);
    match planner.mission.as_deref_mut() {
        Some(mission) => spawn_mission_ring(&mut tasks, &shared, (&mut perception, mission)),
        None => spawn_perception_ring(&mut tasks, &shared, robot, &mut perception),
    }
    let mut stage = Stage {
        shared: &shared,
        orders: planner.orders,
        lines,
        tasks,
        digest: OutputDigest::default(),
        learns: learning.is_some(),
        seen: (0, 0),
        now_us: 0,
    };
    let outcome = stage.run(recording, audience)?;
    let learned = learning.and_then(|learning| learning.slot.newest()).map(|(report, _)| report);
    Ok(ReplayOutcome { learned, ..outcome })
}

impl Stage<'_> {
    fn run<R: Read>(
        &mut self,
        recording: &mut Recording<R>,
        audience: &mut dyn ReplayAudience,
    ) -> Result<ReplayOutcome, ReplayError> {
        let mut outcome = ReplayOutcome::default();
        // The first moment has no delivery: the tasks arm their timers. Deliveries at one moment go in together.
        let mut pending: Option<u64> = Some(0);
        for next in recording.by_ref() {
            let recorded = match next {
                Ok(recorded) => recorded,
                Err(error) => {
                    outcome.ended = Some(error);
                    break;
                }
            };
            let at_us = recorded.at.as_micros();
            let line = delivery(&recorded);
            if line.is_none() && &*recorded.topic != topics::DIGEST {
                continue;
            }
            if let Some(moment_us) = pending.filter(|moment_us| *moment_us < at_us || line.is_none()) {
                self.moment(moment_us, audience)?;
                pending = None;
            }
            self.timers_until(at_us, line.is_none(), audience)?;
            match line {
                Some((line, bytes)) => {
                    self.deliver(line, bytes, recorded.published);
                    pending = Some(at_us);
                }
                None => self.compare(&recorded, &mut outcome),
            }
        }
        if let Some(moment_us) = pending {
            self.moment(moment_us, audience)?;
        }
        let end = recording.metadata(END_METADATA);
        if let Some(end_us) = end.and_then(|texts| texts.get("duration_us")?.parse().ok()) {
            self.timers_until(end_us, true, audience)?;
        }
        let recorded = end.and_then(|texts| u64::from_str_radix(texts.get("digest")?, 16).ok());
        Ok(ReplayOutcome {
            digest: self.digest.value(),
            recorded_digest: recorded,
            played_us: self.now_us,
            ..outcome
        })
    }

    /// Timers before a moment, or up to and at it.
    fn timers_until(
        &mut self,
        at_us: u64,
        inclusive: bool,
        audience: &mut dyn ReplayAudience,
    ) -> Result<(), ReplayError> {
        while let Some(timer_us) = next_timer_us() {
            if timer_us > at_us || (timer_us == at_us && !inclusive) {
                break;
            }
            self.moment(timer_us, audience)?;
        }
        Ok(())
    }

    fn moment(&mut self, now_us: u64, audience: &mut dyn ReplayAudience) -> Result<(), ReplayError> {
        // A recording whose times run backwards must not turn the clock back.
        self.now_us = self.now_us.max(now_us);
        advance_virtual(self.now_us);
        self.tasks.poll_until_quiet().map_err(|error| ReplayError::Tasks(error.to_string()))?;
        for frame in self.lines.can.drain() {
            self.digest.on_frame(&frame, self.now_us);
        }
        let _ = (self.lines.from_imu_line.drain(), self.lines.scanner.asked());
        let now = (self.shared.people.published(), self.shared.status.published());
        let before = std::mem::replace(&mut self.seen, now);
        if before.0 != now.0
            && let Some(report) = self.shared.people.get()
        {
            self.digest.on_people(&report);
            if self.learns {
                self.digest.on_probabilities(&report);
            }
            audience.on_people(&report, self.digest.value());
        }
        if before.1 != now.1
            && let Some(status) = self.shared.status.get()
        {
            self.digest.on_status(&status);
            audience.on_status(&status);
        }
        while let Some(stop) = self.shared.stops.try_pop() {
            audience.on_stop(&stop);
        }
        audience.on_moment(self.shared, self.now_us);
        Ok(())
    }

    fn deliver(&self, line: TapeLine, bytes: &[u8], arrival: Stamp) {
        match line {
            TapeLine::Lidar => self.lines.lidar.push(arrival, bytes.to_vec()),
            TapeLine::Scanner => self.lines.scanner.push(arrival, bytes),
            TapeLine::RearScanner => self.lines.rear_scanner.push(bytes),
            TapeLine::Imu => self.lines.imu.push(bytes),
            TapeLine::Can => {
                if let Some((id, payload)) = bytes.split_first_chunk::<2>() {
                    self.lines.can.push(frame_of(u16::from_le_bytes(*id), payload));
                }
            }
            TapeLine::Reset => self.shared.reset.signal(()),
            TapeLine::Start => self.shared.start.signal(()),
            TapeLine::Pause => self.shared.pause(true),
            TapeLine::Resume => self.shared.pause(false),
            TapeLine::MissionOrder => {
                // One that is damaged was refused when it came, too.
                if let Ok(order) = MissionOrder::from_text(bytes) {
                    let _ = self.orders.push(order);
                }
            }
            TapeLine::Route => {}
        }
    }

    fn compare(&self, recorded: &Recorded, outcome: &mut ReplayOutcome) {
        // A CDR text: header, length, sixteen digits.
        let text = recorded.data.get(8..24).and_then(|text| std::str::from_utf8(text).ok());
        let Some(expected) = text.and_then(|text| u64::from_str_radix(text, 16).ok()) else { return };
        outcome.compared += 1;
        if expected != self.digest.value() {
            outcome.first_difference.get_or_insert(recorded.at);
        }
    }
}
