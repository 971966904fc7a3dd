//! The rows of the black box in memory that outlives a reset: what the machine knew before it died is still there after.
//!
//! Each life writes into one of two rings; after a reset the other one is used, so that the last ten seconds before a
//! death stay until the next death. What lies there are the packed rows of [`floorguard_runtime::black_box_log`], padded
//! with zeros to whole words: each has its own checksum and its own end, so a reset in the middle of a row costs that row,
//! and memory that never held rows is nothing but damage. Whole words, because the memory's error correction works on words.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_time::{Duration, Ticker};
use embedded_io_async::{Read, Write};
use floorguard_runtime::black_box_log::{LOG_VERSION, LogMoment, LogRestart, LogRow, encode_row};

use crate::RobotShared;

/// Words of a ring: ten seconds at one row of six words every 10 ms, and 20 rows a second more.
const RING_WORDS: usize = 7_680;
/// Words that a read-out leaves out, because they may be overwritten before they are sent.
const MARGIN_WORDS: usize = 256;
/// A request for the black box is this byte.
pub const REQUEST: u8 = b'B';
/// How often new entries are copied: what is younger dies with the machine.
const KEEP_EVERY: Duration = Duration::from_millis(5);
/// "FGKB".
const MAGIC: u32 = 0x424b_4746;
/// Words sent at once.
const PORTION_WORDS: usize = 16;

struct Ring {
    words: [AtomicU32; RING_WORDS],
    /// Where the next row goes.
    head: AtomicU32,
}

/// Two rings and whose turn it is. Place it where neither start-up code nor loader writes; any bits are a valid value.
pub struct KeptBox {
    magic: AtomicU32,
    /// Lives so far; the lowest bit chooses the ring.
    lives: AtomicU32,
    /// The number of lives, inverted.
    check: AtomicU32,
    rings: [Ring; 2],
}

impl KeptBox {
    /// A life begins. Call once, before anything is kept.
    pub fn begin(&self) {
        let lives = self.lives.load(Ordering::Relaxed);
        let known =
            self.magic.load(Ordering::Relaxed) == MAGIC && self.check.load(Ordering::Relaxed) == !lives;
        let lives = if known { lives.wrapping_add(1) } else { 0 };
        self.lives.store(lives, Ordering::Relaxed);
        self.check.store(!lives, Ordering::Relaxed);
        if !known {
            self.previous().clear();
        }
        self.current().clear();
        self.magic.store(MAGIC, Ordering::Relaxed);
    }

    fn ring(&self, life: u32) -> &Ring {
        let [even, odd] = &self.rings;
        if life & 1 == 0 { even } else { odd }
    }

    fn current(&self) -> &Ring {
        self.ring(self.lives.load(Ordering::Relaxed))
    }

    fn previous(&self) -> &Ring {
        self.ring(self.lives.load(Ordering::Relaxed).wrapping_add(1))
    }
}

impl Ring {
    fn clear(&self) {
        self.words.iter().for_each(|word| word.store(0, Ordering::Relaxed));
        self.head.store(0, Ordering::Relaxed);
    }

    fn head(&self) -> usize {
        self.head.load(Ordering::Relaxed) as usize % RING_WORDS
    }

    fn word(&self, index: usize) -> u32 {
        self.words.get(index % RING_WORDS).map_or(0, |word| word.load(Ordering::Relaxed))
    }

    /// Appends a row. Only one task calls this.
    fn keep(&self, row: &LogRow) {
        let mut head = self.head();
        for bytes in encode_row(row).chunks(4) {
            let mut word = [0; 4];
            word.iter_mut().zip(bytes).for_each(|(slot, byte)| *slot = *byte);
            if let Some(slot) = self.words.get(head) {
                slot.store(u32::from_le_bytes(word), Ordering::Relaxed);
            }
            head = (head + 1) % RING_WORDS;
        }
        self.head.store(head as u32, Ordering::Relaxed);
    }

    /// Sends all rows that will not be overwritten meanwhile.
    async fn send<W: Write>(&self, line: &mut W) -> Result<(), W::Error> {
        let first = self.head() + MARGIN_WORDS;
        send_row(line, &LogRow::Begin(LOG_VERSION, 0)).await?;
        let (mut begun, mut inside, mut rows) = (false, false, 0_u32);
        let mut portion = heapless::Vec::<u8, { 4 * PORTION_WORDS }>::new();
        for index in 0..RING_WORDS - MARGIN_WORDS {
            let word = self.word(first + index);
            let ends = word.to_le_bytes()[3] == 0;
            // The first row may have lost its beginning; words that were never written are no rows.
            if begun && (word != 0 || inside) {
                // Sent before it is full.
                let _ = portion.extend_from_slice(&word.to_le_bytes());
                rows += u32::from(ends);
                inside = !ends;
            }
            begun |= ends;
            if portion.is_full() {
                line.write_all(&portion).await?;
                portion.clear();
            }
        }
        line.write_all(&portion).await?;
        send_row(line, &LogRow::End(rows)).await
    }
}

async fn send_row<W: Write>(line: &mut W, row: &LogRow) -> Result<(), W::Error> {
    line.write_all(&encode_row(row)).await
}

/// Copies what the guard decides into the kept memory. Runs for ever.
pub async fn keep_black_box(shared: &RobotShared, kept: &KeptBox) {
    let mut ticker = Ticker::every(KEEP_EVERY);
    let mut written = 0;
    loop {
        ticker.next().await;
        let ring = kept.current();
        written = shared.black_box_since(written, |stamp, entry| {
            ring.keep(&LogRow::Moment(LogMoment::new(stamp, &entry)));
        });
    }
}

/// Sends the black box on request over a line: the life before the last reset, what ended it, and the life since.
/// Runs until the line fails.
///
/// # Errors
/// Those of the line.
pub async fn send_black_box<L: Read + Write>(
    kept: &KeptBox,
    restart: Option<LogRestart>,
    mut line: L,
) -> Result<(), L::Error> {
    let mut order = [0];
    loop {
        if line.read(&mut order).await? == 0 || order != [REQUEST] {
            continue;
        }
        if let Some(restart) = restart {
            kept.previous().send(&mut line).await?;
            send_row(&mut line, &LogRow::Restart(restart)).await?;
        }
        kept.current().send(&mut line).await?;
        line.flush().await?;
    }
}
