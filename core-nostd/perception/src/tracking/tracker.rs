//! Follows people: gating, association, creation, deletion, coasting. Source: book, Tracking.

use super::association::{Association, Associator, DETECTIONS_A_TRACK};
use super::detection::DetectionOf;
use super::filter::ConstantVelocity;
use super::memory::best_of;
use super::sensors::PeopleSensor;
use super::track::{TrackOf, TrackStatus};
use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;
use floorguard_types::profile::{Board, List, ListOf, Native, Profile, Size};
use floorguard_types::time::{Age, Stamp};

/// Beyond this share of the gate's square no closer check is made.
const FAR: f32 = 1.001;

/// How tracks live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerParameters {
    /// Spectral density of a walker's acceleration, m²/s³ (the published noise is 0.065 at the 30 Hz of the reference;
    /// people who start and turn need more at 10 Hz).
    pub acceleration_density: f32,
    /// How detections are given to tracks; joint probabilities lose fewer people in crowds (`cargo xtask reproduce
    /// crowds`).
    pub association: Association,
    /// Mahalanobis gate for two dimensions (99 %; book, Tracking: Gating).
    pub gate: f32,
    /// Sightings before a track is confirmed.
    pub sightings_min: u16,
    /// Misses in a row, where the sensor that found it could see it, that end a tentative track.
    pub tentative_misses_max: u16,
    /// A confirmed track that nobody saw, or could see, for this long is no longer reported, µs (book, Tracking:
    /// Track life).
    pub coast_max_us: u64,
    /// A confirmed track that a sensor should have seen and did not, for this long after the first miss, µs.
    pub missed_max_us: u64,
    /// Sum of the position variances above which a track is no longer reported, m² (book, Tracking: Track
    /// life).
    pub variance_max_m2: f32,
    /// A new track nearer to an old one than this is a duplicate, metres (book, Tracking: Track life).
    pub duplicate_m: f32,
    /// A person out of sight keeps to the last speed for about this long, seconds.
    pub coast_s: f32,
    /// A track that nobody saw for this long may have gone astray, µs.
    pub astray_us: u64,
    /// How long somebody out of sight is remembered, µs.
    pub remembered_us: u64,
    /// Nobody who was out of sight for a moment is looked for farther from where the track says than this, metres: its
    /// doubt grows faster than people walk, and a wide gate takes in strangers.
    pub hidden_gate_m: f32,
    /// Weight of the appearance, 0: none. Observations of one moment are not independent of those before.
    pub appearance_weight: f32,
    /// The same at re-identification: several observations on either side.
    pub recall_appearance_weight: f32,
    /// Tracks at once, at most those of the profile. Twice as many detections and eight
    /// times as many pairs take part.
    pub tracks_max: usize,
}

impl TrackerParameters {
    /// The values of the parameters' own documentation.
    pub const DEFAULT: Self = Self {
        acceleration_density: 0.4,
        association: Association::Joint,
        gate: 3.035,
        sightings_min: 3,
        tentative_misses_max: 2,
        coast_max_us: 2_000_000,
        missed_max_us: 600_000,
        variance_max_m2: 1.0,
        duplicate_m: 0.5,
        coast_s: 1.5,
        astray_us: 250_000,
        remembered_us: 8_000_000,
        hidden_gate_m: 1.5,
        appearance_weight: 0.5,
        recall_appearance_weight: 1.0,
        tracks_max: usize::MAX,
    };

    /// Whatever people look like does not count: as on the board, which keeps no reflectivities.
    pub const WITHOUT_APPEARANCE: Self =
        Self { appearance_weight: 0.0, recall_appearance_weight: 0.0, ..Self::DEFAULT };

    /// With the capacity of the microcontroller, too: the same input gives the same tracks on every machine.
    pub const AS_ON_BOARD: Self =
        Self { tracks_max: <Board as Profile>::Tracks::N, ..Self::WITHOUT_APPEARANCE };

    /// Detections that take part in one association.
    fn detections_max<P: Profile>(&self) -> usize {
        self.tracks_max.saturating_mul(DETECTIONS_A_TRACK).min(P::Detections::N)
    }
}

impl Default for TrackerParameters {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What one sensor saw at one moment.
#[derive(Clone, Copy, Debug)]
pub struct SightingsOf<'a, P: Profile> {
    /// Who looked.
    pub sensor: PeopleSensor,
    /// When.
    pub stamp: Stamp,
    /// What was seen, in the fixed frame.
    pub detections: &'a [DetectionOf<P>],
}

/// Sightings in the memory of the target.
pub type Sightings<'a> = SightingsOf<'a, Native>;

/// The tracks and what happened to them.
#[derive(Clone, Debug)]
pub struct TrackerOf<P: Profile> {
    parameters: TrackerParameters,
    tracks: ListOf<TrackOf<P>, P::Tracks>,
    next_id: u32,
    now: Option<Stamp>,
    /// Tracks given up or not created, and detections that took no part, because the list was full.
    pub dropped: u32,
    /// Sweeps refused because they were older than the newest one.
    pub late: u32,
    associator: Associator<P>,
}

/// A tracker in the memory of the target.
pub type Tracker = TrackerOf<Native>;

/// Somebody seen within this time is expected to be seen again, µs.
const EXPECTED_US: u64 = 1_500_000;
/// Who is unseen for longer than a revolution of the lidar is out of sight, µs.
const UNSEEN_US: u64 = 90_000;
/// Older sightings than this are refused, µs (book, Tracking: Late views).
const LATE_MAX_US: u64 = 200_000;
/// A longer pause than this forgets the tentative tracks, µs (book, Tracking: Late views).
const PAUSE_US: u64 = 2_000_000;

impl<P: Profile> TrackerOf<P> {
    /// Nobody yet.
    #[must_use]
    pub const fn new(parameters: TrackerParameters) -> Self {
        Self {
            parameters,
            tracks: List::EMPTY,
            next_id: 1,
            now: None,
            dropped: 0,
            late: 0,
            associator: Associator::new(),
        }
    }

    /// Detections that take part in one association.
    pub(crate) fn detections_max(&self) -> usize {
        self.parameters.detections_max::<P>()
    }

    /// The tracks, oldest first.
    #[must_use]
    pub fn tracks(&self) -> &[TrackOf<P>] {
        &self.tracks
    }

    /// Takes in what the lidar saw at one moment, see [`Self::take`].
    pub fn update(&mut self, stamp: Stamp, detections: &[DetectionOf<P>], visible: impl Fn(Point2) -> bool) {
        self.take(&SightingsOf { sensor: PeopleSensor::Lidar, stamp, detections }, visible);
    }

    /// Takes in what a sensor saw at one moment. `visible` tells whether this sensor could have seen a person at a point
    /// of the fixed frame. Tracks × detections gate tests.
    ///
    /// What is up to 0.2 s older than the newest update moves the people whom it fits, with more doubt, and does nothing
    /// else (book, Tracking: Late views); what is older still is refused and counted. More detections than twice the
    /// tracks take no part and are counted: the first ones count.
    pub fn take(&mut self, seen: &SightingsOf<'_, P>, visible: impl Fn(Point2) -> bool) {
        let Some(late_s) = self.predict(seen.stamp) else {
            self.late = self.late.saturating_add(1);
            return;
        };
        let excess = seen.detections.len().saturating_sub(self.parameters.detections_max::<P>());
        self.dropped = self.dropped.saturating_add(u32::try_from(excess).unwrap_or(u32::MAX));
        let observation = (seen.sensor, seen.stamp);
        self.associate(observation, (seen.detections, late_s));
        if late_s > 0.0 {
            return;
        }
        for (row, track) in self.tracks.iter_mut().enumerate() {
            if self.associator.detection_of(row).is_none() {
                track.miss(observation, visible(track.state.position), &self.parameters);
            }
        }
        self.recall(seen.stamp);
        self.delete(seen.stamp);
        for (column, detection) in
            seen.detections.iter().enumerate().take(self.parameters.detections_max::<P>())
        {
            if !self.associator.is_used(column) {
                self.create(observation, detection);
            }
        }
        self.unite(seen.stamp);
        self.tracks.iter_mut().for_each(|track| track.explain(seen.stamp));
    }

    /// Where the people who were seen a moment ago are expected at `stamp`, fixed frame.
    pub fn expected(&self, stamp: Stamp) -> impl Iterator<Item = Point2> {
        let seconds = match self.now.map(|now| now.age(stamp)) {
            Some(Age::Past(age_us)) => nearest_f32(age_us) * 1.0e-6,
            _ => 0.0,
        };
        let fresh = move |track: &&TrackOf<P>| {
            let seen = matches!(track.last_seen.age(stamp), Age::Past(age_us) if age_us < EXPECTED_US);
            seen && track.status == TrackStatus::Confirmed && track.belief > 0.0
        };
        self.tracks.iter().filter(fresh).map(move |track| {
            let ConstantVelocity { position, velocity, .. } = track.state;
            Point2::new(position.x_m + seconds * velocity.x_m, position.y_m + seconds * velocity.y_m)
        })
    }

    /// Moves every track to `stamp`. How much older than the tracks it is, seconds: 0 as a rule; `None` if too much.
    fn predict(&mut self, stamp: Stamp) -> Option<f32> {
        let Some(now) = self.now else {
            self.now = Some(stamp);
            return Some(0.0);
        };
        let elapsed_us = match now.age(stamp) {
            Age::Past(elapsed_us) => elapsed_us,
            Age::Future(late_us) => {
                return (late_us <= LATE_MAX_US).then_some((nearest_f32(late_us) * 1.0e-6).max(1.0e-6));
            }
        };
        self.now = Some(stamp);
        if elapsed_us > PAUSE_US {
            self.tracks.retain(|track| track.status != TrackStatus::Tentative);
        }
        let seconds = stamp.seconds_since(now);
        for track in self.tracks.iter_mut() {
            // People slow down in a crowd; who is out of sight is rather waited for than chased.
            if track.last_seen.past_us(now) > UNSEEN_US {
                track.state.slow_down(libm::expf(-seconds / self.parameters.coast_s.max(1.0e-3)));
            }
            track.state.advance(seconds, self.parameters.acceleration_density);
        }
        Some(0.0)
    }

    /// A person reported from now on may be one whose track was lost, or whose track went astray while unseen.
    // Not inlined, here and below: each frame is gone before the next one comes.
    #[inline(never)]
    fn recall(&mut self, stamp: Stamp) {
        let parameters = self.parameters;
        // The last first: who is taken out moves only those who were asked.
        for row in (0..self.tracks.len().min(P::Tracks::N)).rev() {
            let Some(fresh) = self.tracks.get_mut(row).filter(|track| track.is_to_be_named()) else {
                continue;
            };
            fresh.is_named = true;
            let fresh = *fresh;
            let astray = self.tracks.iter().filter(|track| track.may_be_astray(stamp, parameters.astray_us));
            let Some(id) = best_of(astray, &fresh, &parameters) else { continue };
            let Some(old) = self.tracks.iter().find(|track| track.id == id).copied() else { continue };
            if let Some(track) = self.tracks.get_mut(row) {
                track.continue_from(&old);
            }
            // The older of the two, which nobody sees; the younger one has its number now.
            self.tracks.retain(|track| track.id != id || track.last_seen != old.last_seen);
        }
    }

    /// Pairs of track and detection that were not considered because the list was full, since the start.
    #[must_use]
    pub const fn dropped_pairs(&self) -> u32 {
        self.associator.dropped_pairs
    }

    /// Groups too large for joint probabilities, since the start.
    #[must_use]
    pub const fn large_groups(&self) -> u32 {
        self.associator.large_groups
    }

    /// Gives detections to tracks by d² + ln|S|, so that an uncertain track does not win (book, Tracking: Gating). Only
    /// pairs within the gate take part.
    #[inline(never)]
    fn associate(
        &mut self,
        observation: (PeopleSensor, Stamp),
        (detections, late_s): (&[DetectionOf<P>], f32),
    ) {
        self.associator.clear(self.parameters.tracks_max);
        let detections_max = self.parameters.detections_max::<P>();
        for row in 0..self.tracks.len().min(P::Tracks::N) {
            for (column, detection) in detections.iter().enumerate().take(detections_max) {
                if let Some(cost) = self.tracks.get(row).and_then(|track| self.cost(track, detection)) {
                    self.associator.add(row, column, cost);
                }
            }
        }
        self.associator.solve(self.parameters.association);
        for (row, track) in self.tracks.iter_mut().enumerate() {
            let seen = self.associator.detection_of(row).and_then(|column| detections.get(column));
            if let Some(detection) = seen {
                track.see(observation, (detection, late_s), self.parameters.sightings_min);
            }
        }
    }

    fn cost(&self, track: &TrackOf<P>, detection: &DetectionOf<P>) -> Option<f32> {
        let gate = self.parameters.gate;
        // Most pairs are far apart: that is seen without a root and a quotient. A little more than the gate, for the
        // rounding of either way.
        let innovation_variance = track.state.innovation_variance(detection.sigma_m);
        let (dx, dy) = (
            detection.position.x_m - track.state.position.x_m,
            detection.position.y_m - track.state.position.y_m,
        );
        if dx * dx + dy * dy > FAR * gate * gate * innovation_variance {
            return None;
        }
        let distance2 = track.state.distance2(detection.position, detection.sigma_m);
        let unseen = self.now.is_some_and(|now| track.last_seen.past_us(now) > self.parameters.astray_us);
        let distance_m = track.state.position.distance(detection.position);
        let near = !unseen || distance_m <= self.parameters.hidden_gate_m;
        let inside = distance2 <= gate * gate && near && track.is_expected();
        inside.then(|| {
            let likeness =
                self.parameters.appearance_weight * track.appearance.likeness(&detection.appearance);
            distance2 + 2.0 * libm::logf(innovation_variance) - 2.0 * likeness
        })
    }

    fn delete(&mut self, stamp: Stamp) {
        let parameters = self.parameters;
        self.tracks.retain_mut(|track| track.grow_old(stamp, &parameters));
    }

    /// Full: the farthest track is dropped first, because near ones matter (book, Conventions: Exceeded capacities).
    /// False if everybody is nearer than `distance_m`.
    fn free_slot(&mut self, distance_m: f32) -> bool {
        if self.tracks.len() < self.parameters.tracks_max.min(P::Tracks::N) {
            return true;
        }
        self.dropped = self.dropped.saturating_add(1);
        let tracks = self.tracks.iter().enumerate();
        let hidden = |track: &TrackOf<P>| track.status == TrackStatus::Hidden;
        let farthest = tracks
            .max_by(|(_, a), (_, b)| hidden(a).cmp(&hidden(b)).then(a.distance_m.total_cmp(&b.distance_m)));
        match farthest.filter(|(_, track)| hidden(track) || track.distance_m > distance_m).map(|(row, _)| row)
        {
            Some(row) => {
                // Keeps the others in their order, oldest first.
                let mut index = 0_usize;
                self.tracks.retain(|_| {
                    index = index.saturating_add(1);
                    index != row.saturating_add(1)
                });
                true
            }
            None => false,
        }
    }

    #[inline(never)]
    fn create(&mut self, observation: (PeopleSensor, Stamp), detection: &DetectionOf<P>) {
        let duplicate = self
            .tracks
            .iter()
            .filter(|track| track.status != TrackStatus::Hidden)
            .any(|track| track.state.position.distance(detection.position) < self.parameters.duplicate_m);
        if duplicate {
            return;
        }
        let fresh = TrackOf::new(self.next_id, observation, detection);
        if self.free_slot(detection.distance_m) && self.tracks.push(fresh).is_ok() {
            self.next_id = self.next_id.wrapping_add(1).max(1);
        }
    }

    /// Two tracks that no sensor saw both of late, and that go the same way at the same place, are one person seen
    /// by two sensors: the older one stays.
    fn unite(&mut self, now: Stamp) {
        let limit_m = self.parameters.duplicate_m;
        for row in 1..self.tracks.len().min(P::Tracks::N) {
            let Some(younger) = self.tracks.get(row).copied() else { break };
            let twin = self.tracks.iter_mut().take(row).find(|older| older.is_twin(&younger, now, limit_m));
            let Some(older) = twin else { continue };
            older.join(&younger);
            self.tracks.retain(|track| track.id != younger.id);
        }
    }
}

#[cfg(test)]
#[path = "tracker_tests/mod.rs"]
mod tests;
