//! Kinds of people.

use serde::{Deserialize, Serialize};

/// Who it is, as far as a laser can tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PersonKind {
    /// Standing or walking.
    #[default]
    Adult,
    /// Small.
    Child,
    /// Sitting in a wheelchair.
    Wheelchair,
    /// Crouching at the lowest board of a shelf.
    Crouching,
    /// Pushing a shopping trolley.
    Trolley,
    /// Pulling a suitcase.
    Luggage,
    /// Lying on the floor, the head in front.
    Lying,
    /// Standing bent with an arm stretched out to a low board.
    Reaching,
}

impl PersonKind {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Adult,
        Self::Child,
        Self::Wheelchair,
        Self::Crouching,
        Self::Trolley,
        Self::Luggage,
        Self::Lying,
        Self::Reaching,
    ];

    /// Metres.
    #[must_use]
    pub const fn height_m(self) -> f32 {
        match self {
            Self::Adult | Self::Trolley | Self::Luggage => 1.75,
            Self::Child => 1.15,
            Self::Wheelchair => 1.30,
            Self::Crouching => 0.95,
            Self::Lying => 0.30,
            Self::Reaching => 1.45,
        }
    }

    /// For reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Adult => "adult",
            Self::Child => "child",
            Self::Wheelchair => "wheelchair",
            Self::Crouching => "crouching person",
            Self::Trolley => "person with a trolley",
            Self::Luggage => "person with luggage",
            Self::Lying => "lying person",
            Self::Reaching => "reaching person",
        }
    }

    /// Radius of the body seen from above, metres.
    #[must_use]
    pub const fn radius_m(self) -> f32 {
        match self {
            Self::Child => 0.18,
            Self::Wheelchair => 0.38,
            Self::Crouching => 0.28,
            Self::Lying => 0.45,
            _ => 0.25,
        }
    }

    /// So fast somebody with a trolley, luggage or a wheelchair turns, rad/s; all others look at once where they go.
    #[must_use]
    pub const fn turns_radps(self) -> Option<f32> {
        match self {
            Self::Trolley | Self::Luggage | Self::Wheelchair => Some(2.0),
            _ => None,
        }
    }
}
