//! In which rings of a large lidar people are looked for: those nearest to where a VLP-16 looks, whose shapes were learned.

use floorguard_types::sensing::RingChoice;

use super::model::Model;

/// Above 10.7° there is none: two more from below, where feet are.
const HDL32E: [u8; 16] = [10, 12, 13, 15, 16, 18, 19, 21, 22, 24, 25, 27, 28, 29, 30, 31];
/// Of the rings a third of a degree apart about the horizon every third or fourth.
const VLP32C: [u8; 16] = [0, 1, 2, 3, 4, 5, 7, 10, 14, 18, 22, 26, 28, 29, 30, 31];

/// For a second look: the six that are left out between the lowest and the highest, and of the others the ten nearest to the
/// horizon, where people far away are.
const HDL32E_SECOND: [u8; 16] = [11, 14, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29];
/// All others: between 5.3° below the horizon and 3.3° above it.
const VLP32C_SECOND: [u8; 16] = [6, 8, 9, 11, 12, 13, 15, 16, 17, 19, 20, 21, 23, 24, 25, 27];

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

    /// Which rings are looked at once more, for people far away; `None` where there are no others.
    #[must_use]
    pub fn second_people_rings(self) -> Option<RingChoice> {
        match self {
            Self::Vlp16 | Self::HiRes => None,
            Self::Vlp32C => RingChoice::new(VLP32C_SECOND),
            Self::Hdl32E => RingChoice::new(HDL32E_SECOND),
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

    /// Both choices together have every ring from below the horizon to above it, and the second one lies between the first.
    #[test]
    fn second_rings_lie_between_the_first() {
        for (model, new_min) in [(Model::Hdl32E, 6), (Model::Vlp32C, 16)] {
            let angles = model.ring_angles();
            let [first, second] = [model.people_rings(), model.second_people_rings()]
                .map(|choice| choice.expect("of 32 rings"));
            let elevation_deg = |ring: u8| angles[usize::from(ring)].elevation_deg;
            let lies_between = |ring: &&u8| {
                let below = first.rings().iter().any(|other| other < *ring);
                below && first.rings().iter().any(|other| other > *ring) && !first.rings().contains(ring)
            };
            assert!(second.rings().iter().filter(lies_between).count() >= new_min, "{model:?}");
            for ring in (0..32).filter(|ring| (-16.0..11.0).contains(&elevation_deg(*ring))) {
                let is_chosen = first.rings().contains(&ring) || second.rings().contains(&ring);
                assert!(is_chosen, "{model:?}: {} degrees", elevation_deg(ring));
            }
        }
        assert!(Model::Vlp16.second_people_rings().is_none() && Model::HiRes.second_people_rings().is_none());
    }
}
