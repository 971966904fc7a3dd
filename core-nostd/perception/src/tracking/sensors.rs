//! Which sensors see people, and what their word is worth. Source: book, Tracking: Sensors.

/// Sensors whose detections go into the one list of people.
pub const PEOPLE_SENSORS: usize = 3;

/// A sensor that sees people.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PeopleSensor {
    /// The three-dimensional lidar: whole bodies all around, ten times a second.
    #[default]
    Lidar,
    /// The safety scanner: pairs of legs in front, 25 times a second.
    Scanner,
    /// A camera for colour and depth.
    DepthCamera,
}

impl PeopleSensor {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; PEOPLE_SENSORS] = [Self::Lidar, Self::Scanner, Self::DepthCamera];

    /// Place in tables by sensor.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Lidar => 0,
            Self::Scanner => 1,
            Self::DepthCamera => 2,
        }
    }

    /// Share of a shape's log-odds that a sighting adds to the belief: shapes that follow each other quickly are
    /// not independent, so the share falls with the rate.
    pub(crate) const fn evidence_weight(self) -> f32 {
        match self {
            Self::Lidar => 0.25,
            Self::Scanner => 0.06,
            Self::DepthCamera => 0.08,
        }
    }

    /// What a sighting is worth for confirming a track, in fifteenths of three sightings by the lidar: legs need five
    /// (book, Tracking: Sensors).
    pub(super) const fn weight(self) -> u16 {
        match self {
            Self::Lidar => 5,
            Self::Scanner | Self::DepthCamera => 3,
        }
    }

    /// Log-odds subtracted by an observation that should have shown a person and did not, if this sensor never saw
    /// the person. Only the lidar finds nearly everybody; legs in a long coat are no reason to doubt.
    pub(super) const fn doubt(self) -> f32 {
        match self {
            Self::Lidar => 0.4,
            Self::Scanner | Self::DepthCamera => 0.0,
        }
    }

    /// How much longer than the lidar this sensor may miss a person that it saw before.
    pub(super) const fn patience(self) -> u64 {
        match self {
            Self::Lidar => 1,
            Self::Scanner | Self::DepthCamera => 2,
        }
    }
}

/// Some sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorSet(u8);

impl SensorSet {
    /// No sensor.
    pub const NONE: Self = Self(0);

    /// With one sensor more.
    #[must_use]
    pub const fn with(self, sensor: PeopleSensor) -> Self {
        Self(self.0 | Self::bit(sensor))
    }

    /// The sensor is in it.
    #[must_use]
    pub const fn contains(self, sensor: PeopleSensor) -> bool {
        self.0 & Self::bit(sensor) != 0
    }

    /// No sensor is in both.
    #[must_use]
    pub const fn is_disjoint(self, other: Self) -> bool {
        self.0 & other.0 == 0
    }

    /// One bit a sensor: 1 lidar, 2 scanner, 4 depth camera.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    const fn bit(sensor: PeopleSensor) -> u8 {
        match sensor {
            PeopleSensor::Lidar => 1,
            PeopleSensor::Scanner => 2,
            PeopleSensor::DepthCamera => 4,
        }
    }
}
