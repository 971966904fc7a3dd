//! Why the guard objects: every cause, in a fixed order and in words. What each demands is in `guard`.

use core::fmt;

use super::source::Source;
use floorguard_types::capacities::REAR_SCANNERS_MAX;

/// How many causes there are, counting each source's two.
pub const CAUSES: usize =
    PLAIN.len() + 2 * Source::FIRST + LATER.len() - NOT_ON_BOARDS + 2 * REAR_SCANNERS_MAX;

/// Why the guard objects.
///
/// ```
/// use floorguard_guard::{Action, Cause, Source};
///
/// assert_eq!(Cause::EmergencyStop.action(), Action::Category0);
/// assert_eq!(Cause::all().len(), floorguard_guard::CAUSES);
/// assert!(Cause::SourceLost(Source::Lidar).action().stops());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cause {
    /// Not every required source was healthy yet.
    StartUp,
    /// Nobody has given the start command since power-up, or since the last reset.
    StartNeeded,
    /// Emergency stop pressed.
    EmergencyStop,
    /// The channels of a safety input disagree, or its line is cut.
    InputFault,
    /// A safety input was not read.
    InputUnknown,
    /// Contact at the front.
    BumperFront,
    /// Contact at the rear.
    BumperRear,
    /// No floor at the front.
    CliffFront,
    /// No floor at the rear.
    CliffRear,
    /// The scanner sees something in the protective field.
    ScanProtective,
    /// A lidar packet shows something in the protective field.
    LidarProtective,
    /// Too many beams of the protective field say nothing.
    BlindSector,
    /// Something in the warning field.
    Warning,
    /// The body would touch something that was seen, and no distance is left to approach it.
    WayClosed,
    /// The body would touch something that was seen: slowly enough to stand before it.
    WayNarrow,
    /// A person within 1.2 m.
    PersonNear,
    /// A person would be reached before the robot could stop.
    CollisionStop,
    /// A person would be reached within three seconds.
    CollisionSlow,
    /// Perception asks for a stop.
    AdviceStop,
    /// Perception asks for a lower speed.
    AdviceLimit,
    /// The wanted command is not a number.
    CommandInvalid,
    /// Faster than permitted for longer than tolerated.
    Overspeed,
    /// Held, and yet it moves.
    StandstillLost,
    /// Encoders and drive disagree about the speed.
    SpeedDisagreement,
    /// Encoders and gyroscope disagree about the turning rate.
    TurnDisagreement,
    /// Encoders and steering angle disagree about the turning rate: the wheel slips.
    SteeringDisagreement,
    /// The drive reports a fault.
    DriveFault,
    /// The guard's own clock ran backwards.
    ClockFault,
    /// The guard's state and its copy differ.
    StateCorrupted,
    /// A source is late.
    SourceLate(Source),
    /// A source is lost.
    SourceLost(Source),
}

/// The first of them. Files and kept memory have a bit for each [`Cause::index`], so that no cause ever gets another one: what is
/// new joins [`LATER`] at its end.
const PLAIN: [Cause; 26] = [
    Cause::StartUp,
    Cause::StartNeeded,
    Cause::EmergencyStop,
    Cause::InputFault,
    Cause::InputUnknown,
    Cause::BumperFront,
    Cause::BumperRear,
    Cause::CliffFront,
    Cause::CliffRear,
    Cause::ScanProtective,
    Cause::LidarProtective,
    Cause::BlindSector,
    Cause::Warning,
    Cause::PersonNear,
    Cause::CollisionStop,
    Cause::CollisionSlow,
    Cause::AdviceStop,
    Cause::AdviceLimit,
    Cause::CommandInvalid,
    Cause::Overspeed,
    Cause::SpeedDisagreement,
    Cause::TurnDisagreement,
    Cause::SteeringDisagreement,
    Cause::DriveFault,
    Cause::ClockFault,
    Cause::StateCorrupted,
];

/// Those that came after the causes of the first sources had their bits.
const LATER: [Cause; 5] = [
    Cause::WayClosed,
    Cause::WayNarrow,
    Cause::StandstillLost,
    Cause::SourceLate(Source::RearScanner),
    Cause::SourceLost(Source::RearScanner),
];
/// Of them, at their end, those of a second scanner.
const NOT_ON_BOARDS: usize = 2;

impl Cause {
    /// Every cause, in the order of [`Self::index`].
    #[must_use]
    pub fn all() -> [Self; CAUSES] {
        let mut all = [Self::StartUp; CAUSES];
        let first = || Source::ALL.into_iter().take(Source::FIRST);
        let of_sources = first().map(Self::SourceLate).chain(first().map(Self::SourceLost));
        for (slot, cause) in all.iter_mut().zip(PLAIN.into_iter().chain(of_sources).chain(LATER)) {
            *slot = cause;
        }
        all
    }

    /// Position in the table of causes.
    #[must_use]
    pub fn index(self) -> usize {
        let later = |index: usize| PLAIN.len().saturating_add(2 * Source::FIRST).saturating_add(index);
        match self {
            Self::WayClosed => later(0),
            Self::WayNarrow => later(1),
            Self::StandstillLost => later(2),
            Self::SourceLate(Source::RearScanner) => later(3),
            Self::SourceLost(Source::RearScanner) => later(4),
            Self::SourceLate(source) => PLAIN.len().saturating_add(source.index()),
            Self::SourceLost(source) => {
                PLAIN.len().saturating_add(Source::FIRST).saturating_add(source.index())
            }
            plain => PLAIN.iter().position(|cause| *cause == plain).unwrap_or(0),
        }
    }

    /// In words, without the source of [`Self::SourceLate`] and [`Self::SourceLost`].
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::StartUp => "start-up check: not every required source was healthy yet",
            Self::StartNeeded => "waits for the start command",
            Self::EmergencyStop => "emergency stop pressed",
            Self::InputFault => "safety input faulty: its channels disagree or its line is cut",
            Self::InputUnknown => "safety input not read",
            Self::BumperFront => "front bumper pressed",
            Self::BumperRear => "rear bumper pressed",
            Self::CliffFront => "no floor at the front",
            Self::CliffRear => "no floor at the rear",
            Self::ScanProtective => "obstacle in the protective field (safety scanner)",
            Self::LidarProtective => "obstacle in the protective field (lidar)",
            Self::BlindSector => "scanner sees nothing in a part of the protective field",
            Self::Warning => "obstacle in the warning field",
            Self::WayClosed => "the body would touch what was seen around it",
            Self::WayNarrow => "little room for the body on its way",
            Self::PersonNear => "person near",
            Self::CollisionStop => "person would be reached before standstill",
            Self::CollisionSlow => "person ahead",
            Self::AdviceStop => "perception asks for a stop",
            Self::AdviceLimit => "perception asks for less speed",
            Self::CommandInvalid => "wanted command is not a number",
            Self::Overspeed => "faster than permitted",
            Self::StandstillLost => "it moves although it is held",
            Self::SpeedDisagreement => "encoders and drive disagree about the speed",
            Self::TurnDisagreement => "encoders and gyroscope disagree about the turning rate",
            Self::SteeringDisagreement => "encoders and steering disagree about the turning rate",
            Self::DriveFault => "drive reports a fault",
            Self::ClockFault => "clock of the guard ran backwards",
            Self::StateCorrupted => "state of the guard is corrupted",
            Self::SourceLate(source) | Self::SourceLost(source) => source.name(),
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
    }
}
