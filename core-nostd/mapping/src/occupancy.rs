//! What a cell of an occupancy map says. Three values: unseen floor is not free floor.

/// State of a cell of an occupancy map.
///
/// ```
/// use floorguard_mapping::Occupancy;
///
/// // The thresholds of a ROS map: between them a cell is unknown.
/// let occupancy = |probability| Occupancy::from_probability(probability, 0.196, 0.65);
/// assert_eq!([0.0, 0.4, 0.9].map(occupancy), [Occupancy::Free, Occupancy::Unknown, Occupancy::Occupied]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Occupancy {
    /// Not observed. Never driven on, never cleaned, never claimed.
    #[default]
    Unknown,
    /// Floor.
    Free,
    /// Wall, shelf, furniture.
    Occupied,
}

impl Occupancy {
    /// From a grey value of a ROS `map_server` picture: `occupied_probability` is (255 − grey)/255, or grey/255 where
    /// the file says `negate: 1`; strictly above `occupied_threshold` is occupied, strictly below `free_threshold` free.
    #[must_use]
    pub fn from_probability(occupied_probability: f32, free_threshold: f32, occupied_threshold: f32) -> Self {
        if occupied_probability > occupied_threshold {
            Self::Occupied
        } else if occupied_probability < free_threshold {
            Self::Free
        } else {
            Self::Unknown
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_strict() {
        let state = |p| Occupancy::from_probability(p, 0.196, 0.65);
        assert_eq!(state(0.0), Occupancy::Free);
        assert_eq!(state(0.196), Occupancy::Unknown);
        assert_eq!(state(0.65), Occupancy::Unknown);
        assert_eq!(state(1.0), Occupancy::Occupied);
        assert_eq!(state(f32::NAN), Occupancy::Unknown);
    }
}
