//! Follows people: gating, association, creation, deletion, coasting. Algorithms D.4 to D.7, `fixed`.

use heapless::Vec;

use super::association::{Association, Associator, DETECTIONS_MAX};
use super::candidates::Detection;
use super::filter::ConstantVelocity;
use super::memory::{Memory, best_of};
use super::person_model::probability;
use crate::capacities::TRACKS_MAX;
use crate::geometry::Point2;
use crate::time::{Age, Stamp};

/// How tracks live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerParameters {
    /// Spectral density of a walker's acceleration, m²/s³ (D.1 gives 0.065 at the 30 Hz of the reference; people who
    /// start and turn need more at 10 Hz).
    pub acceleration_density: f32,
    /// How detections are given to tracks; joint probabilities lose fewer people in crowds (`cargo xtask reproduce
    /// crowds`).
    pub association: Association,
    /// Mahalanobis gate for two dimensions (99 %, D.4).
    pub gate: f32,
    /// Sightings before a track is confirmed.
    pub sightings_min: u16,
    /// Misses in a row, where the sensor could see, that end a tentative track.
    pub tentative_misses_max: u16,
    /// A confirmed track that nobody saw, or could see, for this long is given up, µs (D.6).
    pub coast_max_us: u64,
    /// A confirmed track that should have been seen and was not, for this long, µs.
    pub missed_max_us: u64,
    /// Sum of the position variances above which a track is given up, m² (D.6).
    pub variance_max_m2: f32,
    /// A new track nearer to an old one than this is a duplicate, metres (D.5).
    pub duplicate_m: f32,
    /// A person out of sight keeps to the last speed for about this long, seconds.
    pub coast_s: f32,
    /// Whoever is lost for a moment may be this far from where the track says, metres, and so much farther per second.
    pub reach_m: f32,
    /// See `reach_m`, m/s.
    pub reach_mps: f32,
    /// A track that nobody saw for this long may have gone astray, µs.
    pub astray_us: u64,
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
        missed_max_us: 700_000,
        variance_max_m2: 1.0,
        duplicate_m: 0.5,
        coast_s: 1.5,
        reach_m: 0.5,
        reach_mps: 1.6,
        astray_us: 250_000,
    };
}

impl Default for TrackerParameters {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// How sure a track is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TrackStatus {
    /// Seen once or twice.
    Tentative,
    /// Seen often enough.
    Confirmed,
}

/// One person, or something that looks like one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Unique since the start.
    pub id: u32,
    /// Position and velocity in the fixed frame.
    pub state: ConstantVelocity,
    /// How sure.
    pub status: TrackStatus,
    /// Probability that it is a person: the looks at its shape and its walking, fused over its life.
    pub person_probability: f32,
    /// Belief that it moves, 0…1.
    pub moving_probability: f32,
    /// Sightings since the creation.
    pub sightings: u16,
    /// First sighting.
    pub created: Stamp,
    /// Newest sighting.
    pub last_seen: Stamp,
    /// Where it was first seen.
    pub first_position: Point2,
    /// Log-odds that it is a person.
    belief: f32,
    /// How far from the sensor it was when last seen, metres.
    distance_m: f32,
    /// Misses in a row where it could have been seen.
    misses: u16,
    /// When it was last seen or could not be seen.
    excused: Stamp,
}

/// The tracks and what happened to them.
#[derive(Clone, Debug)]
pub struct Tracker {
    parameters: TrackerParameters,
    tracks: Vec<Track, TRACKS_MAX>,
    next_id: u32,
    now: Option<Stamp>,
    /// Tracks given up or not created for want of room.
    pub dropped: u32,
    /// Sweeps refused because they were older than the newest one.
    pub late: u32,
    associator: Associator,
    memory: Memory,
}

/// Somebody seen within this time is expected to be seen again, µs.
const EXPECTED_US: u64 = 1_500_000;
/// A longer pause than this forgets the tentative tracks, µs (D.7).
const PAUSE_US: u64 = 2_000_000;

impl Tracker {
    /// Nobody yet.
    #[must_use]
    pub const fn new(parameters: TrackerParameters) -> Self {
        Self {
            parameters,
            tracks: Vec::new(),
            next_id: 1,
            now: None,
            dropped: 0,
            late: 0,
            associator: Associator::new(),
            memory: Memory::new(),
        }
    }

    /// The tracks, oldest first.
    #[must_use]
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// Takes in the detections of one moment. `visible` tells whether a person at a point of the fixed frame could
    /// have been seen. Tracks × detections gate tests.
    pub fn update(&mut self, stamp: Stamp, detections: &[Detection], visible: impl Fn(Point2) -> bool) {
        if !self.predict(stamp) {
            self.late = self.late.saturating_add(1);
            return;
        }
        self.associate(stamp, detections);
        for track in &mut self.tracks {
            if track.last_seen != stamp {
                track.miss(stamp, visible(track.state.position));
            }
        }
        self.recall(stamp);
        self.delete(stamp);
        for (column, detection) in detections.iter().enumerate().take(DETECTIONS_MAX) {
            if !self.associator.is_used(column) {
                self.create(stamp, detection);
            }
        }
    }

    /// Where the people who were seen a moment ago are expected at `stamp`, fixed frame.
    pub fn expected(&self, stamp: Stamp) -> impl Iterator<Item = Point2> {
        let seconds = match self.now.map(|now| now.age(stamp)) {
            Some(Age::Past(age_us)) => age_us as f32 * 1.0e-6,
            _ => 0.0,
        };
        let fresh = move |track: &&Track| {
            let seen = matches!(track.last_seen.age(stamp), Age::Past(age_us) if age_us < EXPECTED_US);
            seen && track.status == TrackStatus::Confirmed && track.belief > 0.0
        };
        self.tracks.iter().filter(fresh).map(move |track| {
            let ConstantVelocity { position, velocity, .. } = track.state;
            Point2::new(position.x_m + seconds * velocity.x_m, position.y_m + seconds * velocity.y_m)
        })
    }

    /// Moves every track to `stamp`; false if that lies in the past.
    fn predict(&mut self, stamp: Stamp) -> bool {
        let Some(now) = self.now else {
            self.now = Some(stamp);
            return true;
        };
        let Age::Past(elapsed_us) = now.age(stamp) else { return false };
        self.now = Some(stamp);
        if elapsed_us > PAUSE_US {
            self.tracks.retain(|track| track.status == TrackStatus::Confirmed);
        }
        let seconds = stamp.seconds_since(now);
        for track in &mut self.tracks {
            // People slow down in a crowd; who is out of sight is rather waited for than chased.
            if track.last_seen != now {
                track.state.slow_down(libm::expf(-seconds / self.parameters.coast_s.max(1.0e-3)));
            }
            track.state.advance(seconds, self.parameters.acceleration_density);
        }
        true
    }

    /// Who is confirmed by this sighting may be somebody who was lost, or whose track went astray while unseen.
    // Not inlined, here and below: each frame is gone before the next one comes.
    #[inline(never)]
    fn recall(&mut self, stamp: Stamp) {
        self.memory.forget(stamp);
        for row in 0..self.tracks.len().min(TRACKS_MAX) {
            let sightings_min = self.parameters.sightings_min;
            let fresh = self.tracks.get(row).copied();
            let confirmed = |track: &Track| track.last_seen == stamp && track.sightings == sightings_min;
            let Some(fresh) = fresh.filter(|track| confirmed(track) && track.belief > 0.0) else { continue };
            let place = fresh.state.position;
            let (astray_us, reach) =
                (self.parameters.astray_us, [self.parameters.reach_m, self.parameters.reach_mps]);
            let astray = self.tracks.iter().filter(|track| track.may_be_astray(stamp, astray_us, &fresh));
            let (astray, lost) =
                (best_of(astray, (place, stamp), reach), self.memory.best((place, stamp), reach));
            let best = astray.into_iter().chain(lost).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, id)) = best else { continue };
            let old = self.tracks.iter().find(|track| track.id == id).copied();
            let Some(old) = self.memory.take(id).or(old) else { continue };
            if let Some(track) = self.tracks.get_mut(row) {
                track.continue_from(&old);
            }
            // The older of the two, which nobody sees; the younger one has its number now.
            self.tracks.retain(|track| track.id != id || track.last_seen == stamp);
        }
    }

    /// Pairs of track and detection that were not considered for want of room, since the start.
    #[must_use]
    pub const fn dropped_pairs(&self) -> u32 {
        self.associator.dropped_pairs
    }

    /// Groups too large for joint probabilities, since the start.
    #[must_use]
    pub const fn large_groups(&self) -> u32 {
        self.associator.large_groups
    }

    /// Gives detections to tracks by d² + ln|S|, so that an uncertain track does not win (D.4). Only pairs within the
    /// gate take part.
    #[inline(never)]
    fn associate(&mut self, stamp: Stamp, detections: &[Detection]) {
        self.associator.clear();
        for row in 0..self.tracks.len().min(TRACKS_MAX) {
            for (column, detection) in detections.iter().enumerate().take(DETECTIONS_MAX) {
                if let Some(cost) = self.tracks.get(row).and_then(|track| self.cost(track, detection)) {
                    self.associator.add(row, column, cost);
                }
            }
        }
        self.associator.solve(self.parameters.association);
        for (row, track) in self.tracks.iter_mut().enumerate() {
            let seen = self.associator.detection_of(row).and_then(|column| detections.get(column));
            if let Some(detection) = seen {
                track.see(stamp, detection, self.parameters.sightings_min);
            }
        }
    }

    fn cost(&self, track: &Track, detection: &Detection) -> Option<f32> {
        let gate = self.parameters.gate;
        let distance2 = track.state.distance2(detection.position, detection.sigma_m);
        let inside = distance2 <= gate * gate;
        inside.then(|| distance2 + 2.0 * libm::logf(track.state.innovation_variance(detection.sigma_m)))
    }

    fn delete(&mut self, stamp: Stamp) {
        let (parameters, memory) = (self.parameters, &mut self.memory);
        self.tracks.retain(|track| {
            let lives = track.lives(stamp, &parameters);
            if !lives && track.status == TrackStatus::Confirmed && track.belief > 0.0 {
                memory.keep(track);
            }
            lives
        });
    }

    /// Out of room: the farthest track goes first, because near ones matter (algorithms 0.3). False if everybody is
    /// nearer than `distance_m`.
    fn make_room(&mut self, distance_m: f32) -> bool {
        if !self.tracks.is_full() {
            return true;
        }
        self.dropped = self.dropped.saturating_add(1);
        let tracks = self.tracks.iter().enumerate();
        let farthest = tracks.max_by(|(_, a), (_, b)| a.distance_m.total_cmp(&b.distance_m));
        match farthest.filter(|(_, track)| track.distance_m > distance_m).map(|(row, _)| row) {
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
    fn create(&mut self, stamp: Stamp, detection: &Detection) {
        let duplicate = self
            .tracks
            .iter()
            .any(|track| track.state.position.distance(detection.position) < self.parameters.duplicate_m);
        if duplicate {
            return;
        }
        let fresh = Track::new(self.next_id, stamp, detection);
        if self.make_room(detection.distance_m) && self.tracks.push(fresh).is_ok() {
            self.next_id = self.next_id.wrapping_add(1).max(1);
        }
    }
}

/// Share of a look's log-odds that a sighting adds: looks of a tenth of a second apart are not independent.
const LOOK_SHARE: f32 = 0.25;
/// One look never says more than this, log-odds.
const LOOK_MAX: f32 = 2.0;
/// What walking adds a sighting, log-odds: shelves do not walk.
const WALK_GAIN: f32 = 0.2;
/// The belief never becomes so firm that ten sightings to the contrary cannot turn it, log-odds.
const BELIEF_MAX: f32 = 4.0;
/// A track has walked when it is this far from where it was first seen, metres.
const WALKED_M: f32 = 0.6;

/// What a look says, log-odds.
fn look(detection: &Detection) -> f32 {
    let probability = detection.likeness.clamp(1.0e-3, 1.0 - 1.0e-3);
    libm::logf(probability / (1.0 - probability)).clamp(-LOOK_MAX, LOOK_MAX)
}

impl Track {
    fn new(id: u32, stamp: Stamp, detection: &Detection) -> Self {
        Self {
            id,
            state: ConstantVelocity::new(detection.position, Point2::default(), 0.2, 1.0),
            status: TrackStatus::Tentative,
            person_probability: probability(look(detection)),
            belief: look(detection),
            moving_probability: 0.0,
            sightings: 1,
            created: stamp,
            last_seen: stamp,
            first_position: detection.position,
            distance_m: detection.distance_m,
            misses: 0,
            excused: stamp,
        }
    }

    fn see(&mut self, stamp: Stamp, detection: &Detection, sightings_min: u16) {
        self.state.correct(detection.position, detection.sigma_m);
        self.sightings = self.sightings.saturating_add(1);
        self.distance_m = detection.distance_m;
        (self.last_seen, self.excused, self.misses) = (stamp, stamp, 0);
        if self.sightings >= sightings_min {
            self.status = TrackStatus::Confirmed;
        }
        let walked_m = self.state.position.distance(self.first_position);
        let walking = walked_m > WALKED_M && self.state.speed_mps() > 0.25;
        // What walks goes from place to place; what moves need not, and two views that differ leave it open.
        let moves = u8::from(walking).saturating_add(u8::from(detection.moving.unwrap_or(walking)));
        self.moving_probability += 0.3 * (0.5 * f32::from(moves) - self.moving_probability);
        let gain = LOOK_SHARE * look(detection) + if walking { WALK_GAIN } else { 0.0 };
        self.belief = (self.belief + gain).clamp(-BELIEF_MAX, BELIEF_MAX);
        self.person_probability = probability(self.belief);
    }

    /// A confirmed person, older than `fresh`, whom nobody saw for a while.
    fn may_be_astray(&self, now: Stamp, astray_us: u64, fresh: &Self) -> bool {
        let unseen = matches!(self.last_seen.age(now), Age::Past(age_us) if age_us > astray_us);
        unseen && self.status == TrackStatus::Confirmed && self.belief > 0.0 && self.created < fresh.created
    }

    /// It is the same person.
    fn continue_from(&mut self, old: &Self) {
        (self.id, self.created, self.first_position) = (old.id, old.created, old.first_position);
        self.sightings = self.sightings.saturating_add(old.sightings);
        self.belief = self.belief.max(old.belief);
        self.person_probability = probability(self.belief);
    }

    fn miss(&mut self, stamp: Stamp, visible: bool) {
        if visible {
            self.misses = self.misses.saturating_add(1);
        } else {
            self.excused = stamp;
        }
        self.moving_probability *= 0.98;
    }

    fn lives(&self, now: Stamp, parameters: &TrackerParameters) -> bool {
        let older_than = |stamp: Stamp, limit_us: u64| match stamp.age(now) {
            Age::Past(age_us) => age_us > limit_us,
            Age::Future(_) => false,
        };
        let lost = match self.status {
            TrackStatus::Tentative => self.misses > parameters.tentative_misses_max,
            TrackStatus::Confirmed => older_than(self.excused, parameters.missed_max_us),
        };
        let doubtful = 2.0 * self.state.position_variance > parameters.variance_max_m2;
        !(lost || doubtful || older_than(self.last_seen, parameters.coast_max_us)) && self.state.is_finite()
    }
}

#[cfg(test)]
#[path = "tracker_tests.rs"]
mod tests;
