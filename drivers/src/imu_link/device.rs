//! The stream of one bridge: sender, losses, clock; samples with times of the robot's clock.

use floorguard_types::number::{truncating_u16, truncating_u32};
use floorguard_types::sensing::ImuSample;
use floorguard_types::time::Stamp;

use super::frame::{FrameError, SamplesFrame};
use super::receiver::FrameReceiver;
use crate::link::{DatagramOrder, OrderError, lost_before};
use crate::velodyne::HourClock;

const HOUR_US: u64 = 3_600_000_000;
/// The only code of a bridge.
const FAULT_CODE: u8 = 1;

/// What the bridge reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceEvent {
    /// A sample: x forward, y left, z up.
    Sample(ImuSample),
    /// A frame with numbers that cannot have been measured.
    Refused,
    /// Its sensor says that it is at fault.
    Error(u8),
}

/// Why frames are of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DeviceFault {
    /// They are none of samples.
    Frame(FrameError),
    /// They are another sender's, or out of order; the sequence is that of their first sample.
    Order(OrderError),
}

impl DeviceFault {
    /// The same up to its figures, which are others for each frame.
    fn is_alike(self, other: Self) -> bool {
        use core::mem::discriminant;
        match (self, other) {
            (Self::Frame(one), Self::Frame(other)) => discriminant(&one) == discriminant(&other),
            (Self::Order(one), Self::Order(other)) => discriminant(&one) == discriminant(&other),
            (one, other) => discriminant(&one) == discriminant(&other),
        }
    }
}

impl core::fmt::Display for DeviceFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Frame(error) => write!(f, "{error}"),
            Self::Order(error) => write!(f, "inertial frame of {error}"),
        }
    }
}

impl core::error::Error for DeviceFault {}

/// Counts; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeviceCounters {
    /// Samples delivered.
    pub samples: u32,
    /// Frames refused, for any reason.
    pub refused: u32,
    /// Samples missing between two frames.
    pub lost: u32,
}

/// Decodes the stream of one bridge.
#[derive(Clone, Debug, Default)]
pub struct Device {
    receiver: FrameReceiver,
    link: Link,
}

#[derive(Clone, Debug, Default)]
struct Link {
    order: DatagramOrder,
    clock: HourClock,
    counters: DeviceCounters,
    fault: Option<DeviceFault>,
}

impl Device {
    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> DeviceCounters {
        self.link.counters
    }

    /// Why the newest kind of refused frames was refused.
    #[must_use]
    pub const fn fault(&self) -> Option<DeviceFault> {
        self.link.fault
    }

    /// Bytes that arrived at `now`, in any portions.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut event: impl FnMut(DeviceEvent)) {
        let Self { receiver, link } = self;
        receiver.push(bytes, |found| {
            let taken = found.map_err(DeviceFault::Frame).and_then(|frame| {
                link.lost_before(&frame, now).map_err(DeviceFault::Order).map(|lost| (frame, lost))
            });
            match taken {
                Ok((frame, lost)) => link.take(&frame, (lost, now), &mut event),
                Err(fault) => link.refuse(fault, &mut event),
            }
        });
    }
}

impl Link {
    fn take(
        &mut self,
        frame: &SamplesFrame<'_>,
        (lost, now): (u32, Stamp),
        event: &mut impl FnMut(DeviceEvent),
    ) {
        self.counters.lost = self.counters.lost.saturating_add(lost);
        let later = u32::from(frame.count().saturating_sub(1));
        let sequence = frame.sequence().wrapping_add(later);
        self.order.accept(frame.sender(), sequence, now);
        // The newest sample arrived after it was measured: none is of the future.
        let took_us = u64::from(frame.between_us().saturating_mul(later));
        let sensor_us = truncating_u32(frame.first_sample_us().wrapping_add(took_us) % HOUR_US);
        let newest = self.clock.stamp(sensor_us, now);
        for (number, sample) in (0_u32..).zip(frame.samples()) {
            if sample.is_fault {
                event(DeviceEvent::Error(FAULT_CODE));
            }
            let before_us = u64::from(frame.between_us().saturating_mul(later.saturating_sub(number)));
            self.counters.samples = self.counters.samples.saturating_add(1);
            event(DeviceEvent::Sample(ImuSample {
                stamp: newest.minus_micros(before_us),
                sequence: truncating_u16(frame.sequence().wrapping_add(number)),
                angular_radps: sample.angular_radps,
                linear_mps2: sample.linear_mps2,
                orientation: None,
                suspect: sample.is_saturated || sample.is_fault,
            }));
        }
    }

    fn refuse(&mut self, fault: DeviceFault, event: &mut impl FnMut(DeviceEvent)) {
        self.counters.refused = self.counters.refused.saturating_add(1);
        // Another frame may be damaged, or a stranger's, and says nothing about the sensor.
        if matches!(fault, DeviceFault::Frame(FrameError::Value { .. })) {
            event(DeviceEvent::Refused);
        }
        if !self.fault.is_some_and(|known| known.is_alike(fault)) {
            self.fault = Some(fault);
        }
    }

    fn lost_before(&self, frame: &SamplesFrame<'_>, now: Stamp) -> Result<u32, OrderError> {
        lost_before(self.order.newest(frame.sender(), now)?, frame.sequence())
    }
}
