//! One sensor on its line: asked to measure step by step, its answers as samples.
//!
//! It is stopped first, because it may still send what another program asked for; then its health is asked for, its motor set going,
//! and it is asked to measure. Firmware before 1.24 knows one way to be asked, later one another: they are tried in turn.

use floorguard_types::time::Stamp;
use heapless::Vec;

use super::answer::{AnswerKind, DESCRIPTOR_BYTES, Descriptor, NODE_BYTES, Sample, decode_node, request};
use super::capsule::{CAPSULE_BYTES, Capsule, is_first, is_second};

const STOP: u8 = 0x25;
const GET_HEALTH: u8 = 0x52;
const SET_MOTOR_DUTY: u8 = 0xF0;
const EXPRESS_SCAN: u8 = 0x82;
/// Of 1,023: what the maker's own driver sets.
const DUTY: u16 = 660;
/// Between two requests: after a stop the sensor hears nothing for a millisecond, and after others for up to ten.
const STEP_US: u64 = 20_000;
/// The motor takes seconds until the sensor measures.
const START_US: u64 = 5_000_000;
/// A sensor that measured and sends nothing for so long is asked again.
const SILENCE_US: u64 = 1_000_000;
/// A line on which so little is understood is asked anew: each byte that fits nothing counts eightfold, each sample once less.
const REFUSED_WEIGHT: u16 = 8;
const REFUSED_MAX: u16 = 800;
/// Health: it measures no more until it is switched off.
const IN_TROUBLE: u8 = 2;

/// Which series the sensor is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceFamily {
    /// A1, A2, A3: the motor is set going by the adapter.
    A,
    /// S1, S2, S3, C1: the motor turns by itself.
    S,
}

/// What a sensor reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceEvent {
    /// A measurement.
    Sample(Sample),
    /// It is in trouble: its code.
    Fault(u16),
    /// It sends samples in a form that is not read: the kind of its answer.
    Unsuitable(u8),
    /// Bytes that are no answer.
    Refused,
}

/// What the next byte belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expected {
    Descriptor,
    Health,
    Samples(AnswerKind),
}

/// One sensor.
///
/// ```
/// use floorguard_drivers::rplidar::{Device, DeviceEvent, DeviceFamily, Sample};
/// use floorguard_types::time::Stamp;
///
/// let mut device = Device::new(DeviceFamily::S);
/// let mut sent = Vec::new();
/// device.poll(Stamp::ZERO, &mut |bytes| sent.extend_from_slice(bytes));
/// assert_eq!(sent, [0xA5, 0x25], "first of all it is stopped");
///
/// let mut samples = Vec::new();
/// let answer = [0xA5, 0x5A, 5, 0, 0, 0x40, 0x81, 0x3D, 0x01, 0x2D, 0xA0, 0x0F];
/// device.push(&answer, Stamp::from_micros(60_000), &mut |event| samples.push(event));
/// assert_eq!(samples, [DeviceEvent::Sample(Sample { angle_q6: 90 * 64, range_mm: 1_000 })]);
/// ```
#[derive(Clone, Debug)]
pub struct Device {
    family: DeviceFamily,
    expected: Expected,
    bytes: Vec<u8, CAPSULE_BYTES>,
    previous: Option<Capsule>,
    /// The next request, and when the last one was sent.
    step: u8,
    asked: Option<Stamp>,
    /// Samples came.
    heard: Option<Stamp>,
    /// How much of what comes fits nothing.
    refused: u16,
    /// How it is asked to measure: 1 by newer firmware, 0 by older.
    mode: u8,
}

impl Device {
    /// Nothing was asked yet.
    #[must_use]
    pub const fn new(family: DeviceFamily) -> Self {
        Self {
            family,
            expected: Expected::Descriptor,
            bytes: Vec::new(),
            previous: None,
            step: 0,
            asked: None,
            heard: None,
            refused: 0,
            mode: 1,
        }
    }

    /// Sends the request that is due; `true`: it had measured, and is silent, or is not understood.
    pub fn poll(&mut self, now: Stamp, send: &mut impl FnMut(&[u8])) -> bool {
        let is_over = |since: Option<Stamp>, wait_us| since.is_none_or(|since| since.past_us(now) >= wait_us);
        let was_heard = self.heard.is_some();
        let is_silent = was_heard && (is_over(self.heard, SILENCE_US) || self.refused > REFUSED_MAX);
        let is_lost = !was_heard && self.step > 3 && is_over(self.asked, START_US);
        if is_silent || is_lost {
            (self.step, self.heard, self.refused) = (0, None, 0);
            self.mode = if is_lost { self.mode ^ 1 } else { self.mode };
        }
        if self.step <= 3 && !was_heard && is_over(self.asked, STEP_US) {
            self.ask(send);
            self.asked = Some(now);
            self.step = self.step.saturating_add(1);
        }
        is_silent
    }

    fn ask(&mut self, send: &mut impl FnMut(&[u8])) {
        match self.step {
            0 => request(STOP, &[], send),
            1 => {
                // What it was still sending has come.
                self.wait_for(Expected::Descriptor);
                request(GET_HEALTH, &[], send);
            }
            2 if self.family == DeviceFamily::A => request(SET_MOTOR_DUTY, &DUTY.to_le_bytes(), send),
            2 => {}
            _ => request(EXPRESS_SCAN, &[self.mode, 0, 0, 0, 0], send),
        }
    }

    fn wait_for(&mut self, expected: Expected) {
        self.expected = expected;
        self.bytes.clear();
        self.previous = None;
    }

    /// Takes bytes that arrived at a time.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(DeviceEvent)) {
        for byte in bytes {
            // Never full: each kind of answer takes its bytes out when it is whole.
            let _full = self.bytes.push(*byte);
            match self.expected {
                Expected::Descriptor => self.find_descriptor(event),
                Expected::Health => self.take_health(event),
                Expected::Samples(AnswerKind::Node) => self.take_node(now, event),
                Expected::Samples(kind) => self.take_capsule((kind, now), event),
            }
        }
    }

    fn find_descriptor(&mut self, event: &mut impl FnMut(DeviceEvent)) {
        let Some(bytes) = self.whole::<DESCRIPTOR_BYTES>() else { return };
        let Some(descriptor) = Descriptor::decode(&bytes) else {
            self.drop_first();
            return;
        };
        if descriptor == Descriptor::HEALTH {
            self.wait_for(Expected::Health);
        } else if let Some(kind) = descriptor.samples() {
            self.wait_for(Expected::Samples(kind));
        } else {
            self.wait_for(Expected::Descriptor);
            event(DeviceEvent::Unsuitable(descriptor.kind));
        }
    }

    fn take_health(&mut self, event: &mut impl FnMut(DeviceEvent)) {
        let Some([status, low, high]) = self.whole() else { return };
        self.wait_for(Expected::Descriptor);
        if status >= IN_TROUBLE {
            event(DeviceEvent::Fault(u16::from_le_bytes([low, high])));
        }
    }

    fn take_node(&mut self, now: Stamp, event: &mut impl FnMut(DeviceEvent)) {
        let Some(bytes) = self.whole::<NODE_BYTES>() else { return };
        match decode_node(&bytes) {
            Ok(sample) => {
                self.bytes.clear();
                self.understand(1, now);
                event(DeviceEvent::Sample(sample));
            }
            Err(_) => {
                self.drop_first();
                self.refuse(event);
            }
        }
    }

    fn take_capsule(&mut self, (kind, now): (AnswerKind, Stamp), event: &mut impl FnMut(DeviceEvent)) {
        let starts = match *self.bytes.as_slice() {
            [first] => is_first(first),
            [_, second] => is_second(second),
            _ => true,
        };
        if !starts {
            // A byte was lost, or one too many came.
            self.bytes.clear();
            self.refuse(event);
            return;
        }
        let Some(bytes) = self.whole::<CAPSULE_BYTES>() else { return };
        let Ok(capsule) = Capsule::new_checked(kind, &bytes) else {
            self.keep_from_next_start();
            self.refuse(event);
            return;
        };
        self.bytes.clear();
        self.understand(32, now);
        let previous = self.previous.replace(capsule).filter(|_| !capsule.is_first());
        for sample in previous.iter().flat_map(|previous| previous.samples(&capsule)) {
            event(DeviceEvent::Sample(sample));
        }
    }

    fn understand(&mut self, samples: u16, now: Stamp) {
        self.heard = Some(now);
        self.refused = self.refused.saturating_sub(samples);
    }

    fn refuse(&mut self, event: &mut impl FnMut(DeviceEvent)) {
        self.previous = None;
        self.refused = self.refused.saturating_add(REFUSED_WEIGHT);
        event(DeviceEvent::Refused);
    }

    /// Of a damaged capsule, what may begin the next one.
    fn keep_from_next_start(&mut self) {
        let begins = |at: &usize| {
            let second = self.bytes.get(at.saturating_add(1));
            self.bytes.get(*at).is_some_and(|byte| is_first(*byte))
                && second.is_none_or(|byte| is_second(*byte))
        };
        let start = (1..CAPSULE_BYTES).find(begins).unwrap_or(CAPSULE_BYTES).min(self.bytes.len());
        self.bytes.rotate_left(start);
        self.bytes.truncate(self.bytes.len().saturating_sub(start));
    }

    /// What has come, if it is so many bytes.
    fn whole<const N: usize>(&self) -> Option<[u8; N]> {
        <[u8; N]>::try_from(self.bytes.as_slice()).ok()
    }

    fn drop_first(&mut self) {
        if !self.bytes.is_empty() {
            self.bytes.remove(0);
        }
    }
}
