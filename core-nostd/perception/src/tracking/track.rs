//! One person, or something that looks like one: what was seen of it by which sensor, and when it is given up.

use super::appearance::AppearanceOf;
use super::detection::DetectionOf;
use super::explanation::{Evidence, Explanation, LidarSighting};
use super::filter::ConstantVelocity;
use super::sensors::{PEOPLE_SENSORS, PeopleSensor, SensorSet};
use super::tracker::TrackerParameters;
use crate::shapes::person_model::probability;
use floorguard_types::geometry::Point2;
use floorguard_types::profile::{Native, Profile};
use floorguard_types::time::{Age, Stamp};

/// How sure a track is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TrackStatus {
    /// Seen once or twice.
    Tentative,
    /// Seen often enough.
    Confirmed,
    /// Once confirmed, and out of sight for so long that nobody knows where exactly: kept, so that a person who
    /// reappears there keeps the identity, but no longer reported.
    Hidden,
}

/// One person, or something that looks like one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackOf<P: Profile> {
    /// Unique since the start.
    pub id: u32,
    /// Position and velocity in the fixed frame.
    pub state: ConstantVelocity,
    /// How sure.
    pub status: TrackStatus,
    /// Probability that it is a person: its shapes and its walking, fused over its life.
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
    /// Newest sighting by each sensor, in the order of [`PeopleSensor::ALL`].
    pub seen_by: [Option<Stamp>; PEOPLE_SENSORS],
    /// What explains it, if it is no person in spite of its probability.
    pub explanation: Option<Explanation>,
    evidence: Evidence,
    /// Log-odds that it is a person.
    pub(super) belief: f32,
    /// How far from the sensor it was when last seen, metres.
    pub(super) distance_m: f32,
    /// The state when it was last seen: what is left of it later says less.
    pub(super) seen_state: ConstantVelocity,
    /// Re-identification has run.
    pub(super) is_named: bool,
    /// Its appearance.
    pub(super) appearance: AppearanceOf<P>,
    /// What its sightings weigh, see [`PeopleSensor::weight`].
    weight: u16,
    /// The sensor that found it: before it is confirmed, only this one's misses count.
    origin: PeopleSensor,
    /// Misses in a row of that sensor where it could have been seen.
    misses: u16,
    /// Since when each sensor looks there, could see it and does not.
    missing_since: [Option<Stamp>; PEOPLE_SENSORS],
    /// A sensor missed it for too long.
    is_lost: bool,
}

/// A track in the memory of the target.
pub type Track = TrackOf<Native>;

/// One look never says more than this, log-odds.
pub(crate) const SHAPE_EVIDENCE_MAX: f32 = 2.0;
/// What walking adds to the belief, and how fast the belief in movement follows, as shares of
/// [`PeopleSensor::evidence_weight`]: with the lidar 0.2 log-odds a sighting, because shelves do not walk, and 0.3.
const WALK_GAIN: f32 = 0.8;
const MOVING_GAIN: f32 = 1.2;
/// The belief never becomes so firm that ten sightings to the contrary cannot turn it, log-odds.
pub(crate) const BELIEF_MAX: f32 = 4.0;
/// A track has walked when it is this far from where it was first seen, metres.
const WALKED_M: f32 = 0.6;
/// A sensor contributes to a track for so long after its newest sighting, µs.
const CONTRIBUTES_US: u64 = 500_000;

/// Twins were both seen within this time, µs, and differ in speed by less than this.
const TWIN_FRESH_US: u64 = 200_000;
const TWIN_SPEED_MPS: f32 = 0.8;

/// Evidence of one shape, log-odds.
fn shape_evidence<P: Profile>(detection: &DetectionOf<P>) -> f32 {
    let probability = detection.likeness.clamp(1.0e-3, 1.0 - 1.0e-3);
    libm::logf(probability / (1.0 - probability)).clamp(-SHAPE_EVIDENCE_MAX, SHAPE_EVIDENCE_MAX)
}

fn is_older(stamp: Stamp, now: Stamp, limit_us: u64) -> bool {
    matches!(stamp.age(now), Age::Past(age_us) if age_us > limit_us)
}

impl<P: Profile> TrackOf<P> {
    pub(super) fn new(id: u32, (sensor, stamp): (PeopleSensor, Stamp), detection: &DetectionOf<P>) -> Self {
        let state = ConstantVelocity::new(detection.position, Point2::default(), 0.2, 1.0);
        let mut fresh = Self {
            id,
            state,
            status: TrackStatus::Tentative,
            person_probability: probability(shape_evidence(detection)),
            moving_probability: 0.0,
            sightings: 1,
            created: stamp,
            last_seen: stamp,
            first_position: detection.position,
            seen_by: [None; PEOPLE_SENSORS],
            explanation: None,
            evidence: Evidence::new(detection.position, stamp),
            belief: shape_evidence(detection),
            distance_m: detection.distance_m,
            seen_state: state,
            is_named: false,
            appearance: detection.appearance,
            weight: sensor.weight(),
            origin: sensor,
            misses: 0,
            missing_since: [None; PEOPLE_SENSORS],
            is_lost: false,
        };
        fresh.note_seen_by(sensor, stamp);
        fresh.note_sighting((sensor, stamp), detection);
        fresh
    }

    /// Confirmed, rather a person than not, and nothing explains it.
    #[must_use]
    pub fn is_taken_for_person(&self) -> bool {
        self.status == TrackStatus::Confirmed && self.person_probability >= 0.5 && self.explanation.is_none()
    }

    /// Sensors that saw it within half a second before `now`.
    #[must_use]
    pub fn sensors(&self, now: Stamp) -> SensorSet {
        let recent = |seen: &Option<Stamp>| seen.is_some_and(|stamp| !is_older(stamp, now, CONTRIBUTES_US));
        let pairs = PeopleSensor::ALL.into_iter().zip(&self.seen_by);
        pairs.filter(|(_, seen)| recent(seen)).fold(SensorSet::NONE, |set, (sensor, _)| set.with(sensor))
    }

    /// Where it will be `seconds` after the newest update if it walks on, and how doubtful that is.
    #[must_use]
    pub fn ahead(&self, seconds: f32, parameters: &TrackerParameters) -> ConstantVelocity {
        let mut state = self.state;
        state.advance(seconds, parameters.acceleration_density);
        state
    }

    /// Takes in a sighting. `late_s` is how much older it is than the state (book, Tracking: Late views): where the
    /// person was then is only about where the state is.
    pub(super) fn see(
        &mut self,
        (sensor, stamp): (PeopleSensor, Stamp),
        (detection, late_s): (&DetectionOf<P>, f32),
        sightings_min: u16,
    ) {
        let drift_m = if late_s > 0.0 { 0.1 + self.state.speed_mps() * late_s } else { 0.0 };
        let sigma_m = if late_s > 0.0 {
            libm::sqrtf(detection.sigma_m * detection.sigma_m + drift_m * drift_m)
        } else {
            detection.sigma_m
        };
        self.state.correct(detection.position, sigma_m);
        self.sightings = self.sightings.saturating_add(1);
        self.weight = self.weight.saturating_add(sensor.weight());
        self.distance_m = detection.distance_m;
        self.appearance.learn(&detection.appearance, stamp.seconds_since(self.last_seen));
        self.last_seen = self.last_seen.max(stamp);
        self.note_seen_by(sensor, stamp);
        self.seen_state = self.state;
        (self.misses, self.missing_since, self.is_lost) = (0, [None; PEOPLE_SENSORS], false);
        if self.weight >= sightings_min.saturating_mul(PeopleSensor::Lidar.weight()) {
            self.status = TrackStatus::Confirmed;
        }
        let walked_m = self.state.position.distance(self.first_position);
        let has_come_far = walked_m > WALKED_M && self.state.speed_mps() > 0.25;
        let walking = match (sensor, detection.moving) {
            (PeopleSensor::Scanner, Some(moves)) => moves,
            _ => has_come_far,
        };
        // What walks goes from place to place; what moves need not, and two views that differ leave it open.
        let moves = u8::from(walking).saturating_add(u8::from(detection.moving.unwrap_or(walking)));
        let share = sensor.evidence_weight();
        self.moving_probability += MOVING_GAIN * share * (0.5 * f32::from(moves) - self.moving_probability);
        self.note_sighting((sensor, stamp), detection);
        self.believe(share * shape_evidence(detection) + if walking { WALK_GAIN * share } else { 0.0 });
    }

    fn believe(&mut self, gain: f32) {
        self.belief = (self.belief + gain).clamp(-BELIEF_MAX, BELIEF_MAX);
        self.person_probability = probability(self.belief);
    }

    /// What a sighting by the lidar says besides.
    fn note_sighting(&mut self, (sensor, stamp): (PeopleSensor, Stamp), detection: &DetectionOf<P>) {
        if sensor == PeopleSensor::Lidar {
            self.evidence.see(&LidarSighting {
                log_odds: shape_evidence(detection),
                points: detection.points,
                surroundings: detection.surroundings,
                position: detection.position,
                distance_m: detection.distance_m,
                stamp,
            });
        }
    }

    /// Says what explains it now. What another sensor than the lidar sees as well stays a person; of what the scanner
    /// alone ever saw, only what walked.
    pub(super) fn explain(&mut self, now: Stamp) {
        self.evidence.note_motion(self.moving_probability);
        if self.is_legs_alone() {
            let never_walked = !self.evidence.has_moved(self.moving_probability);
            self.explanation = never_walked.then_some(Explanation::LegsThatNeverWalked);
            return;
        }
        let lidar_alone = SensorSet::NONE.with(PeopleSensor::Lidar);
        let explanation = self.evidence.explain(now, self.moving_probability);
        let others_see_it = self.sensors(now).bits() & !lidar_alone.bits() != 0;
        self.explanation = explanation.filter(|found| found.is_positive() || !others_see_it);
    }

    /// No other sensor than the scanner ever saw it.
    fn is_legs_alone(&self) -> bool {
        let mut known = PeopleSensor::ALL.iter().zip(self.seen_by).filter(|(_, seen)| seen.is_some());
        known.all(|(sensor, _)| *sensor == PeopleSensor::Scanner)
    }

    fn note_seen_by(&mut self, sensor: PeopleSensor, stamp: Stamp) {
        if let Some(seen) = self.seen_by.get_mut(sensor.index()) {
            *seen = Some(stamp);
        }
    }

    /// Confirmed, and rather a person than a cluster.
    fn is_person(&self) -> bool {
        self.status != TrackStatus::Tentative && self.belief > 0.0
    }

    /// A person whose re-identification is pending.
    pub(super) fn is_to_be_named(&self) -> bool {
        self.is_person() && !self.is_named
    }

    /// A person unseen for a while.
    pub(super) fn may_be_astray(&self, now: Stamp, astray_us: u64) -> bool {
        self.is_person() && is_older(self.last_seen, now, astray_us)
    }

    /// It is the same person.
    pub(super) fn continue_from(&mut self, old: &Self) {
        (self.id, self.created, self.first_position) = (old.id, old.created, old.first_position);
        self.sightings = self.sightings.saturating_add(old.sightings);
        let fresh = self.appearance;
        self.appearance = old.appearance;
        self.appearance.learn(&fresh, self.last_seen.seconds_since(old.last_seen));
        self.belief = self.belief.max(old.belief);
        self.evidence.continue_from(&old.evidence);
        self.person_probability = probability(self.belief);
    }

    /// A sensor looked and did not see it. That counts only where the sensor could have: behind somebody, or in a
    /// sector without data, nothing is missed. Misses of a sensor that never saw it are no reason to give it up, for
    /// another one does; but what only legs were seen of, where the lidar sees nobody, is hardly a person.
    pub(super) fn miss(
        &mut self,
        (sensor, stamp): (PeopleSensor, Stamp),
        visible: bool,
        parameters: &TrackerParameters,
    ) {
        let knows_it = self.seen_by.get(sensor.index()).is_some_and(Option::is_some);
        if visible && !knows_it && sensor.doubt() > 0.0 {
            self.believe(-sensor.doubt());
        }
        if knows_it {
            self.moving_probability *= 1.0 - 0.02;
        }
        if visible && knows_it && sensor == PeopleSensor::Lidar {
            self.evidence.miss();
        }
        let Some(since) = self.missing_since.get_mut(sensor.index()).filter(|_| knows_it) else { return };
        if !visible {
            *since = None;
            return;
        }
        if sensor == self.origin {
            self.misses = self.misses.saturating_add(1);
        }
        let first = *since.get_or_insert(stamp);
        let limit_us = parameters.missed_max_us.saturating_mul(sensor.patience());
        self.is_lost |= is_older(first, stamp, limit_us);
    }

    /// Where it may be seen again at once; who was missed in plain sight is somewhere else.
    pub(super) fn is_expected(&self) -> bool {
        !self.is_lost
    }

    /// Judges what became of it; false if it is given up. People are remembered for a while.
    pub(super) fn grow_old(&mut self, now: Stamp, parameters: &TrackerParameters) -> bool {
        if self.status == TrackStatus::Tentative {
            let doubtful = 2.0 * self.state.position_variance > parameters.variance_max_m2;
            return self.misses <= parameters.tentative_misses_max && !doubtful && self.state.is_finite();
        }
        let doubtful = 2.0 * self.state.position_variance > parameters.variance_max_m2;
        if self.is_lost || doubtful || is_older(self.last_seen, now, parameters.coast_max_us) {
            self.status = TrackStatus::Hidden;
        }
        let forgotten = self.belief <= 0.0 || is_older(self.last_seen, now, parameters.remembered_us);
        !(self.status == TrackStatus::Hidden && forgotten) && self.state.is_finite()
    }

    /// The same person, seen by another sensor only: both fresh, at one place, with about one speed.
    pub(super) fn is_twin(&self, other: &Self, now: Stamp, limit_m: f32) -> bool {
        let fresh = |track: &Self| !is_older(track.last_seen, now, TWIN_FRESH_US);
        let apart = self.sensors(now).is_disjoint(other.sensors(now));
        let (a, b) = (self.state.velocity, other.state.velocity);
        apart
            && fresh(self)
            && fresh(other)
            && self.state.position.distance(other.state.position) < limit_m
            && a.distance(b) < TWIN_SPEED_MPS
    }

    /// Takes over what is known of its twin.
    pub(super) fn join(&mut self, twin: &Self) {
        for (own, theirs) in self.seen_by.iter_mut().zip(twin.seen_by) {
            *own = (*own).max(theirs);
        }
        self.last_seen = self.last_seen.max(twin.last_seen);
        self.sightings = self.sightings.saturating_add(twin.sightings);
        self.weight = self.weight.saturating_add(twin.weight);
        self.belief = self.belief.max(twin.belief);
        self.evidence.continue_from(&twin.evidence);
        self.person_probability = probability(self.belief);
        if twin.status == TrackStatus::Confirmed {
            (self.status, self.is_named) = (TrackStatus::Confirmed, self.is_named || twin.is_named);
        }
    }
}
