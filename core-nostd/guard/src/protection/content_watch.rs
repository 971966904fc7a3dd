//! Is what a sensor sends alive, and does it see with all its rings? Both are looked at beside the stop path, with what
//! the memory takes in; the sensor's next message finds the answer.

use super::lidar_rays::LidarRays;
use super::packet_table::{BIN_CDEG, PacketTable};
use floorguard_types::geometry::{Pose2, wrap_angle};
use floorguard_types::number::count_u32;
use floorguard_types::sensing::{BeamReturn, LidarColumn, LidarPacket, Scan};

/// The robot has moved when its wheels say so by this much, metres, …
pub const MOVED_M: f32 = 0.1;
/// … or has turned by this much, radians. What a real device measures has changed long before.
pub const MOVED_RAD: f32 = 0.1;
/// Packets within which a lidar that repeats itself does: two revolutions, of which every other packet is compared.
const REPEAT_PACKETS: u16 = 80;
/// So often in a row one and the same packet comes again before it counts.
const REPEATS: u8 = 4;
/// Of a firing every other ring is compared; one with fewer returns may be the same by chance.
const RETURNS_MIN: u8 = 3;
/// Azimuth over which a ring that looks at the near floor may say nothing, hundredths of a degree. Persons who stand at
/// the robot hide less.
pub const COVERED_CDEG: u16 = 6_000;
/// A ring looks at the near floor when it meets it within this, millimetres: dark or wet floor farther away may throw
/// too little back.
const NEAR_FLOOR_MM: u16 = 5_000;
/// Rings that are looked at, from the lowest one.
pub const LOWER_RINGS: usize = 8;
/// What lies nearer sits on the lidar's own window, millimetres.
const ON_WINDOW_MM: u32 = 300;
/// Azimuth that one packet stands for at most, hundredths of a degree: lost ones tell nothing, and every other one is
/// looked at.
const PACKET_CDEG: u16 = 1_200;

/// What a device sent, and where the robot was when it first did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repetition {
    print: u32,
    first_at: Pose2,
    /// The same content came although the robot has moved meanwhile (FG-REQ-035).
    pub is_frozen: bool,
}

impl Repetition {
    pub(super) const NONE: Self =
        Self { print: 0, first_at: Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 }, is_frozen: false };

    fn begin(&mut self, print: u32, pose: Pose2) {
        *self = Self { print, first_at: pose, is_frozen: false };
    }

    fn repeat(&mut self, pose: Pose2) {
        let (dx_m, dy_m) = (pose.x_m - self.first_at.x_m, pose.y_m - self.first_at.y_m);
        let turned_rad = wrap_angle(pose.heading_rad - self.first_at.heading_rad).abs();
        self.is_frozen = dx_m * dx_m + dy_m * dy_m > MOVED_M * MOVED_M || turned_rad > MOVED_RAD;
    }

    /// All ranges of a scan, with the place of the robot by its wheels.
    pub(super) fn see_scan(&mut self, scan: &Scan, pose: Pose2) {
        let word = |beam: &BeamReturn| match *beam {
            BeamReturn::Hit(range_mm) => u32::from(range_mm),
            BeamReturn::Free(range_mm) => u32::from(range_mm) | 0x1_0000,
            BeamReturn::Unknown => 0x2_0000,
        };
        let print = scan.beams.iter().fold(count_u32(scan.beams.len()), |print, beam| sum(print, word(beam)));
        if print == self.print { self.repeat(pose) } else { self.begin(print, pose) }
    }
}

/// What is remembered of the contents. Not doubled: a wrong bit in it lasts for one message, or one revolution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContentWatch {
    /// Of the scanner.
    pub scanner: Repetition,
    /// Of the lidar: a packet that comes again and again.
    lidar: Repetition,
    since_first: u16,
    repeats: u8,
    /// Packets are compared and looked through by turns: neither adds to the longest way of one.
    compares: bool,
    /// Azimuth over which each lower ring was silent, hundredths of a degree.
    silent_cdeg: [u16; LOWER_RINGS],
    widest_cdeg: u16,
    azimuth_cdeg: u16,
    /// A lower ring of the lidar says nothing over a wide azimuth (FG-REQ-036).
    pub is_covered: bool,
}

impl ContentWatch {
    /// Nothing was heard.
    pub const NONE: Self = Self {
        scanner: Repetition::NONE,
        lidar: Repetition::NONE,
        since_first: REPEAT_PACKETS,
        repeats: 0,
        compares: false,
        silent_cdeg: [0; LOWER_RINGS],
        widest_cdeg: 0,
        azimuth_cdeg: 0,
        is_covered: false,
    };

    /// The lidar repeats itself although the robot has moved (FG-REQ-035).
    #[must_use]
    pub fn is_lidar_frozen(&self) -> bool {
        self.lidar.is_frozen && self.repeats >= REPEATS
    }

    /// All ranges of a scan, with the place of the robot by its wheels.
    pub fn see_scan(&mut self, scan: &Scan, pose: Pose2) {
        self.scanner.see_scan(scan, pose);
    }

    /// The first firing of a packet, with the place of the robot by its wheels.
    pub fn see_packet(
        &mut self,
        packet: &LidarPacket,
        (rays, table): (&LidarRays, &PacketTable),
        pose: Pose2,
    ) {
        let Some(column) = packet.columns.first() else { return };
        self.compares = !self.compares;
        if self.compares {
            self.see_repetition(column, pose);
        } else {
            self.see_rings((column, u32::from(packet.range_unit_mm)), (rays, table));
        }
    }

    /// How long each lower ring has been silent.
    fn see_rings(
        &mut self,
        (column, unit_mm): (&LidarColumn, u32),
        (rays, table): (&LidarRays, &PacketTable),
    ) {
        let step_cdeg = column.azimuth_cdeg.wrapping_sub(self.azimuth_cdeg);
        if column.azimuth_cdeg < self.azimuth_cdeg {
            self.is_covered = self.widest_cdeg >= COVERED_CDEG;
            self.widest_cdeg = 0;
        }
        self.azimuth_cdeg = column.azimuth_cdeg;
        let Some(bin) = table.bins.get(usize::from(column.azimuth_cdeg / BIN_CDEG)) else { return };
        let rings = column.range_raw.iter().zip(&bin.height_mm).zip(&rays.rings).take(rays.count);
        for (((raw, height_mm), [_, sin]), silent_cdeg) in rings.zip(&mut self.silent_cdeg) {
            let is_silent = u32::from(*raw).saturating_mul(unit_mm) < ON_WINDOW_MM;
            let must_return = *sin < 0.0 && *height_mm < NEAR_FLOOR_MM;
            let run_cdeg = silent_cdeg.saturating_add(step_cdeg.min(PACKET_CDEG));
            *silent_cdeg = if is_silent && must_return { run_cdeg } else { 0 };
            self.widest_cdeg = self.widest_cdeg.max(*silent_cdeg);
        }
        self.is_covered |= self.widest_cdeg >= COVERED_CDEG;
    }

    /// A packet is kept, and the next ones are compared with it; where it does not come again, another one is kept.
    fn see_repetition(&mut self, column: &LidarColumn, pose: Pose2) {
        let (mut print, mut returns) = (0, 0_u8);
        for raw in column.range_raw.iter().step_by(2) {
            print = sum(print, u32::from(*raw));
            returns = returns.wrapping_add(u8::from(*raw != 0));
        }
        if returns < RETURNS_MIN {
            self.since_first = self.since_first.saturating_add(1);
        } else if print == self.lidar.print {
            (self.since_first, self.repeats) = (0, self.repeats.saturating_add(1));
            self.lidar.repeat(pose);
        } else if self.since_first >= REPEAT_PACKETS {
            (self.since_first, self.repeats) = (0, 0);
            self.lidar.begin(print, pose);
        } else {
            self.since_first = self.since_first.saturating_add(1);
        }
    }
}

/// One-to-one in what was summed before and in the word (the 32-bit FNV prime).
const fn sum(print: u32, word: u32) -> u32 {
    (print ^ word).wrapping_mul(0x0100_0193).rotate_left(5)
}
