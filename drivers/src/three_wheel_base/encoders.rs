//! Both rear encoders, latched by the same SYNC.

use floorguard_types::sensing::WheelSample;
use floorguard_types::time::Stamp;

use crate::cia406::PositionCounter;

/// Which wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

/// What an encoder reports of its wheel.
#[derive(Clone, Copy, Debug)]
pub(super) struct EncoderReading {
    /// Counts, below the range.
    pub position: u32,
    /// Counts before it begins again; 0 stands for the whole word.
    pub range: u32,
}

/// Collects one position of each wheel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Encoders {
    counters: [PositionCounter; 2],
    ticks: [Option<i32>; 2],
}

impl Encoders {
    /// A new SYNC: what belonged to the old one is not mixed with it.
    pub fn begin(&mut self) {
        self.ticks = [None; 2];
    }

    /// A position. The sample is complete with the second wheel.
    pub fn on_position(
        &mut self,
        side: Side,
        reading: EncoderReading,
        latched: Stamp,
    ) -> Option<WheelSample> {
        let EncoderReading { position, range } = reading;
        let ([left, right], [left_ticks, right_ticks]) = (&mut self.counters, &mut self.ticks);
        match side {
            Side::Left => *left_ticks = Some(left.update(position, range)),
            Side::Right => *right_ticks = Some(right.update(position, range)),
        }
        let sample = WheelSample { stamp: latched, left_ticks: (*left_ticks)?, right_ticks: (*right_ticks)? };
        self.begin();
        Some(sample)
    }

    /// An encoder was gone: its wheel may have turned any way meanwhile.
    pub fn restart(&mut self, side: Side) {
        let [left, right] = &mut self.counters;
        match side {
            Side::Left => left.restart(),
            Side::Right => right.restart(),
        }
    }
}
