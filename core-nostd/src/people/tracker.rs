//! Follows people: gating, nearest-neighbour association, creation, deletion, coasting. Algorithms D.4 to D.7, `fixed`.

use heapless::Vec;

use super::candidates::Detection;
use super::filter::ConstantVelocity;
use crate::capacities::TRACKS_MAX;
use crate::geometry::Point2;
use crate::time::{Age, Stamp};

/// How tracks live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerParameters {
    /// Spectral density of a walker's acceleration, m²/s³ (D.1 gives 0.065 at the 30 Hz of the reference; people who
    /// start and turn need more at 10 Hz).
    pub acceleration_density: f32,
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
}

impl TrackerParameters {
    /// The values of the parameters' own documentation.
    pub const DEFAULT: Self = Self {
        acceleration_density: 0.4,
        gate: 3.035,
        sightings_min: 3,
        tentative_misses_max: 2,
        coast_max_us: 2_000_000,
        missed_max_us: 700_000,
        variance_max_m2: 1.0,
        duplicate_m: 0.5,
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
    /// Belief that it is a person, 0…1: from its shape and from its walking.
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
    /// Tracks not created for want of room.
    pub dropped: u32,
    /// Sweeps refused because they were older than the newest one.
    pub late: u32,
    /// Pairs of track and detection not considered for want of room.
    pub dropped_pairs: u32,
    pairs: Vec<Pair, PAIRS_MAX>,
}

/// A detection within the gate of a track.
#[derive(Clone, Copy, Debug)]
struct Pair {
    cost: f32,
    row: u16,
    column: u16,
}

/// Pairs of one association: each track may have eight detections within its gate.
const PAIRS_MAX: usize = 8 * TRACKS_MAX;

/// Detections that take part in one association.
pub const DETECTIONS_MAX: usize = 2 * TRACKS_MAX;
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
            dropped_pairs: 0,
            pairs: Vec::new(),
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
        let used = self.associate(stamp, detections);
        for track in &mut self.tracks {
            if track.last_seen != stamp {
                track.miss(stamp, visible(track.state.position));
            }
        }
        self.delete(stamp);
        for (detection, used) in detections.iter().zip(used) {
            if !used {
                self.create(stamp, detection);
            }
        }
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
            track.state.predict(seconds, self.parameters.acceleration_density);
        }
        true
    }

    /// Greedy minimum assignment (K14) by d² + ln S, so that an uncertain track does not win (D.4). Only pairs within
    /// the gate are kept and sorted once; ties go to the older track, then to the earlier detection.
    fn associate(&mut self, stamp: Stamp, detections: &[Detection]) -> [bool; DETECTIONS_MAX] {
        self.pairs.clear();
        for row in 0..self.tracks.len().min(TRACKS_MAX) {
            for (column, detection) in detections.iter().enumerate().take(DETECTIONS_MAX) {
                let Some(cost) = self.tracks.get(row).and_then(|track| self.cost(track, detection)) else {
                    continue;
                };
                if self.pairs.push(Pair { cost, row: row as u16, column: column as u16 }).is_err() {
                    self.dropped_pairs = self.dropped_pairs.saturating_add(1);
                }
            }
        }
        self.pairs.sort_unstable_by(|a, b| {
            a.cost.total_cmp(&b.cost).then((a.row, a.column).cmp(&(b.row, b.column)))
        });
        let mut used = [false; DETECTIONS_MAX];
        for pair in &self.pairs {
            let (row, column) = (usize::from(pair.row), usize::from(pair.column));
            let (Some(track), Some(detection)) = (self.tracks.get_mut(row), detections.get(column)) else {
                continue;
            };
            let Some(taken) = used.get_mut(column).filter(|taken| !**taken) else { continue };
            if track.last_seen != stamp {
                track.see(stamp, detection, self.parameters.sightings_min);
                *taken = true;
            }
        }
        used
    }

    fn cost(&self, track: &Track, detection: &Detection) -> Option<f32> {
        let gate = self.parameters.gate;
        let distance2 = track.state.distance2(detection.position, detection.sigma_m);
        let inside = distance2 <= gate * gate;
        inside.then(|| distance2 + 2.0 * libm::logf(track.state.innovation_variance(detection.sigma_m)))
    }

    fn delete(&mut self, stamp: Stamp) {
        let parameters = self.parameters;
        self.tracks.retain(|track| track.lives(stamp, &parameters));
    }

    fn create(&mut self, stamp: Stamp, detection: &Detection) {
        let duplicate = self
            .tracks
            .iter()
            .any(|track| track.state.position.distance(detection.position) < self.parameters.duplicate_m);
        if duplicate {
            return;
        }
        let fresh = Track::new(self.next_id, stamp, detection);
        if self.tracks.push(fresh).is_ok() {
            self.next_id = self.next_id.wrapping_add(1).max(1);
        } else {
            self.dropped = self.dropped.saturating_add(1);
        }
    }
}

/// What the shape alone can make a track believe: somebody who stands still and looks just like a person passes one
/// half, a shelf or half a pillar does not. The rest comes from walking.
const SHAPE_SHARE: f32 = 0.6;
/// A track has walked when it is this far from where it was first seen, metres.
const WALKED_M: f32 = 0.6;

impl Track {
    fn new(id: u32, stamp: Stamp, detection: &Detection) -> Self {
        Self {
            id,
            state: ConstantVelocity::new(detection.position, Point2::default(), 0.2, 1.0),
            status: TrackStatus::Tentative,
            person_probability: SHAPE_SHARE * detection.likeness,
            moving_probability: 0.0,
            sightings: 1,
            created: stamp,
            last_seen: stamp,
            first_position: detection.position,
            misses: 0,
            excused: stamp,
        }
    }

    fn see(&mut self, stamp: Stamp, detection: &Detection, sightings_min: u16) {
        self.state.update(detection.position, detection.sigma_m);
        self.sightings = self.sightings.saturating_add(1);
        (self.last_seen, self.excused, self.misses) = (stamp, stamp, 0);
        if self.sightings >= sightings_min {
            self.status = TrackStatus::Confirmed;
        }
        let walked_m = self.state.position.distance(self.first_position);
        let walking = walked_m > WALKED_M && self.state.speed_mps() > 0.25;
        self.moving_probability += 0.3 * (f32::from(u8::from(walking)) - self.moving_probability);
        // What has walked once is a person even while it stands (people stop to look at shelves).
        let walked = (walked_m / (2.0 * WALKED_M)).min(1.0) * (1.0 - SHAPE_SHARE);
        let looks = (SHAPE_SHARE * detection.likeness + walked).max(self.person_probability * 0.98);
        self.person_probability += 0.3 * (looks - self.person_probability);
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
