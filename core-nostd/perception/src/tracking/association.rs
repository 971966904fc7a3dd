//! Which detection belongs to which track. Source: book, Tracking: Gating; book, Tracking: Joint association.

use heapless::Vec;

use super::joint::{GROUP_DETECTIONS, GROUP_TRACKS, JointGroup};
use floorguard_types::number::truncating_u16;
use floorguard_types::profile::{Entry, List, ListOf, Profile, Size, Table, TableOf};

/// How detections are given to tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Association {
    /// The cheapest pair first.
    #[default]
    Nearest,
    /// By joint probability within each group of tracks that share detections (NNJPDA); groups that are too large fall
    /// back to the nearest and are counted.
    Joint,
}

/// Room for detections, for each track.
pub(super) const DETECTIONS_A_TRACK: usize = 2;
/// Each track may have eight detections within its gate.
const PAIRS_A_TRACK: usize = 8;

/// A detection within the gate of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pair {
    /// d² + ln|S|: −2 ln of the likelihood, but for a constant.
    cost: f32,
    track: u16,
    detection: u16,
}

/// Working memory of the association, kept off the stack.
#[derive(Clone, Debug)]
pub(super) struct Associator<P: Profile> {
    pairs: ListOf<Pair, P::Pairs>,
    /// Pairs that may be kept.
    pairs_max: usize,
    /// Detection of each track.
    matches: TableOf<Option<u16>, P::Tracks>,
    used: TableOf<bool, P::Detections>,
    /// The track was in a group that is not too large.
    solved: TableOf<bool, P::Tracks>,
    /// Pairs of each track and of each detection.
    rivals: (TableOf<u8, P::Tracks>, TableOf<u8, P::Detections>),
    /// Pairs not considered because the list was full.
    pub(super) dropped_pairs: u32,
    /// Tracks that fell back to the nearest detection.
    pub(super) large_groups: u32,
}

/// Tracks and detections that share each other.
#[derive(Default)]
struct Group {
    tracks: Vec<u16, GROUP_TRACKS>,
    detections: Vec<u16, GROUP_DETECTIONS>,
}

impl<P: Profile> Associator<P> {
    pub(super) const fn new() -> Self {
        const { assert!(P::Detections::N == DETECTIONS_A_TRACK * P::Tracks::N) };
        const { assert!(P::Pairs::N == PAIRS_A_TRACK * P::Tracks::N) };
        Self {
            pairs: List::EMPTY,
            pairs_max: P::Pairs::N,
            matches: Entry::BLANK,
            used: Entry::BLANK,
            solved: Entry::BLANK,
            rivals: (Entry::BLANK, Entry::BLANK),
            dropped_pairs: 0,
            large_groups: 0,
        }
    }

    /// Begins anew, for so many tracks at most.
    pub(super) fn clear(&mut self, tracks_max: usize) {
        self.pairs.clear();
        self.pairs_max = tracks_max.saturating_mul(PAIRS_A_TRACK);
        self.matches.fill(None);
        self.used.fill(false);
        self.solved.fill(false);
    }

    /// A pair within the gate.
    pub(super) fn add(&mut self, track: usize, detection: usize, cost: f32) {
        let pair = Pair { cost, track: truncating_u16(track), detection: truncating_u16(detection) };
        if self.pairs.len() >= self.pairs_max.min(P::Pairs::N) || self.pairs.push(pair).is_err() {
            self.dropped_pairs = self.dropped_pairs.saturating_add(1);
        }
    }

    /// Decides. Ties go to the older track, then to the earlier detection.
    pub(super) fn solve(&mut self, association: Association) {
        if association == Association::Joint {
            for track in 0..P::Tracks::N {
                self.solve_group_of(track);
            }
        }
        self.solve_nearest();
    }

    /// The detection of a track.
    pub(super) fn detection_of(&self, track: usize) -> Option<usize> {
        self.matches.get(track).copied().flatten().map(usize::from)
    }

    /// The detection belongs to a track.
    pub(super) fn is_used(&self, detection: usize) -> bool {
        self.used.get(detection).copied().unwrap_or(true)
    }

    /// Greedy minimum assignment (book, Conventions: Greedy assignment): the cheapest pair that is still free, at most
    /// once per track. A sort would be shorter, but that of the library recurses and may panic.
    fn solve_nearest(&mut self) {
        self.solve_lonely();
        for _ in 0..P::Tracks::N {
            let mut cheapest: Option<Pair> = None;
            for pair in self.pairs.iter().filter(|pair| self.is_free(pair)) {
                if cheapest.is_none_or(|other| pair.cost < other.cost) {
                    cheapest = Some(*pair);
                }
            }
            let Some(pair) = cheapest else { break };
            self.take(pair);
        }
    }

    /// Where a track and a detection have nobody but each other, no order decides: they go first, so that only what is
    /// disputed is searched again and again.
    fn solve_lonely(&mut self) {
        let (of_tracks, of_detections) = &mut self.rivals;
        of_tracks.fill(0);
        of_detections.fill(0);
        for pair in self.pairs.iter() {
            let (track, detection) = (usize::from(pair.track), usize::from(pair.detection));
            if let (Some(a), Some(b)) = (of_tracks.get_mut(track), of_detections.get_mut(detection)) {
                (*a, *b) = (a.saturating_add(1), b.saturating_add(1));
            }
        }
        for index in 0..P::Pairs::N {
            let Some(pair) = self.pairs.get(index).copied() else { break };
            let (of_tracks, of_detections) = &self.rivals;
            let rivals =
                (of_tracks.get(usize::from(pair.track)), of_detections.get(usize::from(pair.detection)));
            if rivals == (Some(&1), Some(&1)) && self.is_free(&pair) {
                self.take(pair);
            }
        }
        let Self { pairs, used, .. } = self;
        pairs.retain(|pair| used.get(usize::from(pair.detection)) == Some(&false));
    }

    fn take(&mut self, pair: Pair) {
        if let (Some(matched), Some(used)) =
            (self.matches.get_mut(usize::from(pair.track)), self.used.get_mut(usize::from(pair.detection)))
        {
            (*matched, *used) = (Some(pair.detection), true);
        }
    }

    fn is_free(&self, pair: &Pair) -> bool {
        let track = usize::from(pair.track);
        self.solved.get(track) == Some(&false)
            && self.detection_of(track).is_none()
            && !self.is_used(usize::from(pair.detection))
    }

    // Not inlined, here and below: each frame is gone before the next one comes.
    #[inline(never)]
    fn solve_group_of(&mut self, seed: usize) {
        if self.solved.get(seed) != Some(&false) {
            return;
        }
        let seed = truncating_u16(seed);
        if !self.pairs.iter().any(|pair| pair.track == seed) {
            return;
        }
        let Some(group) = self.grow(seed) else {
            self.large_groups = self.large_groups.saturating_add(1);
            return;
        };
        let assigned = self.joint(&group).marginals().assign(group.tracks.len());
        for (track, choice) in group.tracks.iter().zip(assigned) {
            let detection = choice.and_then(|index| group.detections.get(index)).copied();
            if let (Some(matched), Some(solved)) =
                (self.matches.get_mut(usize::from(*track)), self.solved.get_mut(usize::from(*track)))
            {
                (*matched, *solved) = (detection, true);
            }
            if let Some(used) = detection.and_then(|detection| self.used.get_mut(usize::from(detection))) {
                *used = true;
            }
        }
    }

    /// Everything that hangs together with a track; `None` if that is too much. Each round but the last adds a member,
    /// so there are at most as many rounds as members.
    fn grow(&self, seed: u16) -> Option<Group> {
        let mut group = Group::default();
        group.tracks.push(seed).ok()?;
        for _ in 0..=GROUP_TRACKS + GROUP_DETECTIONS {
            let mut grown = false;
            for pair in self.pairs.iter() {
                let known = (group.tracks.contains(&pair.track), group.detections.contains(&pair.detection));
                match known {
                    (true, false) => group.detections.push(pair.detection).ok()?,
                    (false, true) => group.tracks.push(pair.track).ok()?,
                    _ => continue,
                }
                grown = true;
            }
            if !grown {
                return Some(group);
            }
        }
        None
    }

    fn joint(&self, group: &Group) -> JointGroup {
        let mut joint = JointGroup {
            detections: group.detections.len(),
            tracks: group.tracks.len(),
            ..JointGroup::EMPTY
        };
        for pair in self.pairs.iter() {
            let row = group.detections.iter().position(|detection| *detection == pair.detection);
            let column = group.tracks.iter().position(|track| *track == pair.track);
            let slot = row.and_then(|row| joint.likelihood.get_mut(row)).zip(column);
            if let Some(likelihood) = slot.and_then(|(row, column)| row.get_mut(column)) {
                *likelihood = libm::expf(-0.5 * pair.cost) / (2.0 * core::f32::consts::PI);
            }
        }
        joint
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::profile::Native;

    fn solved(association: Association, pairs: &[(usize, usize, f32)]) -> Associator<Native> {
        let mut associator = Associator::new();
        pairs.iter().for_each(|(track, detection, cost)| associator.add(*track, *detection, *cost));
        associator.solve(association);
        associator
    }

    /// Costs of the test values of the book, Tracking: Joint association.
    #[test]
    fn both_solvers_solve_the_vector() {
        let pairs = [(0, 0, -4.371_447), (1, 0, 0.739_664), (0, 1, 2.295_22), (1, 1, -3.704_78)];
        for association in [Association::Nearest, Association::Joint] {
            let found = solved(association, &pairs);
            assert_eq!((found.detection_of(0), found.detection_of(1)), (Some(0), Some(1)));
            assert!(found.is_used(0) && found.is_used(1) && !found.is_used(2));
        }
    }

    #[test]
    fn one_detection_serves_one_track() {
        for association in [Association::Nearest, Association::Joint] {
            let found = solved(association, &[(0, 0, -3.0), (1, 0, -4.0)]);
            assert_eq!((found.detection_of(0), found.detection_of(1)), (None, Some(0)), "{association:?}");
        }
    }

    /// The cheapest first, written down once more: isolated pairs, too, and all others.
    #[test]
    fn nearest_equals_its_definition() {
        let mut random = floorguard_types::random::Pcg32::new(4, 4);
        for round in 0..300 {
            let (tracks, share) = (1 + round % 20, [0.03, 0.1, 0.4][round % 3]);
            let mut pairs = std::vec::Vec::new();
            for track in 0..tracks {
                for detection in 0..tracks {
                    if random.uniform() < share {
                        pairs.push((track, detection, random.uniform_between(-4.0, 9.0)));
                    }
                }
            }
            let found = solved(Association::Nearest, &pairs);
            let mut wanted = std::vec![None; tracks];
            pairs.sort_by(|a, b| a.2.total_cmp(&b.2));
            for (track, detection, _) in pairs {
                if wanted[track].is_none() && !wanted.contains(&Some(detection)) {
                    wanted[track] = Some(detection);
                }
            }
            let matches: std::vec::Vec<_> = (0..tracks).map(|track| found.detection_of(track)).collect();
            assert_eq!(matches, wanted, "round {round}");
        }
    }

    #[test]
    fn a_crowd_falls_back_and_is_counted() {
        let pairs: std::vec::Vec<_> = (0..16_usize)
            .flat_map(|track| {
                (0..16_usize).map(move |detection| (track, detection, track.abs_diff(detection) as f32))
            })
            .collect();
        let found = solved(Association::Joint, &pairs);
        assert!(found.large_groups > 0);
        assert!((0..16).all(|track| found.detection_of(track) == Some(track)));
    }
}
