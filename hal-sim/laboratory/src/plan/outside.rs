//! A program outside of the robot that drives it by velocities: what it sends and when, and what it hears.

use std::sync::{Arc, Mutex, PoisonError};

use floorguard_sim::wire::{HeardPermit, SentVelocity};

/// A frame that the program sends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SentFrame {
    /// When it arrives at the robot, microseconds since the start.
    pub at_us: u64,
    /// From which address.
    pub peer: u64,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// A permit and when it was heard, microseconds since the start.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardAt {
    /// When.
    pub at_us: u64,
    /// What.
    pub permit: HeardPermit,
}

/// Sends as it was written, whatever it hears.
#[derive(Clone, Debug, Default)]
pub struct OutsideProgram {
    /// Everything that it sends, in the order of time.
    pub sent: Arc<Vec<SentFrame>>,
    heard: Arc<Mutex<Vec<HeardAt>>>,
}

/// The same velocity again and again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// First and last moment, microseconds.
    pub span_us: (u64, u64),
    /// Time between two requests, microseconds.
    pub period_us: u64,
    /// What is sent; the sequence goes on from it, and the clock is the world's.
    pub first: SentVelocity,
}

impl OutsideProgram {
    /// Sends these frames.
    #[must_use]
    pub fn new(mut sent: Vec<SentFrame>) -> Self {
        sent.sort_by_key(|frame| frame.at_us);
        Self { sent: Arc::new(sent), heard: Arc::default() }
    }

    /// Everything that was heard so far.
    #[must_use]
    pub fn heard(&self) -> Vec<HeardAt> {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(crate) fn hear(&self, at_us: u64, bytes: &[u8]) {
        if let Some(permit) = HeardPermit::read(bytes) {
            self.heard.lock().unwrap_or_else(PoisonError::into_inner).push(HeardAt { at_us, permit });
        }
    }
}

impl Stretch {
    /// Its frames, from one address.
    #[must_use]
    pub fn frames(&self, peer: u64) -> Vec<SentFrame> {
        let (from_us, to_us) = self.span_us;
        let frame = |(number, at_us): (u32, u64)| {
            let sequence = self.first.sequence.wrapping_add(number);
            let sent_ms = (at_us / 1_000) as u32;
            SentFrame { at_us, peer, bytes: SentVelocity { sequence, sent_ms, ..self.first }.encode() }
        };
        (0..).zip((from_us..to_us).step_by(self.period_us as usize)).map(frame).collect()
    }
}
