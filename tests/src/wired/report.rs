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
        let words: Vec<u32> =
            bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        let [
            MAGIC,
            now_low,
            now_high,
            lidar,
            lost_frames,
            scanner_bytes,
            imu_bytes,
            can_bytes,
            scans,
            people,
            latest_us,
            queue_lost,
            state,
            permitted,
            can_sent,
            refused,
            overruns,
            objection,
            planned_ms,
            late_at_ms,
            late_bytes,
            late_datagrams,
            late_stretch_us,
            ref crash_record @ ..,
        ] = words.as_slice()[..]
        else {
            return None;
        };
        Some(Self {
            now_us: u64::from(now_high) << 32 | u64::from(now_low),
            lidar,
            lost_frames,
            scanner_bytes,
            imu_bytes,
            can_bytes,
            scans,
            people,
            latest_us,
            queue_lost,
            state,
            permitted_um_s: permitted as i32,
            can_sent,
            refused,
            overruns,
            objection,
            planned_ms,
            latest_with: [late_at_ms, late_bytes, late_datagrams, late_stretch_us],
            crash_record: crash_record.try_into().ok()?,
        })
    }
}
