//! The supervisor: takes evidence, answers with what is permitted. Time-driven: every input and every 10 ms tick leads
//! to a decision, with or without a command (FG-REQ-007).

use super::packet_check::BLIND_RUN_CDEG;
use super::rules::Clear;
use super::source_monitor::SourceMonitor;
use super::state::State;
use crate::people::StopTriggers;
use crate::protection::ResetReport;
use crate::protection::{
    Advice, Body, Cause, CauseRecord, ContentWatch, Decision, FaultKind, GuardConfig, GuardConfigError,
    Integrity, LidarRays, LocalMemory, PacketTable, RearScanner, ScanTable, SeenBeside, Source, SourceReport,
    Unit, fastest_mps,
};
use floorguard_types::capacities::REAR_SCANNERS_MAX;
use floorguard_types::geometry::Twist2;
use floorguard_types::number::truncating_u32;
use floorguard_types::sensing::{
    DiscreteInputs, DriveFeedback, DriveState, ImuSample, LidarPacket, SafetyInput, Scan, silent_cdeg,
};
use floorguard_types::time::Stamp;

/// Decides. About 60 KiB of tables on the MCU: keep it in a static.
#[derive(Clone, Debug)]
pub struct Supervisor {
    pub(super) config: GuardConfig,
    pub(super) body: Body,
    pub(super) scan_table: ScanTable,
    pub(super) rear: [RearScanner; REAR_SCANNERS_MAX],
    pub(super) packet_table: PacketTable,
    pub(super) rays: LidarRays,
    pub(super) memory: LocalMemory,
    pub(super) seen: SeenBeside,
    pub(super) triggers: StopTriggers,
    pub(super) contents: ContentWatch,
    pub(super) integrity: Integrity,
    pub(super) state: State,
    pub(super) copy: State,
    pub(super) resets: ResetReport,
}

impl Supervisor {
    /// Knows no robot and lets nothing move: a place for [`Self::configure`], which needs none on the stack.
    pub const UNCONFIGURED: Self = Self {
        config: GuardConfig::NONE,
        body: Body { x_m: [0.0; 2], y_m: [0.0; 2] },
        scan_table: ScanTable::EMPTY,
        rear: [RearScanner::EMPTY; REAR_SCANNERS_MAX],
        packet_table: PacketTable::EMPTY,
        rays: LidarRays::NONE,
        memory: LocalMemory::EMPTY,
        seen: SeenBeside::NOTHING,
        triggers: StopTriggers::NONE,
        contents: ContentWatch::NONE,
        integrity: Integrity::NONE,
        state: State::UNKNOWN,
        copy: State::UNKNOWN,
        resets: ResetReport::NONE,
    };

    /// A configured guard, by value.
    ///
    /// # Errors
    /// As [`Self::configure`].
    pub fn new(config: GuardConfig, now: Stamp) -> Result<Self, GuardConfigError> {
        let mut guard = Self::UNCONFIGURED;
        guard.configure(config, now)?;
        Ok(guard)
    }

    /// Checks the configuration and precomputes the tables where they stay. What was known before is forgotten; nothing
    /// moves before every required source was healthy.
    ///
    /// # Errors
    /// The first rule that the configuration breaks; then nothing is changed.
    pub fn configure(&mut self, config: GuardConfig, now: Stamp) -> Result<(), GuardConfigError> {
        config.validate()?;
        self.body = Body::around(&config.footprint);
        self.scan_table.fill(&config.scanner, &config.fields);
        self.rear.iter_mut().for_each(|rear| rear.fill(config.rear_scanner.as_ref(), &config.fields));
        self.packet_table.fill(&config.lidar, &config.fields);
        self.rays.fill(&config.lidar);
        self.memory.forget();
        (self.contents, self.seen, self.triggers) =
            (ContentWatch::NONE, SeenBeside::NOTHING, StopTriggers::NONE);
        let tables = ((&self.scan_table, &self.rear[..]), &self.packet_table, &self.rays);
        self.integrity.remember(&config, self.body, tables);
        self.state = State::new(&config, now);
        self.copy = self.state;
        self.config = config;
        self.resets = ResetReport::NONE;
        Ok(())
    }

    /// A scan of the safety scanner.
    pub fn on_scan(&mut self, scan: &Scan, now: Stamp) -> Decision {
        self.take_scan((Source::Scanner, scan), now)
    }

    /// A packet of the lidar: decided within the packet (FG-REQ-023).
    pub fn on_lidar_packet(&mut self, packet: &LidarPacket, now: Stamp) -> Decision {
        self.begin(now);
        let azimuth = packet.columns.first().map_or(0, |column| u32::from(column.azimuth_cdeg));
        self.accept(Source::Lidar, (packet.stamp, azimuth), now);
        let silent = silent_cdeg(packet);
        self.state.silent_cdeg = if silent > 0 { self.state.silent_cdeg.saturating_add(silent) } else { 0 };
        let is_blind = self.state.silent_cdeg > BLIND_RUN_CDEG || self.contents.is_covered;
        let is_frozen = self.contents.is_lidar_frozen();
        self.monitor(Source::Lidar, |monitor| (monitor.blind, monitor.repeats) = (is_blind, is_frozen));
        self.judge_packet(packet, now);
        self.decide(now)
    }

    /// Emergency stop, bumpers, cliff sensors.
    pub fn on_discrete(&mut self, inputs: &DiscreteInputs, now: Stamp) -> Decision {
        self.begin(now);
        self.accept(Source::Discrete, (inputs.stamp, 0), now);
        let judged = [
            (inputs.emergency_stop, Cause::EmergencyStop),
            (inputs.bumper_front, Cause::BumperFront),
            (inputs.bumper_rear, Cause::BumperRear),
            (inputs.cliff_front, Cause::CliffFront),
            (inputs.cliff_rear, Cause::CliffRear),
        ];
        for (input, active) in judged {
            let cause = match input {
                SafetyInput::Clear => continue,
                SafetyInput::Active => active,
                SafetyInput::Fault => Cause::InputFault,
                SafetyInput::Unknown => Cause::InputUnknown,
            };
            self.raise_input(cause, inputs.stamp, now);
        }
        self.decide(now)
    }

    /// Motion measured by the wheel encoders.
    pub fn on_wheels(&mut self, measured: Twist2, stamp: Stamp, now: Stamp) -> Decision {
        self.begin(now);
        self.accept(Source::Wheels, (stamp, 0), now);
        if measured.is_finite() {
            self.state.motion.hear_wheels(measured, &self.config.footprint);
            let step_s = self.memory.follow(measured, stamp);
            self.seen.follow(measured, (step_s, self.config.unseen.known_after_m));
            self.judge_standstill(Source::Wheels, measured, now);
        } else {
            self.fault(Source::Wheels, FaultKind::Garbled);
        }
        self.decide(now)
    }

    /// An inertial sample in the robot's axes.
    pub fn on_imu(&mut self, sample: &ImuSample, now: Stamp) -> Decision {
        self.begin(now);
        let numbers = sample.angular_radps.iter().chain(&sample.linear_mps2);
        let print = numbers.clone().fold(0_u32, |print, number| print.rotate_left(5) ^ number.to_bits());
        self.accept(Source::Imu, (sample.stamp, print), now);
        let [_, _, yaw_radps] = sample.angular_radps;
        if sample.suspect || !numbers.clone().all(|number| number.is_finite()) {
            self.fault(Source::Imu, FaultKind::Garbled);
        } else {
            self.state.motion.gyro_radps = yaw_radps;
        }
        self.decide(now)
    }

    /// What the drive reports.
    pub fn on_drive(&mut self, feedback: &DriveFeedback, now: Stamp) -> Decision {
        self.begin(now);
        self.accept(Source::Drive, (feedback.stamp, 0), now);
        match feedback.state {
            DriveState::Fault(code) => {
                let record = CauseRecord::new(Cause::DriveFault, now).aged(feedback.stamp.past_us(now));
                self.state.machine.raise(record.measured(f32::from(code), 0.0, Unit::Code));
            }
            DriveState::Unknown => self.fault(Source::Drive, FaultKind::StandBy),
            DriveState::Disabled | DriveState::Enabled | DriveState::QuickStop => {}
        }
        if feedback.wheel_speed_mps.is_finite() && feedback.steering_rad.is_finite() {
            let (wheel_mps, steering_rad) = (feedback.wheel_speed_mps, feedback.steering_rad);
            self.state.motion.hear_drive(wheel_mps, steering_rad, &self.config);
            self.judge_standstill(Source::Drive, self.state.motion.drive, now);
        } else {
            self.fault(Source::Drive, FaultKind::Garbled);
        }
        self.decide(now)
    }

    /// The drive kept its power while this computer had none: whatever was latched is forgotten, so the operator must
    /// look, as after a drive that was lost (FG-REQ-018).
    pub fn on_found_running(&mut self, now: Stamp) -> Decision {
        self.begin(now);
        self.state.machine.raise(CauseRecord::new(Cause::SourceLost(Source::Drive), now));
        self.decide(now)
    }

    /// Something that a task of the guard ring keeps twice differs from its copy (FG-REQ-058).
    pub fn on_corruption(&mut self, now: Stamp) -> Decision {
        self.begin(now);
        self.state.machine.raise(CauseRecord::new(Cause::StateCorrupted, now));
        self.decide(now)
    }

    /// A driver cannot use its device. Holds until the next good sample.
    pub fn on_source_fault(&mut self, source: Source, kind: FaultKind, now: Stamp) -> Decision {
        self.begin(now);
        self.fault(source, kind);
        self.decide(now)
    }

    /// A command to move is present. A non-finite number stops (FG-REQ-054).
    pub fn on_command(&mut self, wanted: Twist2, stamp: Stamp, now: Stamp) -> Decision {
        self.begin(now);
        let accepted = self.accept(Source::Command, (stamp, 0), now);
        if !wanted.is_finite() {
            self.state.machine.raise(CauseRecord::new(Cause::CommandInvalid, now).aged(stamp.past_us(now)));
        }
        let wanted = if accepted && wanted.is_finite() { wanted } else { Twist2::ZERO };
        self.state.wanted = self.config.unseen.limited(wanted, (&self.config.footprint, &self.seen));
        self.state.wanted_fastest_mps = fastest_mps(&self.config.footprint, self.state.wanted);
        self.judge_way(now);
        self.decide(now)
    }

    /// The perception ring found something. It can only tighten (FG-REQ-030).
    pub fn on_advice(&mut self, advice: &Advice, now: Stamp) -> Decision {
        self.begin(now);
        self.accept(Source::Perception, (advice.stamp, 0), now);
        self.judge_advice(advice, now);
        self.decide(now)
    }

    /// The operator pressed reset: starts the self-test; what is latched is let go when it has passed (FG-REQ-005). While nothing
    /// but a closed way holds the robot it says that a person has looked there (FG-REQ-065).
    pub fn request_reset(&mut self, now: Stamp) -> Decision {
        self.begin(now);
        let machine = &self.state.machine;
        self.memory.reset_means_way = machine.latches() == 0 && machine.holds(Cause::WayClosed);
        self.state.machine.request_reset(now);
        self.decide(now)
    }

    /// The operator gave the start command: nothing moves before, after power-up and after each reset (FG-REQ-019).
    pub fn request_start(&mut self, now: Stamp) -> Decision {
        self.begin(now);
        self.state.machine.request_start();
        self.decide(now)
    }

    /// What was latched when the computer last ran, as [`Self::latches`] gave it: it is latched again (FG-REQ-070).
    pub fn on_latches(&mut self, latches: u64, now: Stamp) -> Decision {
        self.begin(now);
        for cause in Cause::all() {
            let was_latched = latches.wrapping_shr(truncating_u32(cause.index())) & 1 != 0;
            if was_latched && cause.clear() == Clear::Reset {
                self.raise_input(cause, now, now);
            }
        }
        self.decide(now)
    }

    /// The causes that hold and need a reset, one bit for each [`Cause::index`]: for memory that outlives the computer.
    #[must_use]
    pub fn latches(&self) -> u64 {
        self.state.machine.latches()
    }

    /// Time has passed: call every 10 ms. Checks a sixteenth of the constants (FG-REQ-017).
    pub fn tick(&mut self, now: Stamp) -> Decision {
        self.begin(now);
        let tables = ((&self.scan_table, &self.rear[..]), &self.packet_table, &self.rays);
        let is_whole = self.integrity.check_next(&self.config, self.body, tables) && self.memory.check_next();
        if !is_whole {
            self.state.machine.raise(CauseRecord::new(Cause::StateCorrupted, now));
        }
        self.memory.pass_time(now);
        self.judge_way(now);
        self.decide(now)
    }

    /// How each source is, for display.
    #[must_use]
    pub fn health(&self) -> [SourceReport; Source::COUNT] {
        let now = self.state.decided_at;
        Source::ALL.map(|source| {
            let monitor = self.state.monitors.get(source.index()).copied().unwrap_or(SourceMonitor::UNKNOWN);
            let rules = self.config.rules(source);
            SourceReport {
                source,
                health: monitor.health(&rules, now),
                age_us: monitor.age_us(now),
                ahead_us: u64::from(monitor.ahead_us),
                fitted: rules.fitted,
            }
        })
    }

    /// Every cause that holds, as it began.
    pub fn causes(&self) -> impl Iterator<Item = &CauseRecord> {
        self.state.machine.held()
    }

    /// The configuration in force.
    #[must_use]
    pub fn config(&self) -> &GuardConfig {
        &self.config
    }

    /// Compares the state with its copy, and the clock with its past (FG-REQ-008).
    pub(super) fn begin(&mut self, now: Stamp) {
        if self.state != self.copy {
            self.state.machine.raise(CauseRecord::new(Cause::StateCorrupted, now));
        }
        if now < self.state.decided_at {
            self.state.machine.raise(CauseRecord::new(Cause::ClockFault, now));
        }
    }

    /// Encoders or drive measured. Once the robot has had the time to brake, a hold means that it stands (FG-REQ-057).
    fn judge_standstill(&mut self, source: Source, measured: Twist2, now: Stamp) {
        let checks = &mut self.state.checks;
        let must_stand = self.state.started && checks.is_held && checks.envelope_mps <= 0.0;
        let by_drive = source == Source::Drive;
        let creep = if by_drive { &mut checks.creep_by_drive } else { &mut checks.creep_by_wheels };
        if let Some(record) = creep.measure(measured, (&self.config.footprint, must_stand), now) {
            self.state.machine.raise(record);
        }
    }

    fn raise_input(&mut self, cause: Cause, stamp: Stamp, now: Stamp) {
        let mut record = CauseRecord::new(cause, now).aged(stamp.past_us(now));
        if cause == Cause::EmergencyStop {
            record.action = self.config.thresholds.emergency_action;
        }
        self.state.machine.raise(record);
    }

    pub(super) fn accept(&mut self, source: Source, (stamp, fingerprint): (Stamp, u32), now: Stamp) -> bool {
        let mut accepted = false;
        self.monitor(source, |monitor| accepted = monitor.accept(stamp, fingerprint, now));
        accepted
    }

    pub(super) fn fault(&mut self, source: Source, kind: FaultKind) {
        self.monitor(source, |monitor| monitor.fault = Some(kind));
    }

    pub(super) fn monitor(&mut self, source: Source, change: impl FnOnce(&mut SourceMonitor)) {
        if let Some(monitor) = self.state.monitors.get_mut(source.index()) {
            change(monitor);
        }
    }

    /// Returns of two neighbouring packets together make an obstacle: one may be cut at the border of a packet.
    fn judge_packet(&mut self, packet: &LidarPacket, now: Stamp) {
        let needed = self.config.thresholds.packet_returns;
        let finding = self.packet_table.check(packet, self.state.selection.active, &self.body);
        let returns = finding.returns.saturating_add(self.state.packet_returns);
        self.state.packet_returns = finding.returns;
        if returns >= needed && finding.returns > 0 {
            let record = CauseRecord::new(Cause::LidarProtective, now).aged(packet.stamp.past_us(now));
            self.state.machine.raise(record.metres(finding.nearest_m, finding.nearest_limit_m));
            self.state.note_blocked(finding.blocked, now);
        }
        if let Some(candidate) = self.state.selection.candidate
            && self.packet_table.check(packet, candidate, &self.body).returns >= needed
        {
            self.state.selection.candidate_blocked(now);
        }
    }
}
