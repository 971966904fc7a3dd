//! The device as a whole: brought to measure, kept measuring, read (book, VectorNav: Start-up).
//!
//! Samples are delivered as long as they are whole and the device is not refused: a robot that has to wait for an answer which some
//! cable never brings is worse off than one that uses what it gets. A refused device may send anything: its samples are not used.

use floorguard_types::number::{truncating_u16, truncating_u32};
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::{Age, Stamp};

use super::line::{LineCounters, LineReceiver, Message, sentence};
use super::measurement::{FRAME_BYTES, Measurement};
use super::start_up::{DevicePhase, Echo, RATE_HZ, Series, compare, error_code, model};
use crate::velodyne::HourClock;

/// Without a fresh sample for this long the start-up begins again, microseconds.
const SILENCE_US: u64 = 1_000_000;
/// Between two samples, nanoseconds.
const PERIOD_NS: u64 = 1_000_000_000 / RATE_HZ;
/// From the sampling instant to the first byte on the line: the maker states none; a frame leaves within the device's own sampling
/// period of 1.25 or 2.5 ms. Half of the longer is wrong by at most that.
const LATENCY_US: u64 = 1_250;
const HOUR_US: u64 = 3_600_000_000;
/// The line cannot carry what is asked for: hexadecimal, or the same number as older firmware writes it in decimal digits.
const LINE_TOO_SLOW: [u8; 2] = [0x0C, 0x12];

/// What the device reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceEvent {
    /// A sample: x as printed on the device, y to the left, z up, which are the device's own with y and z turned round.
    Sample(ImuSample),
    /// A frame with an infinite number.
    Refused,
    /// It reports an error, by its code.
    Error(u8),
}

/// Why a device that talks is not as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DeviceFault {
    /// No model that is known; not used until it says another.
    WrongProduct,
    /// It answers with another output than was asked for; not used.
    OtherItems,
    /// It refuses its configuration with this code; not used.
    Rejected(u8),
    /// The line is too slow for the samples; not used.
    LineTooSlow,
    /// It never answers and yet sends all that is needed; used.
    NoAnswer,
}

impl core::fmt::Display for DeviceFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::WrongProduct => f.write_str("the inertial sensor is no VN-100, VN-200 or VN-300"),
            Self::OtherItems => f.write_str("the inertial sensor will not send what it is asked for"),
            Self::Rejected(code) => {
                write!(f, "the inertial sensor rejects its configuration: error {code:02X}")
            }
            Self::LineTooSlow => {
                write!(
                    f,
                    "the line is too slow for {RATE_HZ} inertial samples per second; raise its baud rate to 115200"
                )
            }
            Self::NoAnswer => {
                f.write_str("the inertial sensor sends data but never answers: check the wire to it")
            }
        }
    }
}

impl core::error::Error for DeviceFault {}

/// What happened; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeviceCounters {
    /// Samples delivered.
    pub samples: u32,
    /// Samples missing between two, by the device's time.
    pub lost_samples: u32,
    /// Samples delivered whose time stood still.
    pub repeated_samples: u32,
    /// Frames refused.
    pub refused: u32,
    /// Times that the start-up began.
    pub starts: u32,
    /// Errors reported by the device.
    pub errors: u32,
}

/// One device. About 400 bytes.
#[derive(Clone, Debug)]
pub struct Device {
    baud: u32,
    receiver: LineReceiver,
    phase: DevicePhase,
    series: Series,
    clock: HourClock,
    /// When the request of the phase was sent last.
    sent: Option<Stamp>,
    tries: u8,
    /// Arrival of the newest sample whose time moved, or when the wait for it began.
    last_sample: Option<Stamp>,
    /// Its time by the device, nanoseconds.
    last_time_ns: Option<u64>,
    /// Of the newest sample: periods of the device's time, so that one that stands still is seen to.
    sequence: u16,
    fault: Option<DeviceFault>,
    counters: DeviceCounters,
}

impl Device {
    /// A device behind a line of this bit rate (ten bits a byte).
    #[must_use]
    pub fn new(baud: u32) -> Self {
        Self {
            baud,
            receiver: LineReceiver::default(),
            phase: DevicePhase::default(),
            series: Series::default(),
            clock: HourClock::default(),
            sent: None,
            tries: 0,
            last_sample: None,
            last_time_ns: None,
            sequence: 0,
            fault: None,
            counters: DeviceCounters { starts: 1, ..DeviceCounters::default() },
        }
    }

    /// How far the start-up is.
    #[must_use]
    pub const fn phase(&self) -> DevicePhase {
        self.phase
    }

    /// What is wrong with it, as of the newest start-up.
    #[must_use]
    pub const fn fault(&self) -> Option<DeviceFault> {
        self.fault
    }

    /// What happened.
    #[must_use]
    pub const fn counters(&self) -> DeviceCounters {
        self.counters
    }

    /// What happened on the line.
    #[must_use]
    pub const fn line(&self) -> LineCounters {
        self.receiver.counters()
    }

    /// Bytes that arrived at `now`, in any portions.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut event: impl FnMut(DeviceEvent)) {
        // The receiver lends its messages while the device changes: it is moved aside for the time.
        let mut receiver = core::mem::take(&mut self.receiver);
        receiver.push(bytes, now, |message| match message {
            Message::Frame(payload) => self.on_frame(payload, now, &mut event),
            Message::Sentence(words) => self.on_sentence(words, now, &mut event),
        });
        self.receiver = receiver;
    }

    /// Time has passed: call every 10 to 50 ms and after each push. `send` gets whole sentences, at most one.
    pub fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) {
        if self.phase == DevicePhase::Measuring {
            let last = *self.last_sample.get_or_insert(now);
            if !matches!(last.age(now), Age::Past(us) if us > SILENCE_US) {
                return;
            }
            self.start();
        }
        let (answer_us, tries) = self.phase.patience();
        if self.sent.is_some_and(|sent| matches!(sent.age(now), Age::Past(us) if us < answer_us)) {
            return;
        }
        if self.sent.is_some() && self.tries >= tries {
            self.give_up(now);
        }
        if let Some(sentence) = self.phase.request(self.series).and_then(sentence) {
            send(&sentence);
        }
        self.sent = Some(now);
        self.tries = self.tries.saturating_add(1);
    }

    /// Nothing is answered: it is used if it sends what is needed, and asked from the beginning if not.
    fn give_up(&mut self, now: Stamp) {
        let data_flow =
            self.last_sample.is_some_and(|last| matches!(last.age(now), Age::Past(us) if us < SILENCE_US));
        if data_flow && self.phase != DevicePhase::Refused {
            self.fault = Some(DeviceFault::NoAnswer);
            self.enter(DevicePhase::Measuring);
        } else {
            self.start();
        }
    }

    fn start(&mut self) {
        self.counters.starts = self.counters.starts.saturating_add(1);
        self.enter(DevicePhase::Silencing);
    }

    fn enter(&mut self, phase: DevicePhase) {
        self.phase = phase;
        self.sent = None;
        self.tries = 0;
    }

    fn refuse(&mut self, fault: DeviceFault) {
        self.fault = Some(fault);
        self.enter(DevicePhase::Refused);
    }

    fn on_sentence(&mut self, words: &[u8], now: Stamp, event: &mut impl FnMut(DeviceEvent)) {
        if let Some(code) = error_code(words) {
            return self.on_error(code, event);
        }
        if self.phase == DevicePhase::Naming {
            match model(words).map(Series::of) {
                Some(Some(series)) => {
                    self.series = series;
                    self.enter(DevicePhase::Muting);
                }
                Some(None) => self.refuse(DeviceFault::WrongProduct),
                None => {}
            }
            return;
        }
        let Some(request) = self.phase.request(self.series) else { return };
        match (self.phase, compare(request, words)) {
            (_, Echo::Unrelated) => {}
            (DevicePhase::Configuring, Echo::Other) => self.refuse(DeviceFault::OtherItems),
            (_, Echo::Other) => {}
            (phase, Echo::Same) => {
                self.enter(phase.next());
                if phase == DevicePhase::Resuming {
                    self.fault = None;
                    // Nothing from before is still on its way, and its clock may have been restarted.
                    (self.last_sample, self.last_time_ns) = (Some(now), None);
                    self.clock = HourClock::default();
                }
            }
        }
    }

    fn on_error(&mut self, code: u8, event: &mut impl FnMut(DeviceEvent)) {
        self.counters.errors = self.counters.errors.saturating_add(1);
        event(DeviceEvent::Error(code));
        if self.phase != DevicePhase::Configuring {
            return;
        }
        // A request whose bytes were damaged on the way is asked again.
        match code {
            1..=3 => {}
            code if LINE_TOO_SLOW.contains(&code) => self.refuse(DeviceFault::LineTooSlow),
            code => self.refuse(DeviceFault::Rejected(code)),
        }
    }

    fn on_frame(&mut self, payload: &[u8; 34], now: Stamp, event: &mut impl FnMut(DeviceEvent)) {
        if self.phase == DevicePhase::Refused {
            return;
        }
        let Ok(measurement) = Measurement::decode(payload) else {
            self.counters.refused = self.counters.refused.saturating_add(1);
            return event(DeviceEvent::Refused);
        };
        if self.count(measurement.since_start_ns) {
            self.last_sample = Some(now);
        }
        let forward_left_up = |[x, y, z]: [f32; 3]| [x, -y, -z];
        event(DeviceEvent::Sample(ImuSample {
            stamp: self.stamp(measurement.since_start_ns, now),
            sequence: self.sequence,
            angular_radps: forward_left_up(measurement.angular_radps),
            linear_mps2: forward_left_up(measurement.linear_mps2),
            orientation: None,
            suspect: measurement.is_saturated(),
        }));
    }

    /// The sampling instant of a frame whose last byte arrived at `now`.
    fn stamp(&mut self, since_start_ns: u64, now: Stamp) -> Stamp {
        let bits_us = u64::try_from(FRAME_BYTES).unwrap_or_default().saturating_mul(10_000_000);
        let line_us = bits_us.checked_div(self.baud.into()).unwrap_or_default();
        let sampled = now.minus_micros(line_us.saturating_add(LATENCY_US));
        self.clock.stamp(truncating_u32((since_start_ns / 1_000) % HOUR_US), sampled)
    }

    /// Books a sample by the device's time; `true` if that moved.
    fn count(&mut self, since_start_ns: u64) -> bool {
        self.counters.samples = self.counters.samples.saturating_add(1);
        let last_ns = self.last_time_ns.replace(since_start_ns);
        // A time that went back is a device that was restarted: the next sample, whatever lay between, and a clock to be learned anew.
        if last_ns.is_some_and(|last| since_start_ns < last) {
            self.clock = HourClock::default();
        }
        let passed_ns = last_ns.map_or(PERIOD_NS, |last| match since_start_ns.checked_sub(last) {
            Some(0) => 0,
            Some(passed) => passed.max(PERIOD_NS),
            None => PERIOD_NS,
        });
        let periods = passed_ns.saturating_add(PERIOD_NS / 2) / PERIOD_NS;
        self.sequence = self.sequence.wrapping_add(truncating_u16(truncating_u32(periods.min(0x7FFF))));
        if periods == 0 {
            self.counters.repeated_samples = self.counters.repeated_samples.saturating_add(1);
        }
        let lost = truncating_u32(periods.saturating_sub(1).min(u64::from(u32::MAX)));
        self.counters.lost_samples = self.counters.lost_samples.saturating_add(lost);
        periods != 0
    }
}
