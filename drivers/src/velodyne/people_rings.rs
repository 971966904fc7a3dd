//! In which rings of a large lidar people are looked for: those nearest to where a VLP-16 looks, whose shapes were learned.

use floorguard_types::sensing::RingChoice;

use super::model::Model;

/// Above 10.7° there is none: two more from below, where feet are.
const HDL32E: [u8; 16] = [10, 12, 13, 15, 16, 18, 19, 21, 22, 24, 25, 27, 28, 29, 30, 31];
/// Of the rings a third of a degree apart about the horizon every third or fourth.
const VLP32C: [u8; 16] = [0, 1, 2, 3, 4, 5, 7, 10, 14, 18, 22, 26, 28, 29, 30, 31];

impl Model {
    /// Which rings of a lidar go into a sweep; `None` where all of them do.
    #[must_use]
    pub fn people_rings(self) -> Option<RingChoice> {
        match self {
            Self::Vlp16 | Self::HiRes => None,
            Self::Vlp32C => RingChoice::new(VLP32C),
            Self::Hdl32E => RingChoice::new(HDL32E),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between the lowest and the highest chosen ring bodies are seen about as densely as by a VLP-16.
    #[test]
    fn chosen_rings_leave_no_wide_gap() {
        for (model, widest_deg) in [(Model::Hdl32E, 2.7), (Model::Vlp32C, 4.7)] {
            let angles = model.ring_angles();
            let chosen = model.people_rings().expect("of 32 rings");
            let elevations_deg = chosen.rings().map(|ring| angles[usize::from(ring)].elevation_deg);
            let between = elevations_deg.iter().zip(&elevations_deg[1..]);
            for (below, above) in between.filter(|(below, _)| **below > -16.0) {
                assert!(above - below < widest_deg, "{model:?}: {below} to {above}");
            }
            assert!(elevations_deg[15] > 10.0 && elevations_deg[0] < -15.0);
        }
        assert!(Model::Vlp16.people_rings().is_none() && Model::HiRes.people_rings().is_none());
    }
}
