//! Pieces to messages: in any order, doubled, interleaved with the next message, or never complete.
//!
//! Which bytes have arrived is tracked byte by byte. Summing up lengths instead would let a piece that came twice
//! complete a message with a hole.

use floorguard_types::time::{Age, Stamp};

use super::fragment::{Fragment, FragmentError};

/// Longest message (book, microScan3: Datagrams): 2,751 beams of four bytes, and everything else that can be sent with
/// them.
pub const MESSAGE_BYTES_MAX: usize = 16_384;
/// An incomplete message is given up after this, microseconds (book, microScan3: Datagrams).
const AGE_MAX_US: u64 = 100_000;
/// A piece of a message that is older than the last complete one by fewer than this has been overtaken.
const OVERTAKEN: u32 = 16;
/// Messages under assembly: one, and the next one that begins before the first is complete.
const SLOTS: usize = 2;
const WORD_BITS: usize = 32;

/// What happened to the datagrams; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AssemblyCounters {
    /// Datagrams received.
    pub datagrams: u32,
    /// Datagrams that are no piece of a message.
    pub refused: u32,
    /// Pieces that brought nothing new.
    pub duplicates: u32,
    /// Pieces of messages that were complete already, or overtaken.
    pub late: u32,
    /// Messages given up because pieces contradict each other.
    pub contradictions: u32,
    /// Messages given up incomplete.
    pub incomplete: u32,
    /// Complete messages.
    pub messages: u32,
}

#[derive(Clone, Debug)]
struct Slot {
    identification: u32,
    total: usize,
    /// Arrival of its first piece; `None`: the slot is free.
    began: Option<Stamp>,
    covered: usize,
    bytes: [u8; MESSAGE_BYTES_MAX],
    /// One bit a byte.
    map: [u32; MESSAGE_BYTES_MAX / WORD_BITS],
}

/// Whether a piece fits to what is there.
enum Fit {
    New,
    Duplicate,
    Contradiction,
}

impl Slot {
    const FREE: Self = Self {
        identification: 0,
        total: 0,
        began: None,
        covered: 0,
        bytes: [0; MESSAGE_BYTES_MAX],
        map: [0; MESSAGE_BYTES_MAX / WORD_BITS],
    };

    fn begin(&mut self, fragment: &Fragment<'_>, now: Stamp) {
        self.identification = fragment.identification;
        self.total = fragment.total;
        self.began = Some(now);
        self.covered = 0;
        self.map = [0; MESSAGE_BYTES_MAX / WORD_BITS];
    }

    fn holds(&self, identification: u32) -> bool {
        self.began.is_some() && self.identification == identification
    }

    fn is_complete(&self) -> bool {
        self.began.is_some() && self.covered == self.total
    }

    /// Enters a piece.
    fn enter(&mut self, fragment: &Fragment<'_>) -> Fit {
        if fragment.total != self.total {
            return Fit::Contradiction;
        }
        let before = self.covered;
        for (position, byte) in (fragment.offset..MESSAGE_BYTES_MAX).zip(fragment.payload) {
            let (word, bit) = (position / WORD_BITS, 1_u32 << (position % WORD_BITS));
            let (Some(bits), Some(slot)) = (self.map.get_mut(word), self.bytes.get_mut(position)) else {
                return Fit::Contradiction;
            };
            if *bits & bit == 0 {
                *bits |= bit;
                *slot = *byte;
                self.covered = self.covered.saturating_add(1);
            } else if slot != byte {
                return Fit::Contradiction;
            }
        }
        if self.covered == before { Fit::Duplicate } else { Fit::New }
    }

    fn message(&self) -> &[u8] {
        self.bytes.get(..self.total).unwrap_or_default()
    }
}

/// Assembles the messages of one device. About 36 KiB.
#[derive(Clone, Debug)]
pub(super) struct Assembler {
    slots: [Slot; SLOTS],
    /// Identification and time of the newest complete message.
    complete: Option<(u32, Stamp)>,
    counters: AssemblyCounters,
}

impl Assembler {
    pub const fn new() -> Self {
        Self {
            slots: [Slot::FREE; SLOTS],
            complete: None,
            counters: AssemblyCounters {
                datagrams: 0,
                refused: 0,
                duplicates: 0,
                late: 0,
                contradictions: 0,
                incomplete: 0,
                messages: 0,
            },
        }
    }

    pub const fn counters(&self) -> AssemblyCounters {
        self.counters
    }

    /// Takes in a datagram that arrived at `now`. Gives the message that it completes, with the arrival of its first
    /// piece.
    ///
    /// # Errors
    /// The datagram is no piece of a message; it is counted and changes nothing.
    pub fn push(&mut self, datagram: &[u8], now: Stamp) -> Result<Option<(&[u8], Stamp)>, FragmentError> {
        count(&mut self.counters.datagrams);
        self.give_up(|slot| !is_within(slot.began, now, AGE_MAX_US));
        let fragment = Fragment::new_checked(datagram, MESSAGE_BYTES_MAX)
            .inspect_err(|_| count(&mut self.counters.refused))?;
        if self.is_late(&fragment, now) {
            count(&mut self.counters.late);
            return Ok(None);
        }
        if !self.slots.iter().any(|slot| slot.holds(fragment.identification)) {
            self.open(&fragment, now);
        }
        let Some(slot) = self.slots.iter_mut().find(|slot| slot.holds(fragment.identification)) else {
            return Ok(None);
        };
        match slot.enter(&fragment) {
            Fit::New => {}
            Fit::Duplicate => {
                count(&mut self.counters.duplicates);
                return Ok(None);
            }
            Fit::Contradiction => {
                // Nobody knows which piece is the wrong one.
                slot.began = None;
                count(&mut self.counters.contradictions);
                return Ok(None);
            }
        }
        if slot.is_complete() { Ok(self.hand_out(fragment.identification, now)) } else { Ok(None) }
    }

    /// Its message is complete, or a newer one is.
    fn is_late(&self, fragment: &Fragment<'_>, now: Stamp) -> bool {
        self.complete.is_some_and(|(identification, at)| {
            is_within(Some(at), now, AGE_MAX_US)
                && identification.wrapping_sub(fragment.identification) < OVERTAKEN
        })
    }

    /// A free slot for a new message; the older one of two gives way.
    fn open(&mut self, fragment: &Fragment<'_>, now: Stamp) {
        // Free slots sort first.
        if let Some(slot) = self.slots.iter_mut().min_by_key(|slot| slot.began) {
            if slot.began.is_some() {
                count(&mut self.counters.incomplete);
            }
            slot.begin(fragment, now);
        }
    }

    fn hand_out(&mut self, identification: u32, now: Stamp) -> Option<(&[u8], Stamp)> {
        count(&mut self.counters.messages);
        self.complete = Some((identification, now));
        let older = |slot: &Slot| {
            let behind = identification.wrapping_sub(slot.identification);
            behind > 0 && behind <= u32::MAX / 2
        };
        self.give_up(older);
        let slot = self.slots.iter_mut().find(|slot| slot.holds(identification))?;
        let began = slot.began.take()?;
        Some((slot.message(), began))
    }

    fn give_up(&mut self, hopeless: impl Fn(&Slot) -> bool) {
        for slot in &mut self.slots {
            if slot.began.is_some() && hopeless(slot) {
                slot.began = None;
                count(&mut self.counters.incomplete);
            }
        }
    }
}

fn is_within(stamp: Option<Stamp>, now: Stamp, limit_us: u64) -> bool {
    stamp.is_some_and(|stamp| matches!(stamp.age(now), Age::Past(us) if us <= limit_us))
}

fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}
