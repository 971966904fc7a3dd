//! Hokuyo UST and URG as scanners: the device of SCIP 2.0, its scans as the guard takes them.

use floorguard_types::number::{nearest_f32, saturating_u64, truncating_u32};
use floorguard_types::profile::{List, Native, Profile};
use floorguard_types::sensing::ScanOf;
use floorguard_types::time::Stamp;

use super::contract::{RangingEvent, RangingScanner};
use crate::scip::{Device, DeviceConfiguration, DeviceEvent, MeasuredScan, RangeKind, ScanRange, Status};

/// All of a UST-10LX or UST-20LX: 270°, up to 30 m.
pub const UST_FULL: DeviceConfiguration = DeviceConfiguration {
    kind: RangeKind::Distance,
    range: ScanRange { first_step: 0, last_step: 1_080, cluster: 1 },
    interval: 0,
    byte_us: 0.0,
    farthest_mm: 30_000,
};
/// All of a URG-04LX: 240°, up to the 4 m that its maker warrants.
pub const URG_04LX_FULL: DeviceConfiguration = DeviceConfiguration {
    kind: RangeKind::Distance,
    range: ScanRange { first_step: 44, last_step: 725, cluster: 1 },
    interval: 0,
    byte_us: 0.0,
    farthest_mm: 4_000,
};

/// One sensor.
///
/// ```
/// use floorguard_drivers::ranging::{Hokuyo, RangingScanner, UST_FULL};
/// use floorguard_types::time::Stamp;
///
/// let mut scanner = Hokuyo::new(UST_FULL);
/// let mut sent = Vec::new();
/// scanner.poll(Stamp::ZERO, &mut |bytes| sent.extend_from_slice(bytes), &mut |_| {});
/// assert_eq!(sent, b"SCIP2.0\n");
/// ```
#[derive(Clone, Debug)]
pub struct HokuyoOf<P: Profile> {
    device: Device,
    scan: ScanOf<P>,
}

/// For the scanners of the target.
pub type Hokuyo = HokuyoOf<Native>;

impl<P: Profile> HokuyoOf<P> {
    /// Nothing was asked yet.
    #[must_use]
    pub fn new(configuration: DeviceConfiguration) -> Self {
        Self { device: Device::new(configuration), scan: ScanOf::EMPTY }
    }

    /// What happened so far, and how well the sensor's time is known.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }
}

impl<P: Profile> RangingScanner<P> for HokuyoOf<P> {
    fn push(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(RangingEvent<'_, P>)) {
        let Self { device, scan } = self;
        device.push(bytes, now, |found| match found {
            DeviceEvent::Scan(measured) => {
                take(scan, measured);
                event(RangingEvent::Scan(scan));
            }
            DeviceEvent::Parameters(_) => {}
            DeviceEvent::Fault(Status::Trouble(code)) => event(RangingEvent::Fault(u16::from(code))),
            DeviceEvent::Fault(_) => event(RangingEvent::StandBy),
            DeviceEvent::Unsuitable(_) => event(RangingEvent::Unsuitable),
            DeviceEvent::Refused(_) => event(RangingEvent::Refused),
            DeviceEvent::Silent => event(RangingEvent::Silent),
        });
    }

    fn poll(
        &mut self,
        now: Stamp,
        send: &mut impl FnMut(&[u8]),
        event: &mut impl FnMut(RangingEvent<'_, P>),
    ) {
        let is_silent = self.device.poll(now, &mut |bytes| send(bytes));
        if is_silent {
            event(RangingEvent::Silent);
        }
    }
}

/// The measurement as a scan, with the middle of it as its time. The sensor's clock is its counter: one that stands still is a sensor
/// that repeats itself.
fn take<P: Profile>(scan: &mut ScanOf<P>, measured: &MeasuredScan) {
    let steps = nearest_f32(measured.beams.len().saturating_sub(1));
    let half_us = saturating_u64(0.5 * steps * measured.beam_period_us);
    scan.stamp = measured.first_beam.plus_micros(half_us);
    scan.sequence = truncating_u32(measured.first_beam.as_micros() / 1_000);
    (scan.first_angle_rad, scan.step_rad) = (measured.first_angle_rad, measured.step_rad);
    scan.beams.clear();
    for beam in &measured.beams {
        // A scan that does not fit has fewer beams than the guard expects, and is refused there.
        let _full = scan.beams.push(*beam);
    }
}
