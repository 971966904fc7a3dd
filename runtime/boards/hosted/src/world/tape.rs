//! Writes tapes (the format is the runtime's).

use floorguard_runtime::tape::{TAPE_END, TAPE_MAGIC, TapeLine};

/// A tape that is being written, or none.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    bytes: Option<Vec<u8>>,
}

impl Tape {
    /// Nothing is written.
    #[must_use]
    pub const fn none() -> Self {
        Self { bytes: None }
    }

    /// An empty tape for a run of this length.
    #[must_use]
    pub fn new(duration_us: u64) -> Self {
        let mut bytes = TAPE_MAGIC.to_vec();
        bytes.extend(duration_us.to_le_bytes());
        Self { bytes: Some(bytes) }
    }

    /// Adds a delivery: moments of delivery and arrival, microseconds.
    pub fn record(&mut self, (deliver_us, arrival_us): (u64, u64), line: TapeLine, data: &[u8]) {
        self.raw((deliver_us, arrival_us), line.number(), data);
    }

    fn raw(&mut self, (deliver_us, arrival_us): (u64, u64), line: u16, data: &[u8]) {
        let Some(bytes) = &mut self.bytes else { return };
        let length = u16::try_from(data.len()).unwrap_or(u16::MAX);
        bytes.extend(deliver_us.to_le_bytes());
        bytes.extend(arrival_us.to_le_bytes());
        bytes.extend(line.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(data.iter().take(usize::from(length)));
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }

    /// The finished tape; empty when nothing was written.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.raw((0, 0), TAPE_END, &[]);
        self.bytes.unwrap_or_default()
    }
}
