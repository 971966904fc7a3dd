//! Joint association probabilities within one small group of tracks and detections. Source: book, Tracking: Joint
//! association.
//!
//! A joint event gives every detection a track of its own or calls it clutter. The published code enumerates all events,
//! which grows without bound. Here the sum over events is a dynamic program over the set of tracks already used: exact,
//! at most detections × 2^tracks × tracks steps, no enumeration (which is kept as the oracle of the tests).

/// Tracks of one group.
pub const GROUP_TRACKS: usize = 6;
/// Detections of one group.
pub const GROUP_DETECTIONS: usize = 8;
const SETS: usize = 1 << GROUP_TRACKS;

/// Probability that a person is detected (book, Tracking: Joint association).
const DETECTED: f32 = 0.8;
/// Density of clutter, 1/m² (book, Tracking: Joint association).
const CLUTTER: f32 = 0.2;
/// Smallest probability that makes an assignment (book, Tracking: Joint association).
const PROBABILITY_MIN: f32 = 0.1;

/// One group: the likelihood of each detection under each track, 0 outside the gate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointGroup {
    /// By detection, then by track, 1/m².
    pub likelihood: [[f32; GROUP_TRACKS]; GROUP_DETECTIONS],
    /// Detections in use.
    pub detections: usize,
    /// Tracks in use.
    pub tracks: usize,
}

/// Probabilities per track: of each detection, and of being missed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marginals {
    /// By track, then by detection.
    pub detection: [[f32; GROUP_DETECTIONS]; GROUP_TRACKS],
    /// By track.
    pub missed: [f32; GROUP_TRACKS],
}

type Sets = [f32; SETS];

impl JointGroup {
    /// Nobody and nothing.
    pub const EMPTY: Self =
        Self { likelihood: [[0.0; GROUP_TRACKS]; GROUP_DETECTIONS], detections: 0, tracks: 0 };

    /// Weights of a detection: of clutter, and of each track. Divided by their largest, so that products of many stay
    /// within range (the reference sums raw exponentials and can underflow).
    fn weights(&self, row: &[f32; GROUP_TRACKS]) -> (f32, [f32; GROUP_TRACKS]) {
        let tracks = row.map(|likelihood| likelihood * (DETECTED / (1.0 - DETECTED)));
        let largest = tracks.iter().fold(CLUTTER, |most, weight| most.max(*weight));
        (CLUTTER / largest, tracks.map(|weight| weight / largest))
    }

    /// β: exact sums over all joint events.
    #[must_use]
    pub fn marginals(&self) -> Marginals {
        let rows = || self.likelihood.iter().take(self.detections);
        // forward[j][set]: weight of all events of the first j detections that use exactly the tracks of the set.
        let mut forward = [[0.0_f32; SETS]; GROUP_DETECTIONS + 1];
        let mut reached: Sets = [0.0; SETS];
        if let Some(empty) = reached.first_mut() {
            *empty = 1.0;
        }
        for (row, slot) in rows().zip(forward.iter_mut()) {
            *slot = reached;
            reached = step_forward(&reached, self.weights(row), self.tracks);
        }
        let total: f32 = reached.iter().sum();
        let mut marginals =
            Marginals { detection: [[0.0; GROUP_DETECTIONS]; GROUP_TRACKS], missed: [1.0; GROUP_TRACKS] };
        // backward[set]: weight of all ways to go on once the tracks of the set are used.
        let mut backward: Sets = [1.0; SETS];
        for (index, row) in rows().enumerate().rev() {
            let weights = self.weights(row);
            let Some(before) = forward.get(index) else { continue };
            for (track, weight) in weights.1.iter().enumerate().take(self.tracks) {
                let share = joint_weight(before, &backward, track) * weight / total.max(f32::MIN_POSITIVE);
                marginals.set(track, index, share);
            }
            backward = step_backward(&backward, weights, self.tracks);
        }
        marginals
    }
}

/// Sets that contain a track go on from those that do not.
fn step_forward(reached: &Sets, (clutter, weights): (f32, [f32; GROUP_TRACKS]), tracks: usize) -> Sets {
    let mut next = reached.map(|weight| weight * clutter);
    for (track, weight) in weights.iter().enumerate().take(tracks) {
        let bit = 1 << track;
        for (set, value) in next.iter_mut().enumerate().filter(|(set, _)| set & bit != 0) {
            *value += reached.get(set ^ bit).copied().unwrap_or(0.0) * weight;
        }
    }
    next
}

fn step_backward(later: &Sets, (clutter, weights): (f32, [f32; GROUP_TRACKS]), tracks: usize) -> Sets {
    let mut earlier = later.map(|weight| weight * clutter);
    for (track, weight) in weights.iter().enumerate().take(tracks) {
        let bit = 1 << track;
        for (set, value) in earlier.iter_mut().enumerate().filter(|(set, _)| set & bit == 0) {
            *value += later.get(set | bit).copied().unwrap_or(0.0) * weight;
        }
    }
    earlier
}

/// Weight of all events in which a detection takes `track`.
fn joint_weight(before: &Sets, after: &Sets, track: usize) -> f32 {
    let bit = 1 << track;
    let free = before.iter().enumerate().filter(|(set, _)| set & bit == 0);
    free.map(|(set, weight)| weight * after.get(set | bit).copied().unwrap_or(0.0)).sum()
}

impl Marginals {
    fn set(&mut self, track: usize, detection: usize, share: f32) {
        if let (Some(row), Some(missed)) = (self.detection.get_mut(track), self.missed.get_mut(track))
            && let Some(slot) = row.get_mut(detection)
        {
            *slot = share;
            *missed = (*missed - share).max(0.0);
        }
    }

    /// Detection of each track. Takes the largest probability above the minimum again and again; ends when there is none
    /// (the reference then never ends).
    #[must_use]
    pub fn assign(&self, tracks: usize) -> [Option<usize>; GROUP_TRACKS] {
        let mut assigned = [None; GROUP_TRACKS];
        let (mut decided, mut taken) = ([false; GROUP_TRACKS], [false; GROUP_DETECTIONS]);
        for _ in 0..GROUP_TRACKS {
            let mut best: Option<(f32, usize, Option<usize>)> = None;
            for (track, _) in decided.iter().enumerate().take(tracks).filter(|(_, decided)| !**decided) {
                let missed = self.missed.get(track).map(|share| (*share, None));
                let shares = self.detection.get(track).into_iter().flatten().zip(&taken).enumerate();
                let free = shares.filter(|(_, (_, taken))| !**taken);
                for (share, choice) in free.map(|(index, (share, _))| (*share, Some(index))).chain(missed) {
                    if share > best.map_or(PROBABILITY_MIN, |(most, ..)| most) {
                        best = Some((share, track, choice));
                    }
                }
            }
            let Some((_, track, choice)) = best else { break };
            if let (Some(slot), Some(decided)) = (assigned.get_mut(track), decided.get_mut(track)) {
                (*slot, *decided) = (choice, true);
            }
            if let Some(taken) = choice.and_then(|index| taken.get_mut(index)) {
                *taken = true;
            }
        }
        assigned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums over all joint events, one by one: recursion is fine in a test.
    fn enumerate(
        group: &JointGroup,
        detection: usize,
        used: usize,
        weight: f64,
        choice: &mut [usize; 8],
        out: &mut [[f64; 9]; 6],
    ) {
        if detection == group.detections {
            for (track, row) in out.iter_mut().enumerate().take(group.tracks) {
                let of = (0..group.detections).find(|index| choice[*index] == track).unwrap_or(8);
                row[of] += weight * event_factor(used, group.tracks);
            }
            return;
        }
        choice[detection] = 99;
        enumerate(group, detection + 1, used, weight * 0.2, choice, out);
        for track in (0..group.tracks).filter(|track| used >> track & 1 == 0) {
            choice[detection] = track;
            let likelihood = f64::from(group.likelihood[detection][track]);
            enumerate(group, detection + 1, used | 1 << track, weight * likelihood, choice, out);
        }
        choice[detection] = 99;
    }

    fn event_factor(used: usize, tracks: usize) -> f64 {
        (0..tracks).map(|track| if used >> track & 1 == 1 { 0.8 } else { 0.2 }).product()
    }

    fn enumerated(group: &JointGroup) -> [[f64; 9]; 6] {
        let mut out = [[0.0; 9]; 6];
        enumerate(group, 0, 0, 1.0, &mut [99; 8], &mut out);
        for row in &mut out {
            let total: f64 = row.iter().sum();
            row.iter_mut().for_each(|value| *value /= total.max(1e-300));
        }
        out
    }

    fn normal(distance2: f32, variance: f32) -> f32 {
        libm::expf(-0.5 * distance2 / variance) / (2.0 * core::f32::consts::PI * variance)
    }

    /// The test values of the book, Tracking: Joint association.
    #[test]
    fn marginals_equal_the_vector() {
        let mut group = JointGroup { detections: 2, tracks: 2, ..JointGroup::EMPTY };
        group.likelihood[0][..2].copy_from_slice(&[normal(0.04, 0.09), normal(0.64, 0.09)]);
        group.likelihood[1][..2].copy_from_slice(&[normal(0.50, 0.09), normal(0.10, 0.09)]);
        let marginals = group.marginals();
        let wanted = [[0.957_564, 0.007_020, 0.035_416], [0.005_132, 0.944_815, 0.050_052]];
        for (track, wanted) in wanted.iter().enumerate() {
            let found =
                [marginals.detection[track][0], marginals.detection[track][1], marginals.missed[track]];
            for (value, expected) in found.iter().zip(wanted) {
                assert!((value - expected).abs() < 2.0e-6, "track {track}: {found:?}");
            }
        }
        assert_eq!(marginals.assign(2)[..2], [Some(0), Some(1)]);
    }

    /// A track whose two detections are taken and whose miss is unlikely: the reference hangs here.
    #[test]
    fn assignment_ends_without_a_choice() {
        let mut marginals = Marginals { detection: [[0.0; 8]; 6], missed: [0.0; 6] };
        marginals.detection[0][0] = 0.9;
        marginals.detection[1][1] = 0.9;
        marginals.detection[2][..2].copy_from_slice(&[0.45, 0.45]);
        marginals.missed[2] = 0.1;
        assert_eq!(marginals.assign(3)[..3], [Some(0), Some(1), None]);
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig::with_cases(64))]
        #[test]
        fn sums_equal_the_enumeration(
            values in proptest::array::uniform30(0.0_f32..20.0),
            tracks in 1_usize..=5,
            detections in 1_usize..=5,
        ) {
            let mut group = JointGroup { detections, tracks, ..JointGroup::EMPTY };
            for (index, value) in values.iter().enumerate().filter(|(_, value)| **value > 5.0) {
                if index / 6 < detections && index % 6 < tracks {
                    group.likelihood[index / 6][index % 6] = *value;
                }
            }
            let (marginals, wanted) = (group.marginals(), enumerated(&group));
            for (track, wanted) in wanted.iter().enumerate().take(tracks) {
                proptest::prop_assert!((f64::from(marginals.missed[track]) - wanted[8]).abs() < 1e-5);
                for (found, wanted) in marginals.detection[track].iter().zip(wanted).take(detections) {
                    proptest::prop_assert!((f64::from(*found) - wanted).abs() < 1e-5);
                }
            }
        }
    }
}
