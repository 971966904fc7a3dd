//! A run in real time once more: the tasks of the guard ring are polled in the recorded order, at the recorded times, with
//! the recorded bytes, advice and commands. What they decide and send is compared to the bit.

use std::collections::VecDeque;
use std::io::Read;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use floorguard_drivers::can::CanFrame;
use floorguard_guard::Advice;
use floorguard_robot::assembly::{
    GuardCarriers, GuardTask, ScannerCarrier, guard_for, new_perception, spawn_guard_ring,
};
use floorguard_robot::learning::LearningSetup;
use floorguard_runtime::configuration::{BaseKind, RobotConfiguration, ScannerModel};
use floorguard_runtime::digest::OutputDigest;
use floorguard_runtime::shared::{Motion, Shared, StopRecord};
use floorguard_runtime::tape::{TapeLine, frame_identifier};
use floorguard_runtime::tasks::perceive;
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use super::audience::{Difference, OrderOutcome, ReplayAudience, ReplayError, ReplayOutcome};
use super::delivery::delivery;
use super::scripted_line::ScriptedLine;
use crate::order::{DecisionRow, OrderEntry, OrderReader, PolledRow, read_entries};
use crate::{RawStream, Recorded, Recording, octets_of, topics};
use floorguard_host::executor::{TaskSet, advance_virtual, use_real_clock, use_virtual_clock};
use floorguard_robot::assembly::Stages;

/// The robot that is played again.
#[derive(Clone, Copy)]
pub(super) struct OrderedRun<'a> {
    pub robot: &'a RobotConfiguration,
    pub stages: Stages,
    pub learning: Option<&'a LearningSetup>,
    pub imu_baud: u32,
}

#[derive(Default)]
struct Lines {
    lidar: ScriptedLine,
    scanner: ScriptedLine,
    rear_scanner: ScriptedLine,
    imu: ScriptedLine,
    can: ScriptedLine,
}

impl Lines {
    fn of(&self, line: TapeLine) -> Option<&ScriptedLine> {
        match line {
            TapeLine::Lidar => Some(&self.lidar),
            TapeLine::Scanner => Some(&self.scanner),
            TapeLine::RearScanner => Some(&self.rear_scanner),
            TapeLine::Imu => Some(&self.imu),
            TapeLine::Can => Some(&self.can),
            _ => None,
        }
    }

    fn carriers(
        &self,
        run: &OrderedRun<'_>,
    ) -> GuardCarriers<ScriptedLine, ScriptedLine, ScriptedLine, ScriptedLine, ScriptedLine> {
        GuardCarriers {
            lidar: run.robot.has_lidar.then(|| self.lidar.clone()),
            scanner: match run.robot.scanner.model {
                ScannerModel::S300 => ScannerCarrier::Serial(self.scanner.clone()),
                ScannerModel::Ranging(model) if !model.sends_datagrams() => {
                    ScannerCarrier::Asked(self.scanner.clone(), model)
                }
                ScannerModel::MicroScan3 { .. } | ScannerModel::Ranging(_) => {
                    ScannerCarrier::Datagrams(self.scanner.clone())
                }
            },
            rear_scanner: run.robot.rear_scanner.map(|_| self.rear_scanner.clone()),
            imu: Some((self.imu.clone(), run.imu_baud)),
            can: (run.robot.base == BaseKind::CanBus).then(|| self.can.clone()),
            tap: None,
        }
    }
}

/// What the recording holds and the order has not yet named.
#[derive(Default)]
struct Waiting {
    bytes: [VecDeque<(Stamp, Vec<u8>)>; 5],
    sent: VecDeque<Vec<u8>>,
}

impl Waiting {
    fn of(&mut self, line: TapeLine) -> Option<&mut VecDeque<(Stamp, Vec<u8>)>> {
        let lines = [TapeLine::Lidar, TapeLine::Scanner, TapeLine::Imu, TapeLine::Can, TapeLine::RearScanner];
        let index = lines.iter().position(|each| *each == line)?;
        self.bytes.get_mut(index)
    }
}

/// What reaches the guard by a slot: the newest counts.
enum Input {
    Command(Stamp, Twist2),
    Advice(Box<Advice>),
    Operator(TapeLine),
}

struct Stage<'a> {
    run: OrderedRun<'a>,
    shared: &'a Shared<NoopRawMutex>,
    lines: Lines,
    guard: TaskSet<'a>,
    names: Vec<GuardTask>,
    perception: TaskSet<'a>,
    waiting: Waiting,
    expected_frames: usize,
    /// What the poll takes besides bytes, in the order in which it took it.
    inputs: Vec<Input>,
    /// What was decided then, at last.
    recorded: DecisionRow,
    digest: OutputDigest,
    seen: (u32, u32),
    now_us: u64,
    outcome: OrderOutcome,
    ended: bool,
}

/// Plays the whole recording on a clock of its own.
pub(super) fn play_ordered<R: Read>(
    run: OrderedRun<'_>,
    recording: &mut Recording<R>,
    audience: &mut dyn ReplayAudience,
) -> Result<ReplayOutcome, ReplayError> {
    use_virtual_clock(0);
    let outcome = play_entries(run, recording, audience);
    use_real_clock();
    outcome
}

fn play_entries<R: Read>(
    run: OrderedRun<'_>,
    recording: &mut Recording<R>,
    audience: &mut dyn ReplayAudience,
) -> Result<ReplayOutcome, ReplayError> {
    let shared: Box<Shared<NoopRawMutex>> = Box::new(Shared::unconfigured(Motion::new(run.robot.wheels())));
    let mut perception = new_perception(run.robot, run.stages);
    perception.motion.learn(run.learning);
    let lines = Lines::default();
    let (mut guard, mut perceiving) = (TaskSet::new(), TaskSet::new());
    let names = spawn_guard_ring(&mut guard, &shared, run.robot, lines.carriers(&run));
    perceiving.spawn(perceive(&*shared, &mut perception));
    let mut stage = Stage {
        run,
        shared: &shared,
        lines,
        guard,
        names,
        perception: perceiving,
        waiting: Waiting::default(),
        expected_frames: 0,
        inputs: Vec::new(),
        recorded: DecisionRow::default(),
        digest: OutputDigest::default(),
        seen: (0, 0),
        now_us: 0,
        outcome: OrderOutcome::default(),
        ended: false,
    };
    let mut outcome = ReplayOutcome::default();
    let mut reader = OrderReader::default();
    for next in recording.by_ref() {
        match next {
            Ok(recorded) => stage.take_in(&recorded, &mut reader, audience)?,
            Err(error) => {
                outcome.ended = Some(error);
                break;
            }
        }
        if stage.ended {
            break;
        }
    }
    let (digest, played_us) = (stage.digest.value(), stage.now_us);
    let order = Some(stage.outcome);
    Ok(ReplayOutcome { digest, played_us, order, ..outcome })
}

impl Stage<'_> {
    fn take_in(
        &mut self,
        recorded: &Recorded,
        reader: &mut OrderReader,
        audience: &mut dyn ReplayAudience,
    ) -> Result<(), ReplayError> {
        if let Some((line, bytes)) = delivery(recorded) {
            if let Some(waiting) = self.waiting.of(line) {
                waiting.push_back((recorded.published, bytes.to_vec()));
            }
        } else if &*recorded.topic == RawStream::CanSent.topic() {
            self.waiting.sent.extend(octets_of(&recorded.data).map(<[u8]>::to_vec));
        } else if &*recorded.topic == topics::ORDER {
            let mut entries = Vec::new();
            let octets = octets_of(&recorded.data).unwrap_or_default();
            if !read_entries(reader, octets, |entry| entries.push(entry)) {
                return Err(ReplayError::Order(recorded.at));
            }
            for entry in entries {
                if !self.ended {
                    self.entry(entry, audience)?;
                }
            }
        }
        Ok(())
    }

    fn entry(&mut self, entry: OrderEntry, audience: &mut dyn ReplayAudience) -> Result<(), ReplayError> {
        match entry {
            OrderEntry::Began(at) => {
                self.advance(at);
                self.shared
                    .configure(guard_for(self.run.robot, self.run.stages), at)
                    .map_err(|error| ReplayError::Robot(format!("the guard refuses the robot: {error}")))?;
            }
            OrderEntry::Latches(at, latches) => {
                self.advance(at);
                self.shared.restore_latches(latches, at);
            }
            OrderEntry::Delivered(line) => match self.waiting.of(line).and_then(VecDeque::pop_front) {
                Some((arrival, bytes)) => {
                    if let Some(line) = self.lines.of(line) {
                        line.deliver(arrival, bytes);
                    }
                }
                // Its bytes are missing: nothing after it can be repeated.
                None => self.end_here(),
            },
            OrderEntry::Failed(line, direction) => {
                if let Some(line) = self.lines.of(line) {
                    line.fail(direction);
                }
            }
            OrderEntry::Sent => self.expected_frames += 1,
            OrderEntry::Command(stamp, wanted) => self.inputs.push(Input::Command(stamp, wanted)),
            OrderEntry::Advice(advice) => self.inputs.push(Input::Advice(advice)),
            OrderEntry::Operator(button) => self.inputs.push(Input::Operator(button)),
            OrderEntry::Polled(row) => self.poll(&row, audience)?,
            OrderEntry::Lost => self.end_here(),
        }
        Ok(())
    }

    fn give(&self, input: Input) {
        match input {
            Input::Command(stamp, wanted) => self.shared.wanted.publish((stamp, wanted)),
            Input::Advice(advice) => self.shared.advice.publish(*advice),
            Input::Operator(TapeLine::Start) => self.shared.start.signal(()),
            Input::Operator(_) => self.shared.reset.signal(()),
        }
    }

    fn advance(&mut self, at: Stamp) {
        self.now_us = self.now_us.max(at.as_micros());
        advance_virtual(self.now_us);
    }

    fn end_here(&mut self) {
        self.ended = true;
        self.outcome.ends_at = Some(Stamp::from_micros(self.now_us));
    }

    fn poll(&mut self, row: &PolledRow, audience: &mut dyn ReplayAudience) -> Result<(), ReplayError> {
        self.advance(row.at);
        let inputs = std::mem::take(&mut self.inputs);
        let before = self.shared.decision.published();
        let index = row.task.and_then(|task| self.names.iter().position(|name| *name == task));
        // Today's perception publishes its own advice. Only the recorded one may reach the guard.
        let takes_input =
            matches!(row.task, Some(GuardTask::Command | GuardTask::Advice | GuardTask::Operator));
        if let (Some(index), true) = (index, takes_input) {
            // While it decided on one, the next came, and it went on with that in the same poll.
            for input in inputs {
                self.give(input);
                self.guard.poll_one(index);
            }
        } else {
            inputs.into_iter().for_each(|input| self.give(input));
            index.into_iter().for_each(|index| self.guard.poll_one(index));
        }
        self.outcome.polls += 1;
        let decisions = u64::from(self.shared.decision.published().wrapping_sub(before));
        self.compare_decision(row, decisions);
        self.compare_frames(row);
        self.report(row, audience)
    }

    fn compare_decision(&mut self, row: &PolledRow, decisions: u64) {
        self.outcome.decisions += row.decisions;
        let today = self.shared.decision.get().map(|decision| DecisionRow::new(&decision));
        let same = decisions == row.decisions && (decisions == 0 || today == Some(row.decision));
        if !same {
            let words = |count: u64, row: Option<DecisionRow>| match row.filter(|_| count > 0) {
                Some(row) => format!("{row}"),
                None => "nothing decided".to_owned(),
            };
            let (then, now) = (words(row.decisions, Some(row.decision)), words(decisions, today));
            // What words do not show: a number that is rounded, a source that is late or lost.
            let details = then == now;
            let (then, now) = if details {
                (
                    format!("{} times {:?}", row.decisions, row.decision),
                    format!("{decisions} times {today:?}"),
                )
            } else {
                (then, now)
            };
            self.differs(row, then, now);
        }
    }

    fn compare_frames(&mut self, row: &PolledRow) {
        let frames = self.lines.can.drain();
        let sent = std::mem::take(&mut self.expected_frames);
        let then: Vec<Vec<u8>> = (0..sent).map_while(|_| self.waiting.sent.pop_front()).collect();
        self.outcome.frames += sent as u64;
        let today: Vec<Vec<u8>> = frames.iter().map(bytes_of).collect();
        frames.iter().for_each(|frame| self.digest.on_frame(frame, self.now_us));
        if then != today {
            let (then, today) = (format!("sent {then:02x?}"), format!("sends {today:02x?}"));
            self.differs(row, then, today);
        }
    }

    fn differs(&mut self, row: &PolledRow, then: String, today: String) {
        let task = row.task.map_or("unknown task", GuardTask::name);
        self.outcome.first_difference.get_or_insert(Difference { at: row.at, task, then, today });
    }

    /// What the audience gets: the decisions of then, and what today's tasks publish.
    fn report(&mut self, row: &PolledRow, audience: &mut dyn ReplayAudience) -> Result<(), ReplayError> {
        self.perception.poll_until_quiet().map_err(|error| ReplayError::Tasks(error.to_string()))?;
        let began = row.decision.holds() && !self.recorded.holds();
        self.recorded = row.decision;
        if let (true, Some(first)) =
            (began && row.decisions > 0, row.decision.first.and_then(|row| row.record()))
        {
            let pose = self.shared.pose.get().unwrap_or_default();
            audience.on_stop(&StopRecord {
                stamp: row.at,
                cause: first,
                state: row.decision.state().unwrap_or_default(),
                pose_in_odometry: pose.pose_in_odometry,
                speed_mps: pose.twist.linear_mps,
            });
        }
        while self.shared.stops.try_pop().is_some() {}
        let now = (self.shared.people.published(), self.shared.status.published());
        let before = std::mem::replace(&mut self.seen, now);
        if before.0 != now.0
            && let Some(report) = self.shared.people.get()
        {
            self.digest.on_people(&report);
            audience.on_people(&report, self.digest.value());
        }
        if before.1 != now.1
            && let Some(status) = self.shared.status.get()
        {
            self.digest.on_status(&status);
            audience.on_status(&status);
        }
        audience.on_moment(self.shared, self.now_us);
        Ok(())
    }
}

/// As the recording holds a frame: identifier, then data.
fn bytes_of(frame: &CanFrame) -> Vec<u8> {
    let id = frame_identifier(frame).unwrap_or_default().to_le_bytes();
    id.iter().chain(frame.payload()).copied().collect()
}

#[cfg(test)]
#[path = "ordered_tests.rs"]
mod tests;
