//! Why people were not claimed: by what was found of them, by kind and by distance.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use floorguard_sim::people::PersonKind;

use super::OVERLAP_MIN;
use super::boxes::Bounds;

/// An object that shares less than this with somebody has nothing to do with the person.
const NOTHING: f32 = 0.1;
/// Distances of the table, metres.
const BANDS_M: [f32; 4] = [4.0, 8.0, 12.0, 20.0];

/// What was found of somebody who was not claimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Miss {
    /// A box that fits, which was not taken for a person.
    NotBelieved,
    /// An object that fits, which was no candidate.
    Refused,
    /// An object that is larger: one with what is beside, or with what the person pushes.
    Merged,
    /// Only parts.
    InParts,
    /// Nothing that shares a tenth with the person.
    Nothing,
}

impl Miss {
    const ALL: [(Self, &'static str); 5] = [
        (Self::NotBelieved, "not taken for a person"),
        (Self::Refused, "no candidate"),
        (Self::Merged, "one with something else"),
        (Self::InParts, "in parts"),
        (Self::Nothing, "nothing found"),
    ];

    fn of(label: &Bounds, detections: &[Bounds], clusters: &[Bounds]) -> Self {
        let best = |boxes: &[Bounds]| {
            let overlaps = boxes.iter().map(|bounds| (label.overlap(bounds), *bounds));
            overlaps.max_by(|a, b| a.0.total_cmp(&b.0))
        };
        if best(detections).is_some_and(|(overlap, _)| overlap >= OVERLAP_MIN) {
            return Self::NotBelieved;
        }
        let volume = |bounds: &Bounds| bounds.sides_m().iter().product::<f32>();
        match best(clusters) {
            Some((overlap, _)) if overlap >= OVERLAP_MIN => Self::Refused,
            Some((overlap, cluster)) if overlap >= NOTHING && volume(&cluster) > volume(label) => {
                Self::Merged
            }
            Some((overlap, _)) if overlap >= NOTHING => Self::InParts,
            _ => Self::Nothing,
        }
    }
}

/// All who were missed, and all who were there.
#[derive(Clone, Debug, Default)]
pub struct Misses {
    causes: BTreeMap<(Miss, String), u64>,
    /// By distance: missed, all.
    bands: [[u64; 2]; 4],
}

impl Misses {
    /// A label, whether it was claimed, and what else there was: detections and objects.
    pub fn note(
        &mut self,
        (kind, label): (PersonKind, &Bounds),
        claimed: bool,
        (detections, clusters): (&[Bounds], &[Bounds]),
    ) {
        let band = BANDS_M.iter().position(|far_m| label.distance_m() < *far_m).unwrap_or(3);
        self.bands[band][0] += u64::from(!claimed);
        self.bands[band][1] += 1;
        if !claimed {
            let miss = Miss::of(label, detections, clusters);
            *self.causes.entry((miss, format!("{kind:?}").to_lowercase())).or_default() += 1;
        }
    }

    /// Takes in another run.
    pub fn add(&mut self, other: &Self) {
        for (key, count) in &other.causes {
            *self.causes.entry(key.clone()).or_default() += count;
        }
        for (sum, more) in self.bands.iter_mut().flatten().zip(other.bands.iter().flatten()) {
            *sum += more;
        }
    }

    /// For the table.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::from("  missed");
        for (far_m, [missed, all]) in BANDS_M.iter().zip(self.bands) {
            let _infallible = write!(text, "   below {far_m} m: {missed} of {all}");
        }
        text.push('\n');
        for (miss, name) in Miss::ALL {
            let kinds: Vec<String> = self
                .causes
                .iter()
                .filter(|((cause, _), _)| *cause == miss)
                .map(|((_, kind), count)| format!("{kind} {count}"))
                .collect();
            if !kinds.is_empty() {
                let _infallible = writeln!(text, "    {name:<24} {}", kinds.join(", "));
            }
        }
        text
    }
}
