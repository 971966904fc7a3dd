//! SICK TiM5xx and LMS1xx as scanners: asked for their scans in CoLa A and B in turn, because either can be set in them; given with times
//! of the robot's clock.

use floorguard_types::number::{nearest_f32, truncating_u32};
use floorguard_types::profile::{List, Native, Profile};
use floorguard_types::sensing::{BeamReturn, ScanOf};
use floorguard_types::time::Stamp;
use floorguard_types::units::RADIANS_PER_DEGREE;

use super::contract::{RangingEvent, RangingScanner};
use crate::cola::{Frame, Framer, ScanTelegram, TelegramError};
use crate::velodyne::HourClock;

/// "Send scans from now on."
const ASK: &[u8] = b"\x02sEN LMDscandata 1\x03";
/// The same in CoLa B, with its length and checksum.
const ASK_BINARY: &[u8] = b"\x02\x02\x02\x02\0\0\0\x11sEN LMDscandata \x01\x33";
/// A message with a scan, and one that says that a command was not understood.
const SCAN: &[u8] = b"sSN LMDscandata ";
const ERROR: &[u8] = b"sFA";
/// A sensor that sends nothing for so long is asked again.
const SILENCE_US: u64 = 1_000_000;
const HOUR_US: u64 = 3_600_000_000;
/// Ten-thousandths of a degree; the sensor's 90° is straight ahead.
const AHEAD: i32 = 900_000;

/// What the sensor is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColaConfiguration {
    /// What it measures nearer or farther than this is not believed, millimetres.
    pub range_mm: [u32; 2],
    /// From the beginning of a turn to the arrival of its scan at least, microseconds.
    pub delay_us: u64,
}

/// TiM551, TiM561, TiM571: 15 turns a second.
pub const TIM5XX: ColaConfiguration = ColaConfiguration { range_mm: [50, 25_000], delay_us: 60_000 };
/// LMS100 and LMS111: 50 turns a second at 0.5°, 25 at 0.25°.
pub const LMS1XX: ColaConfiguration = ColaConfiguration { range_mm: [500, 20_000], delay_us: 17_000 };

/// One sensor.
///
/// ```
/// use floorguard_drivers::ranging::{Cola, RangingScanner, TIM5XX};
/// use floorguard_types::time::Stamp;
///
/// let mut scanner = Cola::new(TIM5XX);
/// let mut sent = Vec::new();
/// scanner.poll(Stamp::ZERO, &mut |bytes| sent.extend_from_slice(bytes), &mut |_| {});
/// assert_eq!(sent, b"\x02sEN LMDscandata 1\x03");
/// ```
#[derive(Clone, Debug)]
pub struct ColaOf<P: Profile> {
    framer: Framer,
    /// It is asked in CoLa B next: as it was heard, or as it was not asked before.
    asks_binary: bool,
    asked: Option<Stamp>,
    session: SessionOf<P>,
}

/// For the scanners of the target.
pub type Cola = ColaOf<Native>;

/// What the sensor has sent.
#[derive(Clone, Debug)]
struct SessionOf<P: Profile> {
    configuration: ColaConfiguration,
    heard: Option<Stamp>,
    clock: HourClock,
    /// The sensor's counter, and the same unrolled.
    counted: Option<(u32, u64)>,
    scan: ScanOf<P>,
}

impl<P: Profile> ColaOf<P> {
    /// Nothing was asked yet.
    #[must_use]
    pub fn new(configuration: ColaConfiguration) -> Self {
        let (clock, scan) = (HourClock::default(), ScanOf::EMPTY);
        let session = SessionOf { configuration, heard: None, clock, counted: None, scan };
        Self { framer: Framer::default(), asks_binary: false, asked: None, session }
    }
}

impl<P: Profile> SessionOf<P> {
    fn take(
        &mut self,
        telegram: &Result<ScanTelegram<'_>, TelegramError>,
        now: Stamp,
        event: &mut impl FnMut(RangingEvent<'_, P>),
    ) {
        let Ok(telegram) = telegram else {
            event(RangingEvent::Refused);
            return;
        };
        self.heard = Some(now);
        // In trouble, or a window too dirty to see through.
        if telegram.status & 0x05 != 0 {
            event(RangingEvent::Fault(telegram.status));
            return;
        }
        let unrolled = match self.counted {
            Some((before, unrolled)) => {
                unrolled.saturating_add(u64::from(telegram.begun_us.wrapping_sub(before)))
            }
            None => u64::from(telegram.begun_us),
        };
        self.counted = Some((telegram.begun_us, unrolled));
        let sensor_us = truncating_u32(unrolled % HOUR_US);
        // Of its beginning, so that no beam is taken for younger than it is.
        let stamp = self.clock.stamp(sensor_us, now.minus_micros(self.configuration.delay_us));
        fill(&mut self.scan, telegram, (stamp, &self.configuration));
        event(RangingEvent::Scan(&self.scan));
    }
}

fn fill<P: Profile>(
    scan: &mut ScanOf<P>,
    telegram: &ScanTelegram<'_>,
    (stamp, configuration): (Stamp, &ColaConfiguration),
) {
    (scan.stamp, scan.sequence) = (stamp, u32::from(telegram.scan));
    let degrees = nearest_f32(telegram.first_angle.saturating_sub(AHEAD)) * 1.0e-4;
    scan.first_angle_rad = degrees * RADIANS_PER_DEGREE;
    scan.step_rad = f32::from(telegram.step) * 1.0e-4 * RADIANS_PER_DEGREE;
    scan.beams.clear();
    let [nearest_mm, farthest_mm] = configuration.range_mm;
    for counts in telegram.distances() {
        let range_mm = counts.saturating_mul(telegram.unit_mm);
        let is_measured = (nearest_mm..=farthest_mm).contains(&range_mm);
        let range_mm = u16::try_from(range_mm).ok().filter(|_| is_measured);
        // A scan that does not fit has fewer beams than the guard expects, and is refused there.
        let _full = scan.beams.push(range_mm.map_or(BeamReturn::Unknown, BeamReturn::Hit));
    }
}

impl<P: Profile> RangingScanner<P> for ColaOf<P> {
    fn push(&mut self, bytes: &[u8], now: Stamp, event: &mut impl FnMut(RangingEvent<'_, P>)) {
        let Self { framer, session, asks_binary, .. } = self;
        for byte in bytes {
            match framer.byte(*byte) {
                // Answers to commands, and scans.
                Some(Frame::Text(text)) if text.starts_with(SCAN) => {
                    *asks_binary = false;
                    session.take(&ScanTelegram::new_checked(text), now, event);
                }
                Some(Frame::Binary(bytes)) if bytes.starts_with(SCAN) => {
                    *asks_binary = true;
                    session.take(&ScanTelegram::new_binary(bytes), now, event);
                }
                Some(Frame::Text(answer) | Frame::Binary(answer)) if answer.starts_with(ERROR) => {
                    event(RangingEvent::Unsuitable);
                }
                Some(Frame::Refused) => event(RangingEvent::Refused),
                Some(Frame::Text(_) | Frame::Binary(_)) | None => {}
            }
        }
    }

    fn poll(
        &mut self,
        now: Stamp,
        send: &mut impl FnMut(&[u8]),
        event: &mut impl FnMut(RangingEvent<'_, P>),
    ) {
        let is_silent = |since: Option<Stamp>| since.is_none_or(|since| since.past_us(now) >= SILENCE_US);
        if is_silent(self.session.heard) && is_silent(self.asked) {
            if self.session.heard.is_some() {
                // It may have been switched off and on.
                (self.session.heard, self.session.counted) = (None, None);
                event(RangingEvent::Silent);
            }
            self.asked = Some(now);
            send(if self.asks_binary { ASK_BINARY } else { ASK });
            self.asks_binary = !self.asks_binary;
        }
    }
}
