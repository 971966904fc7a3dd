//! The tasks of the guard ring by number, for recordings: the order of their polls is part of a run in real time.

/// A task of the guard ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GuardTask {
    /// Lidar datagrams.
    Lidar,
    /// The safety scanner.
    Scanner,
    /// The inertial sensor.
    Imu,
    /// The CAN bus.
    Can,
    /// The tick of 10 ms.
    Supervise,
    /// What the mission would like.
    Command,
    /// What perception advises.
    Advice,
    /// The buttons for reset and start.
    Operator,
    /// The second safety scanner.
    RearScanner,
}

impl GuardTask {
    /// All of them, in the order of their numbers in recordings: new ones come at the end.
    pub const ALL: [Self; 9] = [
        Self::Lidar,
        Self::Scanner,
        Self::Imu,
        Self::Can,
        Self::Supervise,
        Self::Command,
        Self::Advice,
        Self::Operator,
        Self::RearScanner,
    ];

    /// Its number in a recording.
    #[must_use]
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// The task of a number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lidar => "lidar",
            Self::Scanner => "safety scanner",
            Self::Imu => "inertial sensor",
            Self::Can => "CAN bus",
            Self::Supervise => "tick",
            Self::Command => "command",
            Self::Advice => "advice",
            Self::Operator => "operator",
            Self::RearScanner => "rear safety scanner",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lead_back_to_their_tasks() {
        for task in GuardTask::ALL {
            assert_eq!(GuardTask::from_number(task.number()), Some(task));
        }
        assert_eq!(GuardTask::from_number(9), None);
    }
}
