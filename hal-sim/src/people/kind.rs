//! Kinds of people.

use serde::Deserialize;

/// Who it is, as far as a laser can tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
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
}

impl PersonKind {
    /// Metres.
    #[must_use]
    pub const fn height_m(self) -> f32 {
        match self {
            Self::Adult | Self::Trolley | Self::Luggage => 1.75,
            Self::Child => 1.15,
            Self::Wheelchair => 1.30,
            Self::Crouching => 0.95,
        }
    }

    /// Radius of the body seen from above, metres.
    #[must_use]
    pub const fn radius_m(self) -> f32 {
        match self {
            Self::Child => 0.18,
            Self::Wheelchair => 0.38,
            Self::Crouching => 0.28,
            _ => 0.25,
        }
    }
}
