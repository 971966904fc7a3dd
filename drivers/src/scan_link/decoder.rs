//! From datagrams to stamped scans: sender, losses, fragments, clock.

use floorguard_types::number::{nearest_f32, truncating_u32, truncating_u64};
use floorguard_types::profile::{List, Native, Profile};
use floorguard_types::sensing::{BeamReturn, ScanOf};
use floorguard_types::time::Stamp;
use floorguard_types::units::RADIANS_PER_DEGREE;

use super::decode_error::DecodeError;
use super::frame::{BEAMS_MAX, BeamsFrame, ScanHead};
use super::shape::ScanShape;
use crate::link::{DatagramOrder, lost_before};
use crate::velodyne::HourClock;

const HOUR_US: u64 = 3_600_000_000;

/// Counts; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanCounters {
    /// Scans of which every datagram arrived.
    pub scans: u32,
    /// Datagrams refused, for any reason.
    pub refused: u32,
    /// Scans that were sent and of which a datagram, or all, did not arrive.
    pub lost: u32,
}

/// Decodes the stream of one bridge.
#[derive(Clone, Debug)]
pub struct DecoderOf<P: Profile> {
    shape: ScanShape,
    order: DatagramOrder,
    /// The scan that is being collected; `None`: the newest one is complete.
    collected: Option<Collected>,
    clock: HourClock,
    counters: ScanCounters,
    scan: ScanOf<P>,
}

/// A scan of which datagrams are missing.
#[derive(Clone, Copy, Debug)]
struct Collected {
    head: ScanHead,
    /// A bit for each datagram that is missing.
    missing: u8,
    /// When the first of them came: the least delay.
    arrival: Stamp,
}

/// For the scanners of the target.
pub type Decoder = DecoderOf<Native>;

impl<P: Profile> DecoderOf<P> {
    /// Nothing was heard yet.
    #[must_use]
    pub fn new(shape: ScanShape) -> Self {
        Self {
            shape,
            order: DatagramOrder::default(),
            collected: None,
            clock: HourClock::default(),
            counters: ScanCounters::default(),
            scan: ScanOf::EMPTY,
        }
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> ScanCounters {
        self.counters
    }

    /// Decodes one UDP payload that arrived at `arrival`. Gives a scan where this was the last of its datagrams.
    ///
    /// # Errors
    /// [`DecodeError`]; the datagram is counted and changes nothing else.
    pub fn decode(&mut self, payload: &[u8], arrival: Stamp) -> Result<Option<&ScanOf<P>>, DecodeError> {
        match self.take(payload, arrival) {
            Ok(is_complete) => {
                self.counters.scans = self.counters.scans.saturating_add(u32::from(is_complete));
                Ok(is_complete.then_some(&self.scan))
            }
            Err(error) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                Err(error)
            }
        }
    }

    /// Whether its scan is complete now.
    fn take(&mut self, payload: &[u8], arrival: Stamp) -> Result<bool, DecodeError> {
        let frame = BeamsFrame::new_checked(payload).map_err(DecodeError::Frame)?;
        let head = frame.head();
        let newest = self.order.newest(head.sender, arrival).map_err(DecodeError::Order)?;
        self.shape.check(&head)?;
        let bit = 1_u8.checked_shl(u32::from(frame.fragment())).unwrap_or(0);
        let is_same_scan = newest == Some(head.sequence);
        let mut collected = match (is_same_scan, self.collected) {
            (true, Some(collected)) if collected.head != head => {
                return Err(DecodeError::Disagrees { sequence: head.sequence });
            }
            (true, Some(collected)) if collected.missing & bit != 0 => collected,
            _ => {
                let lost = lost_before(newest, head.sequence).map_err(DecodeError::Order)?;
                self.begin(&head, lost);
                let missing = 1_u8.checked_shl(u32::from(frame.fragments())).unwrap_or(0).saturating_sub(1);
                Collected { head, missing, arrival }
            }
        };
        self.order.accept(head.sender, head.sequence, arrival);
        self.enter(&frame);
        collected.missing &= !bit;
        let is_complete = collected.missing == 0;
        if is_complete {
            self.scan.stamp = self.middle(&collected);
        }
        self.collected = (!is_complete).then_some(collected);
        Ok(is_complete)
    }

    /// A newer scan: what was being collected is lost, and so are those between.
    fn begin(&mut self, head: &ScanHead, lost: u32) {
        let given_up = u32::from(self.collected.is_some());
        self.counters.lost = self.counters.lost.saturating_add(lost).saturating_add(given_up);
        self.scan.sequence = head.sequence;
        self.scan.first_angle_rad = nearest_f32(head.first_udeg) * 1.0e-6 * RADIANS_PER_DEGREE;
        self.scan.step_rad = nearest_f32(head.step_udeg) * 1.0e-6 * RADIANS_PER_DEGREE;
        self.scan.beams.clear();
        for _ in (0..BEAMS_MAX).take(usize::from(head.beams)) {
            // A scan that does not fit has fewer beams than the guard expects, and is refused there.
            let _full = self.scan.beams.push(BeamReturn::Unknown);
        }
    }

    /// The ranges of a datagram, at their place in the scan.
    fn enter(&mut self, frame: &BeamsFrame<'_>) {
        let [nearest_mm, farthest_mm] = self.shape.range_mm;
        let first = usize::from(frame.first_beam());
        for (place, range_mm) in frame.ranges_mm().enumerate() {
            let is_measured = range_mm >= nearest_mm && range_mm <= farthest_mm && range_mm > 0;
            if let Some(beam) = self.scan.beams.get_mut(first.saturating_add(place)) {
                *beam = if is_measured { BeamReturn::Hit(range_mm) } else { BeamReturn::Unknown };
            }
        }
    }

    /// The middle of the scan on the robot's clock. What was measured last arrived after it was measured: no stamp is of the future.
    fn middle(&mut self, collected: &Collected) -> Stamp {
        let duration_us = collected.head.duration_ns() / 1_000;
        let later_us = truncating_u64(duration_us.max(0));
        let last_us = truncating_u32(collected.head.first_beam_us.wrapping_add(later_us) % HOUR_US);
        let last = self.clock.stamp(last_us, collected.arrival);
        last.minus_micros(duration_us.unsigned_abs() / 2)
    }
}
