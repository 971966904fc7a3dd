//! The verdict of a wired run.

use serde_json::json;

use super::report::Report;

/// The guard may come this late, microseconds of the board's time.
pub const LATEST_ALLOWED_US: u32 = 1_000;

/// What came of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// The board's last report.
    pub board: Report,
    /// Datagrams sent to it.
    pub lidar_sent: u32,
    /// Bytes sent on its lines: scanner, inertial sensor, CAN adapter.
    pub bytes_sent: [u64; 3],
    /// Frames that the board put on the bus and the simulated devices received.
    pub frames_received: u32,
    /// How far the robot drove, metres.
    pub driven_m: f32,
    /// How long it played: the board's time and ours, seconds.
    pub seconds: [f64; 2],
}

impl Outcome {
    /// Datagrams that did not reach the guard.
    pub fn lost_packets(&self) -> u32 {
        self.lidar_sent.saturating_sub(self.board.lidar)
    }

    /// Bytes that did not reach the board.
    pub fn lost_bytes(&self) -> u64 {
        let taken = [self.board.scanner_bytes, self.board.imu_bytes, self.board.can_bytes];
        self.bytes_sent.iter().zip(taken).map(|(sent, taken)| sent.saturating_sub(u64::from(taken))).sum()
    }

    /// Nothing lost, the guard in time, and the robot drove.
    pub fn is_good(&self) -> bool {
        let nothing_lost = self.lost_packets() == 0 && self.lost_bytes() == 0 && self.board.refused == 0;
        nothing_lost && self.board.latest_us <= LATEST_ALLOWED_US && self.board.people > 0
    }

    /// One object.
    pub fn to_json(&self) -> serde_json::Value {
        let [board_s, wall_s] = self.seconds;
        json!({
            "good": self.is_good(),
            "board_s": board_s,
            "wall_s": wall_s,
            "lidar_sent": self.lidar_sent,
            "lost_packets": self.lost_packets(),
            "bytes_sent": self.bytes_sent,
            "bytes_received": [self.board.scanner_bytes, self.board.imu_bytes, self.board.can_bytes],
            "lost_bytes": self.lost_bytes(),
            "scans": self.board.scans,
            "sweeps": self.board.people,
            "packets_late_for_perception": self.board.queue_lost,
            "frames_received": self.frames_received,
            "guard_latest_us": self.board.latest_us,
            "guard_latest_allowed_us": LATEST_ALLOWED_US,
            "guard_latest_at_ms": self.board.latest_with[0],
            "guard_latest_with_bytes": self.board.latest_with[1],
            "guard_latest_with_datagrams": self.board.latest_with[2],
            "guard_latest_stretch_us": self.board.latest_with[3],
            "driven_m": self.driven_m,
        })
    }
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [board_s, wall_s] = self.seconds;
        let [scanner, imu, can] = self.bytes_sent;
        writeln!(out, "wired: {board_s:.1} s of the board's time in {wall_s:.1} s")?;
        writeln!(out, "  lidar    {} datagrams sent, {} lost", self.lidar_sent, self.lost_packets())?;
        writeln!(out, "  serial   {scanner} + {imu} + {can} bytes sent, {} lost", self.lost_bytes())?;
        writeln!(
            out,
            "  board    {} scans, {} sweeps, {} packets late for perception, {} frames on the bus",
            self.board.scans, self.board.people, self.board.queue_lost, self.frames_received
        )?;
        let [at_ms, bytes, datagrams, stretch_us] = self.board.latest_with;
        writeln!(
            out,
            "  guard    at most {} us late, {LATEST_ALLOWED_US} allowed; that was at {at_ms} ms, with {bytes} bytes and \
             {datagrams} datagrams, the ring at work for {stretch_us} us",
            self.board.latest_us
        )?;
        write!(out, "  robot    drove {:.1} m", self.driven_m)
    }
}
