//! The sources that the guard listens to, and how each may fail.

use core::fmt;

use floorguard_types::capacities::REAR_SCANNERS_MAX;

/// Where evidence comes from.
///
/// ```
/// use floorguard_guard::Source;
///
/// assert_eq!(Source::ALL.len(), Source::COUNT);
/// assert_eq!(Source::ALL[Source::Lidar.index()], Source::Lidar);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Source {
    /// Safety laser scanner.
    Scanner,
    /// Three-dimensional lidar, packet by packet.
    Lidar,
    /// Emergency stop, bumpers, cliff sensors.
    Discrete,
    /// Encoders of the rear wheels.
    Wheels,
    /// Inertial measurement unit.
    Imu,
    /// Traction and steering drive.
    Drive,
    /// A command to move.
    Command,
    /// The perception ring.
    Perception,
    /// Second safety laser scanner, which looks behind.
    RearScanner,
}

impl Source {
    /// How many there are: a board lacks the memory for a second scanner.
    pub const COUNT: usize = Self::FIRST + REAR_SCANNERS_MAX;
    /// How many every program knows.
    pub(crate) const FIRST: usize = 8;
    /// All of them, in the order of [`Self::index`].
    pub const ALL: [Self; Self::COUNT] = match Self::EVERY.first_chunk() {
        Some(all) => *all,
        None => [Self::Scanner; Self::COUNT],
    };
    const EVERY: [Self; 9] = [
        Self::Scanner,
        Self::Lidar,
        Self::Discrete,
        Self::Wheels,
        Self::Imu,
        Self::Drive,
        Self::Command,
        Self::Perception,
        Self::RearScanner,
    ];

    /// Position in [`Self::ALL`].
    #[must_use]
    #[allow(clippy::as_conversions, reason = "the number of a variant, not of another type")]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scanner => "safety scanner",
            Self::Lidar => "lidar",
            Self::Discrete => "safety inputs",
            Self::Wheels => "wheel encoders",
            Self::Imu => "inertial sensor",
            Self::Drive => "drive",
            Self::Command => "wanted command",
            Self::Perception => "perception",
            Self::RearScanner => "rear safety scanner",
        }
    }
}

/// What a driver reports about a device that it cannot use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FaultKind {
    /// The line is down.
    LinkDown,
    /// Bytes arrive and make no sense, or numbers are not finite.
    Garbled,
    /// The device itself reports a fault; its code.
    Device(u16),
    /// The optics are dirty or dazzled.
    Contaminated,
    /// The device is in stand-by or still starting.
    StandBy,
    /// Another model, beam count or resolution than configured.
    WrongGeometry,
}

/// How a source is. Only `Healthy` counts as evidence that nothing is there (FG-REQ-010).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Health {
    /// Fresh and plausible.
    Healthy,
    /// Too old.
    Stale,
    /// Arrives on time, to the bit the same as before.
    Frozen,
    /// Arrives on time and sees nothing.
    Blind,
    /// Reports a fault, or claims to come from the future.
    Faulty,
    /// Never arrived.
    #[default]
    Absent,
}

impl fmt::Display for Health {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Healthy => "healthy",
            Self::Stale => "stale",
            Self::Frozen => "frozen",
            Self::Blind => "blind",
            Self::Faulty => "faulty",
            Self::Absent => "absent",
        })
    }
}

/// When the failure of a source matters (book, Guard: Source deadlines).
///
/// ```
/// use floorguard_guard::SourceRules;
///
/// // Slow down to 0.3 m/s after 100 ms of silence, stop after 200 ms.
/// let rules = SourceRules::required(100, 0.3, 200);
/// assert_eq!((rules.limit_after_us, rules.stop_after_us), (100_000, Some(200_000)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceRules {
    /// The robot has it. One that it has not is never asked for.
    pub fitted: bool,
    /// Nothing moves before it was healthy (FG-REQ-012).
    pub required_at_start: bool,
    /// Older than this: limited speed, microseconds.
    pub limit_after_us: u64,
    /// That speed, m/s.
    pub limit_mps: f32,
    /// Older than this: stop, microseconds. `None`: its failure never stops, it only limits.
    pub stop_after_us: Option<u64>,
    /// This many identical samples in a row mean that it is frozen; 0 = not judged.
    pub frozen_samples: u16,
}

impl SourceRules {
    /// Of a source that the robot has not.
    pub const ABSENT: Self = Self {
        fitted: false,
        required_at_start: false,
        limit_after_us: 100_000,
        limit_mps: 0.3,
        stop_after_us: None,
        frozen_samples: 0,
    };

    /// A fitted and required source with its two ages in milliseconds and the speed between them.
    #[must_use]
    pub const fn required(limit_after_ms: u64, limit_mps: f32, stop_after_ms: u64) -> Self {
        Self {
            fitted: true,
            required_at_start: true,
            limit_after_us: limit_after_ms.saturating_mul(1_000),
            limit_mps,
            stop_after_us: Some(stop_after_ms.saturating_mul(1_000)),
            frozen_samples: 0,
        }
    }
}
