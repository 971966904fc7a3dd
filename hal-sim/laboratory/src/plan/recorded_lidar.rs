//! A recorded lidar in place of the simulated one: the packets of a capture, at the times at which they came.

use std::path::Path;

use floorguard_recording::capture::{Capture, LIDAR_DATA_PORT};

/// The first packet comes this long after the start, microseconds: the other devices answer first.
const BEGIN_US: u64 = 1_000_000;

/// Packets of a lidar with their times in a run.
#[derive(Clone, Debug, Default)]
pub struct RecordedLidar {
    /// Time of arrival, microseconds since the start, never falling; and the payload.
    pub packets: Vec<(u64, Vec<u8>)>,
}

impl RecordedLidar {
    /// The packets of a capture, up to that time of the run.
    ///
    /// # Errors
    /// The capture cannot be read, or holds no packet of a lidar.
    pub fn read(file: &Path, until_us: u64) -> anyhow::Result<Self> {
        let mut packets: Vec<(u64, Vec<u8>)> = Vec::new();
        let mut first_us = None;
        for datagram in Capture::open(file)? {
            let datagram = datagram?;
            if datagram.destination_port != LIDAR_DATA_PORT {
                continue;
            }
            let since_us = datagram.captured_us.saturating_sub(*first_us.get_or_insert(datagram.captured_us));
            let newest_us = packets.last().map_or(0, |(at_us, _)| *at_us);
            let at_us = (BEGIN_US + since_us).max(newest_us);
            if at_us > until_us {
                break;
            }
            packets.push((at_us, datagram.payload));
        }
        if packets.is_empty() {
            anyhow::bail!("{}: no datagram to port {LIDAR_DATA_PORT} in it", file.display());
        }
        Ok(Self { packets })
    }

    /// When the last one comes, microseconds.
    #[must_use]
    pub fn end_us(&self) -> u64 {
        self.packets.last().map_or(0, |(at_us, _)| *at_us)
    }
}
