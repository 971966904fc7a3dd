//! What each cause demands, how it may clear, and whether the robot may leave meanwhile.

use crate::protection::{Action, Cause, Source};

/// Microseconds without evidence before a stop clears by itself: leave Stop after at least 1.0 s (book, Guard: Causes,
/// FG-REQ-009).
pub const STOP_QUIET_US: u64 = 1_000_000;
/// The same for a limit: long enough that a flicker of the evidence does not shake the robot.
pub const LIMIT_QUIET_US: u64 = 500_000;

/// How a cause may clear (book, Guard: Causes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clear {
    /// By itself, after this many microseconds without evidence.
    Quiet(u64),
    /// By the operator's start command, once nothing is latched and the sensors have been healthy.
    Start,
    /// By the operator, and only with a passed self-test; a start command follows (FG-REQ-019).
    Reset,
    /// Never without a restart.
    Restart,
}

/// In which direction the robot may leave although the cause is active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Escape {
    /// In none.
    Never,
    /// Forward only.
    Forward,
    /// Backward only.
    Backward,
    /// Wherever no piece of evidence comes nearer.
    AwayFromEvidence,
}

impl Cause {
    /// What it demands (FG-REQ-002).
    #[must_use]
    pub const fn action(self) -> Action {
        match self {
            Self::EmergencyStop | Self::DriveFault | Self::StateCorrupted | Self::StandstillLost => {
                Action::Category0
            }
            Self::InputFault
            | Self::InputUnknown
            | Self::Overspeed
            | Self::SpeedDisagreement
            | Self::TurnDisagreement
            | Self::ClockFault
            | Self::SourceLost(Source::Discrete | Source::Drive) => Action::Category1,
            Self::Warning
            | Self::WayNarrow
            | Self::PersonNear
            | Self::CollisionSlow
            | Self::AdviceLimit
            | Self::SourceLate(_) => Action::Limit,
            _ => Action::Category2,
        }
    }

    /// How it may clear (FG-REQ-003). Contact, cliff, emergency stop and faults of the machine need an operator (ISO
    /// 3691-4 4.1.14, IEC 63327 7.8), and so do power that comes back and inputs that could not be read: who pressed a
    /// button meanwhile was not heard. A mere obstacle does not (IEC 63327 7.9).
    #[must_use]
    pub const fn clear(self) -> Clear {
        match self {
            Self::StateCorrupted => Clear::Restart,
            Self::StartNeeded => Clear::Start,
            Self::EmergencyStop
            | Self::InputFault
            | Self::InputUnknown
            | Self::BumperFront
            | Self::BumperRear
            | Self::CliffFront
            | Self::CliffRear
            | Self::Overspeed
            | Self::StandstillLost
            | Self::SpeedDisagreement
            | Self::TurnDisagreement
            | Self::DriveFault
            | Self::ClockFault
            | Self::SourceLost(Source::Discrete | Source::Drive) => Clear::Reset,
            _ if matches!(self.action(), Action::Limit) => Clear::Quiet(LIMIT_QUIET_US),
            _ => Clear::Quiet(STOP_QUIET_US),
        }
    }

    /// Only a person's act ends it: a reset, or a restart.
    #[must_use]
    pub fn is_latching(self) -> bool {
        matches!(self.clear(), Clear::Reset | Clear::Restart)
    }

    /// In which direction the robot may leave (FG-REQ-040).
    #[must_use]
    pub const fn escape(self) -> Escape {
        match self {
            Self::BumperFront | Self::CliffFront => Escape::Backward,
            Self::BumperRear | Self::CliffRear => Escape::Forward,
            Self::ScanProtective | Self::LidarProtective => Escape::AwayFromEvidence,
            _ => Escape::Never,
        }
    }
}
