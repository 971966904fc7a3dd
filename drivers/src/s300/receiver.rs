//! From bytes in any portions to scans: searches, waits, checks, resynchronises. Source: book, SICK S300: Receiver.

use floorguard_types::number::truncating_u32;
use floorguard_types::profile::{List, Native, Profile};
use floorguard_types::sensing::{BeamReturn, ScanOf};
use floorguard_types::time::{Age, Stamp};

use super::configuration::{Bit13, Configuration};
use super::telegram::{RunningSum, Telegram, TelegramError, candidate_lengths, field};

/// Two telegrams suffice for any alignment.
const BUFFER_BYTES: usize = 2_432;
/// Every value of a scanner in stand-by.
const STAND_BY_WORD: u16 = 0x4004;
/// Distance of a beam without echo.
const NO_ECHO: u16 = 0x1fff;
/// Farthest distance that fits the millimetre field, centimetres.
const FARTHEST_CM: u16 = u16::MAX / 10;
/// Farther than the millimetre field can hold.
const BEYOND_CM: u16 = FARTHEST_CM + 1;
/// Dazzled or a reflector, as the scanner is configured.
const DAZZLED: u16 = 0x2000;

/// What the line reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventOf<'a, P: Profile> {
    /// A scan. It stays in the receiver until the next one.
    Scan(&'a ScanOf<P>),
    /// The scanner is in stand-by: no data, neither obstacle nor free.
    StandBy {
        /// Its scan number.
        sequence: u32,
    },
    /// A telegram that is right and of no use.
    Refused(TelegramError),
}

/// The same in the memory of the target.
pub type Event<'a> = EventOf<'a, Native>;

/// What happened on the line; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Bytes received.
    pub bytes: u32,
    /// Places that looked like a header.
    pub headers: u32,
    /// Headers behind which no checksum was right.
    pub checksum_failures: u32,
    /// Telegrams given up after a silence.
    pub gaps: u32,
    /// Right telegrams.
    pub telegrams: u32,
    /// Scans missing between two.
    pub lost_scans: u32,
    /// Scan numbers that did not grow.
    pub repeated_scans: u32,
}

/// Receives one scanner. About 2.4 KiB.
///
/// ```
/// use floorguard_drivers::s300::{Configuration, Event, Receiver};
/// use floorguard_types::sensing::BeamReturn;
/// use floorguard_types::time::Stamp;
///
/// // An example of the manufacturer: four fields of 8, 8, 8 and 5 values, all of them 10 m.
/// let telegram = [
///     0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x2B, 0xFF, 0x07, 0x03, 0x01, 0x00, 0x00, 0x17, 0x01, 0x00,
///     0x00, 0x00, 0x00, 0xBB, 0xBB, 0x11, 0x11, 0xE8, 0x23, 0xE8, 0x23, 0xE8, 0x23, 0xE8, 0x03, 0xE8, 0x03,
///     0xE8, 0x23, 0xE8, 0x23, 0xE8, 0x03, 0x22, 0x22, 0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03, 0xE8,
///     0x03, 0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03, 0x33, 0x33, 0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03,
///     0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03, 0x44, 0x44, 0xE8, 0x03, 0xE8, 0x03, 0xE8, 0x03, 0xE8,
///     0x03, 0xE8, 0x23, 0x9C, 0xF4,
/// ];
/// let values_per_field = [8, 8, 8, 5].into_iter().collect();
/// let mut receiver = Receiver::new(Configuration { values_per_field, ..Configuration::default() });
/// let mut scans = Vec::new();
/// // However the line cuts it: here byte by byte, at 500 kBd.
/// for (micros, byte) in (1_000_000..).step_by(20).zip(telegram) {
///     receiver.push(&[byte], Stamp::from_micros(micros), |event| match event {
///         Event::Scan(scan) => scans.push((scan.sequence, scan.beams.len(), scan.beams[0], scan.beams[3])),
///         other => panic!("{other:?}"),
///     });
/// }
/// // Bit 13 of the first value says dazzled, in the default configuration: it sees nothing.
/// assert_eq!(scans, [(0x117, 29, BeamReturn::Unknown, BeamReturn::Hit(10_000))]);
/// ```
#[derive(Clone, Debug)]
pub struct ReceiverOf<P: Profile> {
    configuration: Configuration,
    buffer: [u8; BUFFER_BYTES],
    length: usize,
    /// Bytes that must arrive before it is worth looking again, at least 1.
    wanted: usize,
    /// The sum of what stands at the front of the buffer.
    sum: RunningSum,
    last_byte: Stamp,
    /// Index of the size rule that was right last.
    rule: usize,
    last_scan: Option<u32>,
    counters: Counters,
    /// The newest scan, built in place: it is too large for the stack of a small machine.
    scan: ScanOf<P>,
}

/// What stands at the front of the buffer.
enum Front {
    /// A whole telegram.
    Telegram {
        /// Its bytes.
        length: usize,
        /// Index of the size rule that it follows.
        rule: usize,
    },
    /// Perhaps one; so many bytes more will tell.
    Unfinished(usize),
    /// None.
    Nothing,
}

/// A receiver for the scanners of the target.
pub type Receiver = ReceiverOf<Native>;

impl<P: Profile> ReceiverOf<P> {
    /// An empty receiver.
    #[must_use]
    pub fn new(configuration: Configuration) -> Self {
        Self {
            configuration,
            buffer: [0; BUFFER_BYTES],
            length: 0,
            wanted: 1,
            sum: RunningSum::START,
            last_byte: Stamp::ZERO,
            rule: 0,
            last_scan: None,
            counters: Counters::default(),
            scan: ScanOf::default(),
        }
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> Counters {
        self.counters
    }

    /// Takes in bytes that arrived at `now`, in any portions. `event` is called for each telegram.
    pub fn push(&mut self, bytes: &[u8], now: Stamp, mut event: impl FnMut(EventOf<'_, P>)) {
        let silent = matches!(self.last_byte.age(now), Age::Past(us) if us > self.configuration.gap_max_us);
        if silent && self.length > 0 {
            // A telegram is sent without gaps: what is unfinished stays unfinished.
            self.counters.gaps = self.counters.gaps.saturating_add(1);
            self.discard(1);
            self.consume(now, &mut event);
        }
        self.counters.bytes = self.counters.bytes.saturating_add(truncating_u32(bytes.len()));
        let mut rest = bytes;
        for _ in bytes {
            let count = self.wanted.clamp(1, rest.len().max(1));
            let Some((portion, later)) = rest.split_at_checked(count) else { break };
            self.append(portion);
            self.consume(now, &mut event);
            rest = later;
        }
        self.last_byte = now;
    }

    fn append(&mut self, portion: &[u8]) {
        let end = self.length.saturating_add(portion.len());
        // It always fits: the request never exceeds the longest telegram, of which two fit.
        if let Some(space) = self.buffer.get_mut(self.length..end) {
            for (slot, byte) in space.iter_mut().zip(portion) {
                *slot = *byte;
            }
            self.length = end;
        }
    }

    /// Takes telegrams off the front until it is unfinished. Each turn removes at least one byte.
    fn consume(&mut self, now: Stamp, event: &mut impl FnMut(EventOf<'_, P>)) {
        for _ in 0..BUFFER_BYTES {
            match self.front() {
                Front::Unfinished(wanted) => {
                    self.wanted = wanted;
                    return;
                }
                Front::Nothing => self.discard(1),
                Front::Telegram { length, rule } => {
                    self.rule = rule;
                    self.counters.telegrams = self.counters.telegrams.saturating_add(1);
                    if let Some(reading) = self.interpret(length, now) {
                        event(reading);
                    }
                    self.discard(length);
                }
            }
        }
    }

    /// Drops bytes, and then everything that cannot begin a header.
    fn discard(&mut self, count: usize) {
        let used = self.buffer.get(..self.length).unwrap_or_default();
        let rest = used.get(count.min(used.len())..).unwrap_or_default();
        let start = count.saturating_add(rest.iter().position(|byte| *byte == 0).unwrap_or(rest.len()));
        let start = start.min(self.length);
        let remaining = self.length.saturating_sub(start);
        for to in 0..remaining.min(BUFFER_BYTES) {
            let moved = self.buffer.get(to.saturating_add(start)).copied().unwrap_or(0);
            if let Some(slot) = self.buffer.get_mut(to) {
                *slot = moved;
            }
        }
        self.length = remaining;
        self.sum = RunningSum::START;
    }

    fn front(&mut self) -> Front {
        let used = self.buffer.get(..self.length).unwrap_or_default();
        if used.iter().take(field::ZEROS).any(|byte| *byte != 0) {
            return Front::Nothing;
        }
        let Some(start) = used.first_chunk::<{ field::VERSION_END }>() else {
            return front_of_short(used);
        };
        let [.., size_high, size_low, flag, address, version_low, version_high] = *start;
        let words = u16::from_be_bytes([size_high, size_low]);
        if !is_header(words, flag, address) {
            return Front::Nothing;
        }
        let version = u16::from_le_bytes([version_low, version_high]);
        let front = self.checked(version, words);
        if matches!(front, Front::Nothing) {
            self.counters.headers = self.counters.headers.saturating_add(1);
            self.counters.checksum_failures = self.counters.checksum_failures.saturating_add(1);
        }
        front
    }

    /// Tries the size rules, the one that was right last first.
    fn checked(&mut self, version: u16, words: u16) -> Front {
        let used = self.buffer.get(..self.length).unwrap_or_default();
        let lengths = candidate_lengths(version, words);
        // As far as every rule agrees; what follows may be the sum itself.
        let shortest = lengths.iter().flatten().min().copied().unwrap_or(0);
        self.sum.extend(used, shortest.saturating_sub(2));
        let order = [self.rule % 3, (self.rule + 1) % 3, (self.rule + 2) % 3];
        let mut wanted: Option<usize> = None;
        for rule in order {
            let Some(length) = lengths.get(rule).copied().flatten() else { continue };
            match used.get(..length) {
                Some(whole) if self.sum.confirms(whole) => return Front::Telegram { length, rule },
                Some(_) => {}
                None => {
                    let missing = length.saturating_sub(used.len());
                    wanted = Some(wanted.map_or(missing, |least| least.min(missing)));
                }
            }
        }
        wanted.map_or(Front::Nothing, |missing| Front::Unfinished(missing.max(1)))
    }

    fn interpret(&mut self, length: usize, now: Stamp) -> Option<EventOf<'_, P>> {
        let telegram = Telegram::confirmed(self.buffer.get(..length)?);
        if telegram.status() != 0 {
            return Some(EventOf::Refused(TelegramError::LockOut { status: telegram.status() }));
        }
        if telegram.block() != 0xbbbb {
            return Some(EventOf::Refused(TelegramError::Block { found: telegram.block() }));
        }
        let (found, expected) = (telegram.words().len(), self.configuration.words());
        if found != expected {
            return Some(EventOf::Refused(TelegramError::Values { found, expected }));
        }
        let sequence = telegram.scan_number();
        if telegram.words().all(|word| word == STAND_BY_WORD) {
            return Some(EventOf::StandBy { sequence });
        }
        fill(&mut self.scan, &telegram, &self.configuration, now);
        self.count_scan(sequence);
        Some(EventOf::Scan(&self.scan))
    }

    fn count_scan(&mut self, sequence: u32) {
        match self.last_scan.map(|last| sequence.wrapping_sub(last)) {
            // A step back, or none, or more than an hour: the scanner repeats itself or restarted.
            Some(0) | Some(90_000..) => {
                self.counters.repeated_scans = self.counters.repeated_scans.saturating_add(1);
            }
            Some(step) => self.counters.lost_scans = self.counters.lost_scans.saturating_add(step - 1),
            None => {}
        }
        self.last_scan = Some(sequence);
    }
}

fn fill<P: Profile>(
    scan: &mut ScanOf<P>,
    telegram: &Telegram<'_>,
    configuration: &Configuration,
    now: Stamp,
) {
    scan.stamp = now.minus_micros(configuration.delay_us);
    scan.sequence = telegram.scan_number();
    scan.first_angle_rad = configuration.first_angle_rad;
    scan.step_rad = configuration.step_rad;
    // The number never changes after the first scan; it was checked against the configuration.
    let _ = scan.beams.resize(configuration.values(), BeamReturn::Unknown);
    let mut words = telegram.values();
    let mut beams: &mut [BeamReturn] = &mut scan.beams;
    let dazzled = if configuration.bit13 == Bit13::Dazzled { DAZZLED } else { 0 };
    let free = BeamReturn::Free(configuration.free_range_mm);
    for count in &configuration.values_per_field {
        let count = usize::from(*count);
        let (Some((field, later)), Some((slots, rest))) =
            (words.split_at_checked(count), beams.split_at_mut_checked(count))
        else {
            return;
        };
        for (slot, word) in slots.iter_mut().zip(field) {
            *slot = beam(u16::from_le_bytes(*word), dazzled, free);
        }
        // The marker between two fields.
        (words, beams) = (later.get(1..).unwrap_or_default(), rest);
    }
    if configuration.inverted {
        scan.turn_round();
    }
}

fn front_of_short(used: &[u8]) -> Front {
    // The start may already contradict a header: flag and address stand at 8 and 9.
    let missing = field::VERSION_END.saturating_sub(used.len()).max(1);
    let flag_wrong = used.get(8).is_some_and(|flag| *flag != 0xff);
    let address_wrong = used.get(9).is_some_and(|address| !matches!(address, 7 | 8));
    if flag_wrong || address_wrong { Front::Nothing } else { Front::Unfinished(missing) }
}

fn is_header(words: u16, flag: u8, address: u8) -> bool {
    flag == 0xff && matches!(address, 7 | 8) && field::WORDS.contains(&words)
}

/// One measured word; book, SICK S300: Measured words. A word with a bit of `dazzled` says nothing, one without echo is
/// `free`.
fn beam(word: u16, dazzled: u16, free: BeamReturn) -> BeamReturn {
    // Most words are one to this distance without any flag, which one comparison tells; then those without echo.
    if word.wrapping_sub(1) < FARTHEST_CM {
        BeamReturn::Hit(word.wrapping_mul(10))
    } else if word == NO_ECHO {
        free
    } else {
        flagged(word & (NO_ECHO | dazzled), free)
    }
}

/// A word of which only what matters is left.
#[inline(never)]
fn flagged(reading: u16, free: BeamReturn) -> BeamReturn {
    match reading {
        NO_ECHO => free,
        1..=FARTHEST_CM => BeamReturn::Hit(reading.wrapping_mul(10)),
        BEYOND_CM..NO_ECHO => BeamReturn::Hit(u16::MAX),
        // Dazzled; or 0, which is not a defined value: contamination or dazzle.
        _ => BeamReturn::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every word, one rule after the other (book, SICK S300: Measured words).
    #[test]
    fn each_word_means_what_the_format_says() {
        let free = BeamReturn::Free(30_000);
        for (word, dazzled) in (0..=u16::MAX).flat_map(|word| [(word, 0), (word, DAZZLED)]) {
            let distance_cm = word & 0x1fff;
            let wanted = if word & dazzled != 0 || distance_cm == 0 {
                BeamReturn::Unknown
            } else if distance_cm == 0x1fff {
                free
            } else {
                BeamReturn::Hit(u16::try_from(u32::from(distance_cm) * 10).unwrap_or(u16::MAX))
            };
            assert_eq!(beam(word, dazzled, free), wanted, "{word:#06x}, dazzled {dazzled:#06x}");
        }
    }
}
