//! RPLidars as scanners: the samples of a turn of the head, put into even beams.
//!
//! The head measures where it happens to look, and turns as fast as its motor does. A beam holds the nearest return of all samples
//! that were measured within it; one without a return, or without a sample, is unknown.

use floorguard_types::number::truncating_usize;
use floorguard_types::profile::{List, Native, Profile};
use floorguard_types::sensing::{BeamReturn, ScanOf};
use floorguard_types::time::Stamp;
use floorguard_types::units::RADIANS_PER_DEGREE;

use super::contract::{RangingEvent, RangingScanner};
use crate::rplidar::{Device, DeviceEvent, DeviceFamily, Sample};

/// A turn, sixty-fourths of a degree.
const TURN_Q6: u32 = 360 * 64;
/// Beams of the finest turn.
const BEAMS_MAX: u16 = 720;
/// A turn ends in the front if the head has looked back within it: samples near the front need not rise.
const BACK_Q6: core::ops::Range<u16> = 150 * 64..210 * 64;

/// What the sensor is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RplidarConfiguration {
    /// How it is set going.
    pub family: DeviceFamily,
    /// Even beams of a turn; so wide that each holds a sample.
    pub beams: u16,
    /// What it measures nearer or farther than this is not believed, millimetres.
    pub range_mm: [u16; 2],
    /// From a sample to its arrival at most: it waits for its capsule, and that for the next, microseconds.
    pub delay_us: u64,
}

/// A1, A2, A3 and C1: 4,000 samples a second or more; beams of 1.2°.
pub const RPLIDAR_A: RplidarConfiguration =
    RplidarConfiguration { family: DeviceFamily::A, beams: 300, range_mm: [150, 12_000], delay_us: 25_000 };
/// S1, S2 and S3: 9,200 samples a second or more; beams of 0.5°.
pub const RPLIDAR_S: RplidarConfiguration =
    RplidarConfiguration { family: DeviceFamily::S, beams: 720, range_mm: [50, 30_000], delay_us: 12_000 };

/// One sensor.
///
/// ```
/// use floorguard_drivers::ranging::{RPLIDAR_S, RangingScanner, Rplidar};
/// use floorguard_types::time::Stamp;
///
/// let mut scanner = Rplidar::new(RPLIDAR_S);
/// let mut sent = Vec::new();
/// scanner.poll(Stamp::ZERO, &mut |bytes| sent.extend_from_slice(bytes), &mut |_| {});
/// assert_eq!(sent, [0xA5, 0x25]);
/// ```
#[derive(Clone, Debug)]
pub struct RplidarOf<P: Profile> {
    configuration: RplidarConfiguration,
    device: Device,
    /// The turn that the head is in.
    turn: TurnOf<P>,
}

/// A turn of the head.
#[derive(Clone, Debug)]
struct TurnOf<P: Profile> {
    /// When its first sample came; `None`: the head was beyond the front when it was first heard.
    begun: Option<Stamp>,
    has_looked_back: bool,
    scan: ScanOf<P>,
}

/// For the scanners of the target.
pub type Rplidar = RplidarOf<Native>;

impl<P: Profile> RplidarOf<P> {
    /// Nothing was asked yet.
    #[must_use]
    pub fn new(configuration: RplidarConfiguration) -> Self {
        let turn = TurnOf { begun: None, has_looked_back: false, scan: ScanOf::EMPTY };
        let mut scanner = Self { configuration, device: Device::new(configuration.family), turn };
        scanner.turn.begin(&configuration, None);
        scanner
    }
}

impl<P: Profile> TurnOf<P> {
    fn begin(&mut self, configuration: &RplidarConfiguration, now: Option<Stamp>) {
        (self.begun, self.has_looked_back) = (now, false);
        let step_deg = 360.0 / f32::from(configuration.beams.max(1));
        self.scan.step_rad = step_deg * RADIANS_PER_DEGREE;
        self.scan.first_angle_rad = -180.0 * RADIANS_PER_DEGREE;
        self.scan.beams.clear();
        for _ in (0..BEAMS_MAX).take(usize::from(configuration.beams)) {
            // A scan that does not fit has fewer beams than the guard expects, and is refused there.
            let _full = self.scan.beams.push(BeamReturn::Unknown);
        }
    }

    /// A sample begins the next turn.
    fn is_over(&self, sample: Sample) -> bool {
        self.has_looked_back && sample.angle_q6 < BACK_Q6.start
    }

    fn enter(&mut self, sample: Sample, configuration: &RplidarConfiguration) {
        self.has_looked_back |= BACK_Q6.contains(&sample.angle_q6);
        let [nearest_mm, farthest_mm] = configuration.range_mm;
        if !(nearest_mm..=farthest_mm).contains(&sample.range_mm) {
            return;
        }
        // The first beam looks back; the sensor counts clockwise from the front, beams counter-clockwise.
        let from_back_q6 = (TURN_Q6 + TURN_Q6 / 2).saturating_sub(u32::from(sample.angle_q6)) % TURN_Q6;
        let beams = u32::from(configuration.beams);
        let beam = (from_back_q6.saturating_mul(beams).saturating_add(TURN_Q6 / 2) / TURN_Q6) % beams.max(1);
        let Some(beam) = self.scan.beams.get_mut(truncating_usize(beam)) else { return };
        let is_nearer = match *beam {
            BeamReturn::Hit(range_mm) => sample.range_mm < range_mm,
            BeamReturn::Free(_) | BeamReturn::Unknown => true,
        };
        if is_nearer {
            *beam = BeamReturn::Hit(sample.range_mm);
        }
    }

    /// The time of a turn is that of its middle.
    fn stamp(&self, now: Stamp, delay_us: u64) -> Option<Stamp> {
        let begun = self.begun?;
        let half_us = begun.past_us(now) / 2;
        Some(begun.plus_micros(half_us).minus_micros(delay_us))
    }
}

impl<P: Profile> RplidarOf<P> {
    fn take(
        turn: &mut TurnOf<P>,
        configuration: &RplidarConfiguration,
        (sample, now): (Sample, Stamp),
        event: &mut impl FnMut(RangingEvent<'_, P>),
    ) {
        if turn.is_over(sample) {
            if let Some(stamp) = turn.stamp(now, configuration.delay_us) {
                turn.scan.stamp = stamp;
                turn.scan.sequence = turn.scan.sequence.wrapping_add(1);
                event(RangingEvent::Scan(&turn.scan));
            }
            turn.begin(configuration, Some(now));
        }
        turn.enter(sample, configuration);
    }
}

impl<P: Profile> RangingScanner<P> for RplidarOf<P> {
    fn push(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(RangingEvent<'_, P>)) {
        let Self { configuration, device, turn } = self;
        device.push(bytes, now, &mut |found| match found {
            DeviceEvent::Sample(sample) => Self::take(turn, configuration, (sample, now), event),
            DeviceEvent::Fault(code) => event(RangingEvent::Fault(code)),
            DeviceEvent::Unsuitable(_) => event(RangingEvent::Unsuitable),
            DeviceEvent::Refused => event(RangingEvent::Refused),
        });
    }

    fn poll(
        &mut self,
        now: Stamp,
        send: &mut impl FnMut(&[u8]),
        event: &mut impl FnMut(RangingEvent<'_, P>),
    ) {
        if self.device.poll(now, send) {
            self.turn.begin(&self.configuration, None);
            event(RangingEvent::Silent);
        }
    }
}
