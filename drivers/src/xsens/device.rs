//! The device as a whole: brought to measure, kept measuring, read (book, Xsens MTi: Start-up).
//!
//! Samples are delivered in every phase as long as they are whole: a robot that has to wait for an acknowledgement which
//! some devices never send is worse off than one that uses what it gets.

use floorguard_types::number::{nearest_f32_of_f64, truncating_u64};
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::{Age, Stamp};

use super::clock::SampleClock;
use super::configuration::DeviceConfiguration;
use super::frame::{FrameCounters, FrameReceiver, Message, encode};
use super::item::LocalFrame;
use super::measurement::{Measurement, MeasurementError};
use super::start_up::{DevicePhase, Echo, compare, id, profile};

/// Without a fresh sample for this long the start-up begins again, microseconds (book, Xsens MTi: Start-up).
const SILENCE_US: u64 = 1_000_000;
/// Data bytes of the longest frame that the robot's profile, an answer or a warning needs. A shorter limit than the
/// protocol's 2,048: a length that noise made too large holds up four samples, not thirty.
const DATA_MAX: usize = 254;
/// The device says: output exceeds the line's bandwidth.
const ERROR_OVERFLOW: u8 = 0x29;
/// Fewer samples than this are of no use; a line that cannot carry them is wrong.
const RATE_MIN_HZ: u16 = 25;

/// What the device reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceEvent {
    /// A sample, in the sensor's own axes. The orientation is from the sensor to east-north-up.
    Sample(ImuSample),
    /// A message of no use.
    Refused(MeasurementError),
    /// It reports an error, by its code.
    Error(u8),
    /// It sends another list than configured: rates may be lower.
    OtherConfiguration,
}

/// Why a device that talks is not as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DeviceFault {
    /// Another product than configured; not used.
    WrongProduct,
    /// It will not send the items that the robot needs; not used.
    OtherItems,
    /// It refuses the output configuration with this code; not used.
    Rejected(u8),
    /// It sends less often than asked; used.
    LowerRate,
    /// The line is too slow for the lowest useful rate; not used.
    LineTooSlow,
    /// It never answers and yet sends all that is needed; used.
    NoAnswer,
}

impl core::fmt::Display for DeviceFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::WrongProduct => f.write_str("the inertial sensor is another product than configured"),
            Self::OtherItems => f.write_str("the inertial sensor will not send what it is asked for"),
            Self::Rejected(code) => write!(f, "the inertial sensor rejects its configuration: 0x{code:02X}"),
            Self::LowerRate => f.write_str("the inertial sensor sends less often than asked"),
            Self::LineTooSlow => {
                write!(
                    f,
                    "the line is too slow for {RATE_MIN_HZ} inertial samples per second; raise its baud rate"
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
    /// Samples missing between two, by the packet counter.
    pub lost_samples: u32,
    /// Samples delivered whose packet counter stood still.
    pub repeated_samples: u32,
    /// Messages that lack counter, rate of turn or acceleration.
    pub incomplete: u32,
    /// Messages refused.
    pub refused: u32,
    /// Times that the start-up began.
    pub starts: u32,
    /// Errors reported by the device.
    pub errors: u32,
    /// Warnings reported by the device.
    pub warnings: u32,
}

/// One device. About 2.2 KiB.
#[derive(Clone, Debug)]
pub struct Device {
    configuration: DeviceConfiguration,
    receiver: FrameReceiver,
    phase: DevicePhase,
    clock: SampleClock,
    /// When the request of the phase was sent last.
    sent: Option<Stamp>,
    tries: u8,
    /// Arrival of the newest sample whose counter moved, or when the wait for it began.
    last_sample: Option<Stamp>,
    last_counter: Option<u16>,
    /// Asked for; halves with each overflow of the line.
    rate_hz: u16,
    identifier: u32,
    fault: Option<DeviceFault>,
    counters: DeviceCounters,
    acknowledge: bool,
}

impl Device {
    /// An MTi-30 at a bit rate (ten bits a byte).
    #[must_use]
    pub fn new(baud: u32) -> Self {
        Self::with_configuration(DeviceConfiguration { baud, ..DeviceConfiguration::default() })
    }

    /// A device.
    #[must_use]
    pub fn with_configuration(configuration: DeviceConfiguration) -> Self {
        Self {
            rate_hz: configuration.rate_hz.clamp(1, 400),
            configuration,
            receiver: FrameReceiver::limited(DATA_MAX),
            phase: DevicePhase::default(),
            clock: SampleClock::default(),
            sent: None,
            tries: 0,
            last_sample: None,
            last_counter: None,
            identifier: 0,
            fault: None,
            counters: DeviceCounters { starts: 1, ..DeviceCounters::default() },
            acknowledge: false,
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

    /// Samples per second that it was configured to send.
    #[must_use]
    pub const fn rate_hz(&self) -> u16 {
        self.rate_hz
    }

    /// Its serial number; 0 before it was reported.
    #[must_use]
    pub const fn identifier(&self) -> u32 {
        self.identifier
    }

    /// What happened.
    #[must_use]
    pub const fn counters(&self) -> DeviceCounters {
        self.counters
    }

    /// What happened on the line.
    #[must_use]
    pub const fn frames(&self) -> FrameCounters {
        self.receiver.counters()
    }

    /// Bytes that arrived at `now`, in any portions.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut event: impl FnMut(DeviceEvent)) {
        // The receiver lends its messages while the device changes: it is moved aside for the time.
        let mut receiver = core::mem::take(&mut self.receiver);
        receiver.push(bytes, now, |message, length| self.on_message(message, (length, now), &mut event));
        self.receiver = receiver;
    }

    /// Time has passed: call every 10 to 50 ms and after each push. `send` gets whole frames, at most two.
    pub fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) {
        if core::mem::take(&mut self.acknowledge) {
            transmit(id::WAKE_UP_ACK, &[], send);
        }
        if self.phase == DevicePhase::Measuring {
            let last = *self.last_sample.get_or_insert(now);
            if !matches!(last.age(now), Age::Past(us) if us > SILENCE_US) {
                return;
            }
            self.start();
        }
        let patience = self.phase.patience();
        if self.sent.is_some_and(|sent| matches!(sent.age(now), Age::Past(us) if us < patience.answer_us)) {
            return;
        }
        if self.sent.is_some() && self.tries >= patience.tries {
            self.give_up(patience.then, now);
        }
        match (self.phase, self.phase.request()) {
            (DevicePhase::Configuring, Some(request)) => transmit(request, &profile(self.rate_hz), send),
            (_, Some(request)) => transmit(request, &[], send),
            (_, None) => {}
        }
        self.sent = Some(now);
        self.tries = self.tries.saturating_add(1);
    }

    /// Nothing helped; another way is taken.
    fn give_up(&mut self, then: DevicePhase, now: Stamp) {
        let data_flow =
            self.last_sample.is_some_and(|last| matches!(last.age(now), Age::Past(us) if us < SILENCE_US));
        match (self.phase, then) {
            // Neither a request nor a reset is answered, and yet it sends what is needed.
            (DevicePhase::AfterReset, _) if data_flow => {
                self.fault = Some(DeviceFault::NoAnswer);
                self.enter(DevicePhase::Measuring);
            }
            (_, DevicePhase::GoingToConfig) => self.start(),
            _ => self.enter(then),
        }
    }

    fn start(&mut self) {
        self.counters.starts = self.counters.starts.saturating_add(1);
        self.enter(DevicePhase::GoingToConfig);
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

    fn on_message(
        &mut self,
        message: Message<'_>,
        (length, now): (usize, Stamp),
        event: &mut impl FnMut(DeviceEvent),
    ) {
        let Message { id: message_id, data } = message;
        match (self.phase, message_id) {
            (_, id::DATA) => self.on_data(data, (length, now), event),
            (_, id::WAKE_UP) => {
                // It has just started; with the acknowledgement it goes to configuration by itself.
                self.acknowledge = true;
                self.start();
            }
            (_, id::WARNING) => self.counters.warnings = self.counters.warnings.saturating_add(1),
            (_, id::ERROR) => self.on_error(data.first().copied().unwrap_or_default(), event),
            (DevicePhase::GoingToConfig | DevicePhase::AfterReset, id::CONFIG_ACK) => {
                self.fault = None;
                self.enter(DevicePhase::Identifying);
            }
            (DevicePhase::Resetting, id::RESET_ACK) => self.enter(DevicePhase::AfterReset),
            (DevicePhase::Identifying, id::IDENTIFIER) => {
                self.identifier = data.iter().take(4).fold(0, |sum, byte| (sum << 8) | u32::from(*byte));
                self.enter(DevicePhase::Naming);
            }
            (DevicePhase::Naming, id::PRODUCT) => {
                if data.starts_with(self.configuration.product.as_bytes()) {
                    self.enter(DevicePhase::Configuring);
                } else {
                    self.refuse(DeviceFault::WrongProduct);
                }
            }
            (DevicePhase::Configuring, id::OUTPUT_ACK) => self.on_echo(data, event),
            (DevicePhase::GoingToMeasurement, id::MEASUREMENT_ACK) => {
                self.last_sample = Some(now);
                self.last_counter = None;
                // Its clock may have been restarted, and nothing from before is still on its way.
                self.clock = SampleClock::default();
                self.enter(DevicePhase::Measuring);
            }
            _ => {}
        }
    }

    fn on_echo(&mut self, echoed: &[u8], event: &mut impl FnMut(DeviceEvent)) {
        match compare(&profile(self.rate_hz), echoed) {
            Echo::Same => {}
            Echo::Slower => {
                self.fault = Some(DeviceFault::LowerRate);
                event(DeviceEvent::OtherConfiguration);
            }
            Echo::Other => {
                event(DeviceEvent::OtherConfiguration);
                return self.refuse(DeviceFault::OtherItems);
            }
        }
        self.enter(DevicePhase::GoingToMeasurement);
    }

    fn on_error(&mut self, code: u8, event: &mut impl FnMut(DeviceEvent)) {
        self.counters.errors = self.counters.errors.saturating_add(1);
        event(DeviceEvent::Error(code));
        if code == ERROR_OVERFLOW {
            // Asking for the same again would only repeat it (book, Xsens MTi: Known defects).
            if self.rate_hz / 2 < RATE_MIN_HZ {
                return self.refuse(DeviceFault::LineTooSlow);
            }
            self.rate_hz /= 2;
            self.start();
        } else if self.phase == DevicePhase::Configuring {
            self.refuse(DeviceFault::Rejected(code));
        }
    }

    fn on_data(&mut self, data: &[u8], (length, now): (usize, Stamp), event: &mut impl FnMut(DeviceEvent)) {
        let measurement = match Measurement::decode(data) {
            Ok(measurement) => measurement,
            Err(error) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                return event(DeviceEvent::Refused(error));
            }
        };
        let (Some(sequence), Some(rate), Some(acceleration)) =
            (measurement.packet_counter, measurement.rate_of_turn_radps, measurement.acceleration_mps2)
        else {
            self.counters.incomplete = self.counters.incomplete.saturating_add(1);
            return;
        };
        if self.count(sequence) {
            self.last_sample = Some(now);
        }
        event(DeviceEvent::Sample(ImuSample {
            stamp: self.stamp(measurement.sample_time_fine, length, now),
            sequence,
            angular_radps: rate.map(nearest_f32_of_f64),
            linear_mps2: acceleration.map(nearest_f32_of_f64),
            orientation: orientation(&measurement),
            // Without a status nobody knows that the self-test passed.
            suspect: measurement
                .status
                .is_none_or(|status| status.is_clipping() || !status.self_test_passed()),
        }));
    }

    /// The sampling instant of a frame of `length` bytes whose last byte arrived at `now`.
    fn stamp(&mut self, ticks: Option<u32>, length: usize, now: Stamp) -> Stamp {
        let line_us =
            truncating_u64(length).saturating_mul(10_000_000).checked_div(self.configuration.baud.into());
        let delay_us = line_us.unwrap_or_default().saturating_add(self.configuration.latency_us);
        let sampled = now.minus_micros(delay_us);
        ticks.map_or(sampled, |ticks| self.clock.stamp(ticks, sampled))
    }

    /// Books a sample's counter; `true` if it moved.
    fn count(&mut self, sequence: u16) -> bool {
        self.counters.samples = self.counters.samples.saturating_add(1);
        let step = self.last_counter.replace(sequence).map(|last| sequence.wrapping_sub(last));
        match step {
            Some(0) => {
                self.counters.repeated_samples = self.counters.repeated_samples.saturating_add(1);
                return false;
            }
            // Half the range backwards is a restart, not 32,768 lost samples.
            Some(step @ 2..0x8000) => {
                let missing = u32::from(step).saturating_sub(1);
                self.counters.lost_samples = self.counters.lost_samples.saturating_add(missing);
            }
            _ => {}
        }
        true
    }
}

/// The orientation, where the filter vouches for it and the local frame is the one that was asked for.
fn orientation(measurement: &Measurement) -> Option<[f32; 4]> {
    let vouched = measurement.status.is_some_and(|status| status.filter_valid());
    let quaternion = measurement.quaternion.filter(|_| vouched)?;
    (measurement.quaternion_frame == Some(LocalFrame::EastNorthUp))
        .then(|| quaternion.map(nearest_f32_of_f64))
}

fn transmit(message_id: u8, data: &[u8], send: &mut impl FnMut(&[u8])) {
    if let Some(frame) = encode(message_id, data) {
        send(&frame);
    }
}
