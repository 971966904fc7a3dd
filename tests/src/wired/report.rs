//! What the board reports every millisecond of its time.

/// First word: "FGST".
const MAGIC: u32 = 0x5453_4746;

/// One report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// The board's time, microseconds.
    pub now_us: u64,
    /// Lidar datagrams that reached the task.
    pub lidar: u32,
    /// Frames that were dropped in transit.
    pub lost_frames: u32,
    /// Bytes that the serial devices gave.
    pub scanner_bytes: u32,
    /// The same of the inertial sensor's line.
    pub imu_bytes: u32,
    /// The same of the CAN adapter's line.
    pub can_bytes: u32,
    /// Scans judged.
    pub scans: u32,
    /// Sweeps in which people were looked for.
    pub people: u32,
    /// The guard's executor came at most this late, microseconds.
    pub latest_us: u32,
    /// Packets that perception was too late for.
    pub queue_lost: u32,
    /// State of the guard, in the order of its declaration.
    pub state: u32,
    /// Permitted speed, micrometres per second.
    pub permitted_um_s: i32,
    /// CAN frames sent.
    pub can_sent: u32,
    /// Datagrams refused.
    pub refused: u32,
    /// Times that the Ethernet controller was found full: it drops what comes then.
    pub overruns: u32,
    /// Cause of the guard's objection, counted from 1 in the order of their list; 0: none.
    pub objection: u32,
    /// When a fault on purpose breaks, milliseconds; 0: not yet known.
    pub planned_ms: u32,
    /// When the guard came latest, milliseconds, and what had arrived within the millisecond before and until it came:
    /// bytes of the serial lines, datagrams of the lidar; and how long the guard ring worked at a stretch, microseconds.
    pub latest_with: [u32; 4],
    /// What the machine died of last: cause, detail, uptime in milliseconds, deaths so far; zeros if it did not.
    pub crash_record: [u32; 4],
}

impl Report {
    /// Reads a datagram; `None` if it is none.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let mut words = bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes));
        let mut next = || words.next();
        if next()? != MAGIC {
            return None;
        }
        // In the order of the words.
        let report = Self {
            now_us: u64::from(next()?) | u64::from(next()?) << 32,
            lidar: next()?,
            lost_frames: next()?,
            scanner_bytes: next()?,
            imu_bytes: next()?,
            can_bytes: next()?,
            scans: next()?,
            people: next()?,
            latest_us: next()?,
            queue_lost: next()?,
            state: next()?,
            permitted_um_s: next()? as i32,
            can_sent: next()?,
            refused: next()?,
            overruns: next()?,
            objection: next()?,
            planned_ms: next()?,
            latest_with: [next()?, next()?, next()?, next()?],
            crash_record: [next()?, next()?, next()?, next()?],
        };
        words.next().is_none().then_some(report)
    }
}
