//! Brings a sensor to measure, and gives its scans with times of the robot's clock.

use floorguard_types::number::{nearest_f32, saturating_u64};
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

use super::clock::ScipClock;
use super::command::{Command, RangeKind, ScanRange};
use super::parameters::SensorParameters;
use super::receiver::{Receiver, ReceiverCounters, RefusedReply, Reply, Status};
use super::scan::{MeasuredScan, RawScan};

/// A command is answered within this; then it is asked again.
const ANSWER_US: u64 = 500_000;
/// So often, then all begins anew.
const TRIES_MAX: u8 = 3;
/// A sensor that sends scans and is silent for so long has stopped.
const SILENCE_US: u64 = 1_000_000;
/// After trouble, so long before it is asked again.
const PAUSE_US: u64 = 1_000_000;
/// Readings of its clock.
const READINGS: u8 = 8;

/// What to measure, and what the sensor must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceConfiguration {
    /// Distances, or strengths too.
    pub kind: RangeKind,
    /// Which steps.
    pub range: ScanRange,
    /// Scans that are left out between two, 0…9.
    pub interval: u8,
    /// Microseconds that a byte takes on a serial line; 0 for TCP and USB.
    pub byte_us: f32,
    /// What the sensor measures beyond this is not believed, millimetres.
    pub farthest_mm: u32,
    /// Numbers by which the sensor says that nothing came back.
    pub no_return_codes: [u32; 3],
    /// So far there is nothing where nothing came back, as the robot's owner accepts, millimetres; 0: it is unknown.
    pub no_return_mm: u16,
}

impl DeviceConfiguration {
    /// The published sensor (Dalmedico et al. 2019): 511 steps, ±90° around the front, up to 4 m.
    pub const URG_04LX: Self = Self {
        kind: RangeKind::Distance,
        range: ScanRange { first_step: 129, last_step: 639, cluster: 1 },
        interval: 0,
        byte_us: 0.0,
        farthest_mm: 4_000,
        no_return_codes: [0, 1, 2],
        no_return_mm: 0,
    };
    /// ±90° around the front of a UST-10LX: 721 steps, up to 10 m.
    pub const UST_10LX: Self = Self {
        kind: RangeKind::Distance,
        range: ScanRange { first_step: 180, last_step: 900, cluster: 1 },
        interval: 0,
        byte_us: 0.0,
        farthest_mm: 10_000,
        no_return_codes: [65_533; 3],
        no_return_mm: 0,
    };
}

/// What the sensor is being asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DevicePhase {
    /// To speak SCIP 2.0. Some refuse, and speak it.
    Greeting,
    /// To stop what a program before this one began.
    Stopping,
    /// For its geometry.
    Asking,
    /// For its time.
    ReadingClock(u8),
    /// To go on after that.
    LeavingClock,
    /// For scans.
    Starting,
    /// It sends scans.
    Measuring,
    /// In trouble: it is left alone for a second.
    Resting,
}

/// What the device reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceEvent<'a> {
    /// A scan.
    Scan(&'a MeasuredScan),
    /// Its geometry: the first scan follows.
    Parameters(SensorParameters),
    /// It refuses, is interrupted or in trouble.
    Fault(Status),
    /// It says that it is something that cannot measure what is asked for.
    Unsuitable(SensorParameters),
    /// A reply was damaged; nothing of it is used.
    Refused(RefusedReply),
    /// It did not answer, or stopped sending: all begins anew.
    Silent,
}

/// Totals that saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeviceCounters {
    /// Of its bytes.
    pub receiver: ReceiverCounters,
    /// Scans of other steps than were asked for: of a program before this one.
    pub foreign: u32,
    /// Beginnings after the first one.
    pub restarts: u32,
}

/// A sensor. Its size is that of two scans, 18 kB.
#[derive(Clone, Debug)]
pub struct Device {
    receiver: Receiver,
    session: Session,
}

/// What is known of the sensor, and what it is being asked for.
#[derive(Clone, Debug)]
struct Session {
    configuration: DeviceConfiguration,
    parameters: SensorParameters,
    clock: ScipClock,
    scan: MeasuredScan,
    phase: DevicePhase,
    /// When it was asked last, or last heard while it measures.
    since: Option<Stamp>,
    tries: u8,
    foreign: u32,
    restarts: u32,
}

impl Device {
    /// Nothing was asked yet.
    #[must_use]
    pub fn new(configuration: DeviceConfiguration) -> Self {
        let session = Session {
            configuration,
            parameters: SensorParameters::NONE,
            clock: ScipClock::default(),
            scan: MeasuredScan::EMPTY,
            phase: DevicePhase::Greeting,
            since: None,
            tries: 0,
            foreign: 0,
            restarts: 0,
        };
        Self { receiver: Receiver::new(), session }
    }

    /// What it is being asked for.
    #[must_use]
    pub const fn phase(&self) -> DevicePhase {
        self.session.phase
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> DeviceCounters {
        DeviceCounters {
            receiver: self.receiver.counters(),
            foreign: self.session.foreign,
            restarts: self.session.restarts,
        }
    }

    /// How well its time is known: half of a round trip, microseconds.
    #[must_use]
    pub fn clock_uncertainty_us(&self) -> Option<u64> {
        self.session.clock.uncertainty_us()
    }

    /// Time has passed: sends what is due, a command at a time. True if the sensor fell silent.
    pub fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) -> bool {
        self.session.poll(now, send)
    }

    /// Takes bytes that arrived at a time.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut event: impl FnMut(DeviceEvent<'_>)) {
        let Self { receiver, session } = self;
        receiver.push(bytes, now, |reply| session.take(reply, now, &mut event));
    }
}

impl Session {
    fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) -> bool {
        let waited_us = self.since.map(|since| since.past_us(now));
        match self.phase {
            DevicePhase::Measuring => {
                let is_silent = waited_us.is_some_and(|us| us > SILENCE_US);
                if is_silent {
                    self.restart();
                }
                is_silent
            }
            DevicePhase::Resting => {
                if waited_us.is_none_or(|us| us >= PAUSE_US) {
                    self.restart();
                }
                false
            }
            _ if waited_us.is_some_and(|us| us < ANSWER_US) => false,
            DevicePhase::Greeting if self.tries > 0 => {
                // No answer: it may not know the greeting.
                self.enter(DevicePhase::Stopping);
                self.ask(now, send);
                false
            }
            _ if self.tries >= TRIES_MAX => {
                self.restart();
                true
            }
            _ => {
                self.ask(now, send);
                false
            }
        }
    }

    fn take(&mut self, reply: Reply<'_>, now: Stamp, event: &mut impl FnMut(DeviceEvent<'_>)) {
        match (reply, self.phase) {
            (Reply::Refused(refused), _) => event(DeviceEvent::Refused(refused)),
            (Reply::Scan(scan), DevicePhase::Measuring | DevicePhase::Starting) => {
                self.enter(DevicePhase::Measuring);
                self.since = Some(now);
                if self.measure(scan, now) {
                    event(DeviceEvent::Scan(&self.scan));
                } else {
                    self.foreign = self.foreign.saturating_add(1);
                }
            }
            (Reply::Parameters(parameters), DevicePhase::Asking) => self.take_parameters(parameters, event),
            (Reply::Time(sensor_ms), DevicePhase::ReadingClock(number)) => {
                if let Some(asked) = self.since {
                    self.clock.read(sensor_ms, asked, now);
                }
                let next = number.saturating_add(1);
                self.enter(if next > READINGS {
                    DevicePhase::LeavingClock
                } else {
                    DevicePhase::ReadingClock(next)
                });
            }
            (Reply::Status { command, status }, _) => self.take_status(command, status, (now, event)),
            (Reply::Scan(_) | Reply::Parameters(_) | Reply::Time(_), _) => {}
        }
    }

    fn take_parameters(&mut self, parameters: SensorParameters, event: &mut impl FnMut(DeviceEvent<'_>)) {
        let range = self.configuration.range;
        let is_suitable = parameters.is_plausible()
            && range.first_step <= range.last_step
            && range.last_step <= parameters.last_step;
        self.parameters = parameters;
        self.parameters.farthest_mm = parameters.farthest_mm.min(self.configuration.farthest_mm);
        if is_suitable {
            event(DeviceEvent::Parameters(parameters));
            self.enter(DevicePhase::ReadingClock(0));
        } else {
            event(DeviceEvent::Unsuitable(parameters));
            self.enter(DevicePhase::Resting);
        }
    }

    fn take_status(
        &mut self,
        command: [u8; 2],
        status: Status,
        (now, event): (Stamp, &mut impl FnMut(DeviceEvent<'_>)),
    ) {
        let next = match (self.phase, &command) {
            // Whatever it says to that.
            (DevicePhase::Greeting, b"SC") => Some(DevicePhase::Stopping),
            (DevicePhase::Stopping, b"QT") => Some(DevicePhase::Asking),
            // It tells its time already; or it cannot, and the arrivals serve.
            (DevicePhase::ReadingClock(0), b"TM") => Some(match status {
                Status::Accepted | Status::Refused([b'0', b'2']) => DevicePhase::ReadingClock(1),
                _ => DevicePhase::Starting,
            }),
            (DevicePhase::ReadingClock(_), b"TM") => Some(DevicePhase::LeavingClock),
            (DevicePhase::LeavingClock, b"TM") => Some(DevicePhase::Starting),
            (DevicePhase::Starting, [b'M', _]) if status == Status::Accepted => Some(DevicePhase::Measuring),
            _ => None,
        };
        if let Some(next) = next {
            self.enter(next);
            if next == DevicePhase::Measuring {
                self.since = Some(now);
            }
            return;
        }
        if matches!(
            status,
            Status::Interrupted(_) | Status::Trouble(_) | Status::LaserOff | Status::Refused(_)
        ) {
            event(DeviceEvent::Fault(status));
        }
        if matches!(status, Status::Trouble(_) | Status::LaserOff)
            || (command == [b'M', self.configuration.kind.letter()] && matches!(status, Status::Refused(_)))
        {
            self.enter(DevicePhase::Resting);
            self.since = Some(now);
        }
    }

    /// Makes a measurement of a scan; false for other steps than were asked for.
    fn measure(&mut self, raw: &RawScan, now: Stamp) -> bool {
        if raw.range != self.configuration.range || raw.kind != self.configuration.kind {
            return false;
        }
        let parameters = &self.parameters;
        let step_us = parameters.step_us();
        // From step 0 to the last byte at least: the turn up to the last step, and the bytes.
        let bytes = nearest_f32(raw.distances_mm.len()) * f32::from(raw.kind.characters());
        let delay_us = f32::from(raw.range.last_step) * step_us + bytes * self.configuration.byte_us;
        let begin = self.clock.stamp(raw.sensor_ms, (now, saturating_u64(delay_us)));
        let steps = f32::from(raw.range.cluster.max(1));
        let first = f32::from(raw.range.first_step);
        self.scan.first_beam = begin.plus_micros(saturating_u64(first * step_us));
        self.scan.beam_period_us = step_us * steps;
        self.scan.step_rad = parameters.step_rad() * steps;
        self.scan.first_angle_rad =
            parameters.angle_rad(raw.range.first_step) + 0.5 * (steps - 1.0) * parameters.step_rad();
        // As many as the raw scan has: never full.
        let _full = self.scan.beams.resize(raw.distances_mm.len(), BeamReturn::Unknown);
        let DeviceConfiguration { no_return_codes, no_return_mm, .. } = self.configuration;
        for (beam, distance_mm) in self.scan.beams.iter_mut().zip(&raw.distances_mm) {
            let is_no_return = no_return_mm > 0 && no_return_codes.contains(distance_mm);
            *beam = if is_no_return { BeamReturn::Free(no_return_mm) } else { parameters.beam(*distance_mm) };
        }
        true
    }

    fn enter(&mut self, phase: DevicePhase) {
        (self.phase, self.since, self.tries) = (phase, None, 0);
    }

    fn restart(&mut self) {
        self.restarts = self.restarts.saturating_add(1);
        // It may have been switched off and on: its counter is another one then.
        self.clock.forget();
        self.enter(DevicePhase::Greeting);
    }

    fn ask(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) {
        let DeviceConfiguration { kind, range, interval, .. } = self.configuration;
        let command = match self.phase {
            DevicePhase::Greeting => Command::UseScip2,
            DevicePhase::Stopping => Command::Stop,
            DevicePhase::Asking => Command::Parameters,
            DevicePhase::ReadingClock(0) => Command::ClockBegin,
            DevicePhase::ReadingClock(_) => Command::ClockRead,
            DevicePhase::LeavingClock => Command::ClockEnd,
            DevicePhase::Starting => Command::Scans { kind, range, interval, count: 0 },
            DevicePhase::Measuring | DevicePhase::Resting => return,
        };
        send(&command.encode());
        self.since = Some(now);
        self.tries = self.tries.saturating_add(1);
    }
}
