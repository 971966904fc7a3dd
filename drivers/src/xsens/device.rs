//! The device as a whole: brought to measure, kept measuring, read (wire-formats 5.2).

use floorguard_core::sensing::ImuSample;
use floorguard_core::time::{Age, Stamp};

use super::clock::DeviceClock;
use super::frame::{FrameCounters, FrameReceiver, Message, encode};
use super::measurement::{Measurement, MeasurementError};

/// Robot profile of wire-formats 5.4: counter, fine time, quaternion, acceleration, rate of turn at 100 Hz, status.
const PROFILE: [u8; 24] = [
    0x10, 0x20, 0xFF, 0xFF, 0x10, 0x60, 0xFF, 0xFF, 0x20, 0x10, 0x00, 0x64, 0x40, 0x20, 0x00, 0x64, 0x80,
    0x20, 0x00, 0x64, 0xE0, 0x20, 0xFF, 0xFF,
];
/// An answer that is later than this is asked for again, microseconds.
const ANSWER_US: u64 = 100_000;
/// Tries before the device is reset.
const TRIES_MAX: u8 = 5;
/// Tries after a reset: 2 s.
const RESET_TRIES_MAX: u8 = 20;
/// Without data for this long the start-up begins again, microseconds.
const SILENCE_US: u64 = 1_000_000;

/// How far the start-up is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DevicePhase {
    /// Asked to stop measuring.
    #[default]
    GoingToConfig,
    /// Reset, because it did not answer.
    Resetting,
    /// Asked for its number.
    Identifying,
    /// Asked for its name.
    Naming,
    /// Told what to send.
    Configuring,
    /// Told to measure.
    GoingToMeasurement,
    /// Measures.
    Measuring,
}

impl DevicePhase {
    const fn request(self) -> (u8, &'static [u8]) {
        match self {
            Self::GoingToConfig => (0x30, &[]),
            Self::Resetting => (0x40, &[]),
            Self::Identifying => (0x00, &[]),
            Self::Naming => (0x1C, &[]),
            Self::Configuring => (0xC0, &PROFILE),
            Self::GoingToMeasurement => (0x10, &[]),
            // Nothing is asked while it measures.
            Self::Measuring => (0x12, &[]),
        }
    }
}

/// What the device told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceEvent {
    /// A sample, in the sensor's own axes.
    Sample(ImuSample),
    /// A message of no use.
    Refused(MeasurementError),
    /// It reports an error, by its code.
    Error(u8),
    /// It sends another list than it was told to: rates may be lower.
    OtherConfiguration,
}

/// What happened; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceCounters {
    /// Samples delivered.
    pub samples: u32,
    /// Samples missing between two, by the packet counter.
    pub lost_samples: u32,
    /// Messages refused.
    pub refused: u32,
    /// Times that the start-up began.
    pub starts: u32,
    /// Errors reported by the device.
    pub errors: u32,
}

/// One device.
#[derive(Clone, Debug)]
pub struct Device {
    receiver: FrameReceiver,
    phase: DevicePhase,
    clock: DeviceClock,
    /// Microseconds that a byte takes on the line.
    byte_us: u64,
    sent: Option<Stamp>,
    tries: u8,
    last_data: Option<Stamp>,
    last_counter: Option<u16>,
    identifier: u32,
    counters: DeviceCounters,
    acknowledge: bool,
}

impl Device {
    /// A device at a bit rate (ten bits a byte).
    #[must_use]
    pub fn new(baud: u32) -> Self {
        Self {
            receiver: FrameReceiver::new(),
            phase: DevicePhase::default(),
            clock: DeviceClock::default(),
            byte_us: 10_000_000_u64.checked_div(u64::from(baud)).unwrap_or(87),
            sent: None,
            tries: 0,
            last_data: None,
            last_counter: None,
            identifier: 0,
            counters: DeviceCounters::default(),
            acknowledge: false,
        }
    }

    /// How far the start-up is.
    #[must_use]
    pub const fn phase(&self) -> DevicePhase {
        self.phase
    }

    /// Its serial number; 0 before it has told.
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

    /// Time has passed: call every 10 to 50 ms and after each push. `send` gets whole frames.
    pub fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) {
        if core::mem::take(&mut self.acknowledge) {
            transmit(0x3F, &[], send);
        }
        if self.phase == DevicePhase::Measuring {
            let last = *self.last_data.get_or_insert(now);
            if !matches!(last.age(now), Age::Past(us) if us <= SILENCE_US) {
                self.enter(DevicePhase::GoingToConfig);
            }
            return;
        }
        let waits = self.sent.is_some_and(|sent| matches!(sent.age(now), Age::Past(us) if us < ANSWER_US));
        if waits {
            return;
        }
        self.retry(now);
        if self.phase == DevicePhase::GoingToConfig && self.tries == 0 {
            self.counters.starts = self.counters.starts.saturating_add(1);
        }
        let (id, data) = self.phase.request();
        if self.phase != DevicePhase::Measuring {
            transmit(id, data, send);
        }
        self.sent = Some(now);
        self.tries = self.tries.saturating_add(1);
    }

    /// After too many tries another way is taken.
    fn retry(&mut self, now: Stamp) {
        let data_flow =
            self.last_data.is_some_and(|last| matches!(last.age(now), Age::Past(us) if us < ANSWER_US));
        let (tries_max, next) = match self.phase {
            DevicePhase::GoingToConfig => (TRIES_MAX, DevicePhase::Resetting),
            // A reset is sent once; the request to configure is what is repeated, up to 2 s.
            DevicePhase::Resetting => (1, DevicePhase::GoingToConfig),
            _ => (TRIES_MAX, DevicePhase::GoingToConfig),
        };
        if self.tries < tries_max {
            return;
        }
        // It never answers and yet sends what is needed: better than a robot that stands.
        if data_flow
            && self.phase == DevicePhase::Resetting
            && self.counters.starts > u32::from(RESET_TRIES_MAX)
        {
            self.enter(DevicePhase::Measuring);
            return;
        }
        self.enter(next);
    }

    fn enter(&mut self, phase: DevicePhase) {
        self.phase = phase;
        self.sent = None;
        self.tries = 0;
    }

    fn on_message(
        &mut self,
        message: Message<'_>,
        (length, now): (usize, Stamp),
        event: &mut impl FnMut(DeviceEvent),
    ) {
        match (self.phase, message.id) {
            (_, 0x36) => self.on_data(message.data, (length, now), event),
            (_, 0x3E) => {
                // It has just started; with the acknowledgement it goes to configuration by itself.
                self.acknowledge = true;
                self.enter(DevicePhase::Identifying);
            }
            (_, 0x42) => {
                self.counters.errors = self.counters.errors.saturating_add(1);
                event(DeviceEvent::Error(message.data.first().copied().unwrap_or_default()));
            }
            (DevicePhase::GoingToConfig, 0x31) => self.enter(DevicePhase::Identifying),
            (DevicePhase::Resetting, 0x41) => self.enter(DevicePhase::GoingToConfig),
            (DevicePhase::Identifying, 0x01) => {
                self.identifier =
                    message.data.iter().take(4).fold(0, |id, byte| (id << 8) | u32::from(*byte));
                self.enter(DevicePhase::Naming);
            }
            (DevicePhase::Naming, 0x1D) => self.enter(DevicePhase::Configuring),
            (DevicePhase::Configuring, 0xC1) => {
                if message.data != PROFILE {
                    event(DeviceEvent::OtherConfiguration);
                }
                self.enter(DevicePhase::GoingToMeasurement);
            }
            (DevicePhase::GoingToMeasurement, 0x11) => {
                self.last_data = Some(now);
                self.enter(DevicePhase::Measuring);
            }
            _ => {}
        }
    }

    fn on_data(&mut self, data: &[u8], (length, now): (usize, Stamp), event: &mut impl FnMut(DeviceEvent)) {
        let measurement = match Measurement::decode(data) {
            Ok(measurement) => measurement,
            Err(error) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                event(DeviceEvent::Refused(error));
                return;
            }
        };
        self.last_data = Some(now);
        let (Some(rate), Some(acceleration)) =
            (measurement.rate_of_turn_radps, measurement.acceleration_mps2)
        else {
            return;
        };
        let line_us = self.byte_us.saturating_mul(length as u64);
        let stamp = match measurement.sample_time_fine {
            Some(ticks) => self.clock.stamp(ticks, now, line_us),
            None => now.minus_micros(line_us),
        };
        let sequence = measurement.packet_counter.unwrap_or_default();
        self.count(sequence);
        let suspect =
            measurement.status.is_some_and(|status| status.is_clipping() || !status.self_test_passed());
        event(DeviceEvent::Sample(ImuSample {
            stamp,
            sequence,
            angular_radps: rate.map(|number| number as f32),
            linear_mps2: acceleration.map(|number| number as f32),
            orientation: measurement.quaternion.map(|parts| parts.map(|part| part as f32)),
            suspect,
        }));
    }

    fn count(&mut self, sequence: u16) {
        self.counters.samples = self.counters.samples.saturating_add(1);
        if let Some(last) = self.last_counter.replace(sequence) {
            let missing = sequence.wrapping_sub(last).saturating_sub(1);
            // Half the range backwards is a restart, not 32,768 lost samples.
            if missing < 0x8000 {
                self.counters.lost_samples = self.counters.lost_samples.saturating_add(u32::from(missing));
            }
        }
    }
}

fn transmit(id: u8, data: &[u8], send: &mut impl FnMut(&[u8])) {
    if let Some(frame) = encode(id, data) {
        send(&frame);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn at(ms: u64) -> Stamp {
        Stamp::from_micros(ms * 1_000)
    }

    fn sent(device: &mut Device, ms: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        device.poll(at(ms), &mut |frame| bytes.extend_from_slice(frame));
        bytes
    }

    fn answer(device: &mut Device, ms: u64, id: u8, data: &[u8]) {
        device.push(&encode(id, data).unwrap(), at(ms), |_| {});
    }

    fn data_frame(counter: u16) -> Vec<u8> {
        let mut data = std::vec![0x10, 0x20, 2];
        data.extend(counter.to_be_bytes());
        for id in [0x40_u8, 0x80] {
            data.extend([id, 0x20, 12]);
            data.extend([0; 12]);
        }
        encode(0x36, &data).unwrap().to_vec()
    }

    /// The start-up of wire-formats 5.2 with its published frames, while data keep coming.
    #[test]
    fn start_up() {
        let mut device = Device::new(115_200);
        assert_eq!(sent(&mut device, 0), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
        let mut samples = 0;
        device.push(&data_frame(1), at(5), |_| samples += 1);
        assert_eq!(samples, 1);
        assert_eq!(sent(&mut device, 50), []);
        assert_eq!(sent(&mut device, 100), [0xFA, 0xFF, 0x30, 0x00, 0xD1]);
        answer(&mut device, 110, 0x31, &[]);
        assert_eq!(sent(&mut device, 110), [0xFA, 0xFF, 0x00, 0x00, 0x01]);
        answer(&mut device, 120, 0x01, &[3, 0x78, 0, 0x2A]);
        assert_eq!(device.identifier(), 0x0378_002A);
        assert_eq!(sent(&mut device, 120), [0xFA, 0xFF, 0x1C, 0x00, 0xE5]);
        answer(&mut device, 130, 0x1D, b"MTi-30");
        let configure = sent(&mut device, 130);
        assert_eq!((configure.len(), configure[28]), (29, 0x33));
        answer(&mut device, 140, 0xC1, &PROFILE);
        assert_eq!(sent(&mut device, 140), [0xFA, 0xFF, 0x10, 0x00, 0xF1]);
        answer(&mut device, 150, 0x11, &[]);
        assert_eq!(device.phase(), DevicePhase::Measuring);
        assert_eq!(sent(&mut device, 1_000), []);
    }

    #[test]
    fn no_answer_leads_to_a_reset_and_a_restart_of_the_device_to_a_new_start() {
        let mut device = Device::new(115_200);
        let mut reset = 0;
        for ms in (0..1_000).step_by(50) {
            reset += sent(&mut device, ms).windows(3).filter(|bytes| *bytes == [0xFA, 0xFF, 0x40]).count();
        }
        assert_eq!(reset, 1);
        answer(&mut device, 1_000, 0x3E, &[]);
        let bytes = sent(&mut device, 1_001);
        assert!(bytes.starts_with(&[0xFA, 0xFF, 0x3F, 0x00, 0xC2]), "{bytes:02X?}");
        assert_eq!(device.phase(), DevicePhase::Identifying);
    }

    #[test]
    fn silence_starts_over_and_lost_samples_are_counted() {
        let mut device = Device::new(115_200);
        device.enter(DevicePhase::Measuring);
        for (ms, counter) in [(0, 65_534), (10, 65_535), (20, 2)] {
            device.push(&data_frame(counter), at(ms), |_| {});
        }
        assert_eq!(device.counters().lost_samples, 2);
        assert_eq!(sent(&mut device, 900), []);
        sent(&mut device, 1_100);
        assert_eq!(device.phase(), DevicePhase::GoingToConfig);
    }
}
