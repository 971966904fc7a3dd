//! What explains a track that is a person by its probability. Source: book, Tracking: Explained objects.
//!
//! An object of the shape of a person is one until it is explained. What moves by itself is never explained, nor what
//! ever moved; what legs or a camera show at the same time keeps the benefit of the doubt as well.

use floorguard_types::geometry::Point2;
use floorguard_types::time::{Age, Stamp};

/// What explains a track. A track without an explanation may be a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Explanation {
    /// Its surface goes on above the height of people: a pillar, a cupboard, a door frame.
    GoesOnAbove,
    /// It never moved, and on the mean of all sweeps its shape is rather not a person's; a sweep that shows its place
    /// open without it speaks against it, too.
    UnlikelyShape,
    /// Above the hip a part of it is narrower than a neck, between broader ones: a tripod with an instrument on it. It never moved.
    NarrowWaist,
    /// What stands out of a larger object and has been rigid for ten seconds: no breath, no sway.
    RigidPart,
    /// Only a scanner ever saw it, as a pair of legs, and it never walked: legs of chairs come in pairs, too.
    LegsThatNeverWalked,
}

impl Explanation {
    /// Its name in recordings and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::GoesOnAbove => "goes on above",
            Self::UnlikelyShape => "unlikely shape",
            Self::NarrowWaist => "narrow waist",
            Self::RigidPart => "rigid part",
            Self::LegsThatNeverWalked => "legs that never walked",
        }
    }

    /// The surface itself shows that this is not a person, however long a person may stand still: the rules for speed
    /// near people leave it out. The other explanations count for display, maps and costs alone; for the rules such a
    /// track goes on being a person.
    #[must_use]
    pub const fn is_positive(self) -> bool {
        matches!(self, Self::GoesOnAbove)
    }
}

/// What a detection is connected with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Surroundings(u8);

impl Surroundings {
    /// With nothing, as far as is known.
    pub const OPEN: Self = Self(0);
    /// Its surface goes on above the height of people.
    pub const ABOVE: Self = Self(1);
    /// It was cut out of a larger object, which it stands out of.
    pub const PART: Self = Self(2);
    /// A part of it is narrower than a neck, between broader ones.
    pub const WAIST: Self = Self(4);

    /// With both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

/// Weight of no evidence at all in the mean of the first sweeps, and the least share of a sweep: a memory of two seconds.
const PRIOR_SWEEPS: f32 = 1.0;
const SHARE_MIN: f32 = 0.05;
/// Log-odds of a sweep that shows nothing at an open place.
const UNSEEN: f32 = -2.0;
/// A shape of fewer returns than this says less, in proportion: two rings on a body 15 m away.
const POINTS_ENOUGH: f32 = 40.0;
/// Below this mean a shape is rather not a person's, log-odds. Simulated and recorded people who stand in the open have
/// 0.9 at least.
const LIKELY_MIN: f32 = 0.3;
/// Fewer sweeps than this say nothing.
const SWEEPS_MIN: f32 = 2.0;
/// Sweeps that must agree on what surrounds a track, more than those that disagree; no more than the second are counted.
const AGREE_MIN: u8 = 3;
const AGREE_MAX: u8 = 10;
/// What was this probably moving once has moved.
const MOVED: f32 = 0.25;
/// A moving object that fits a person is treated as a person until enough of it has been seen: from this probability.
const MOVES: f32 = 0.1;
/// A rigid object's middle stays within this, metres, and this share of its distance: range noise of 60 returns. The
/// middle of a recorded person who waits stays within it for four seconds.
const RIGID_M: f32 = 0.01;
const RIGID_PER_M: f32 = 0.001;
/// It has been rigid when it has been so for this long, µs.
const RIGID_US: u64 = 10_000_000;

/// What is known for and against a track being a person besides its belief. 32 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Evidence {
    /// Mean log-odds of the lidar's sweeps.
    score: f32,
    sweeps: f32,
    above: u8,
    part: u8,
    waist: u8,
    has_moved: bool,
    /// Where it stands, and since when it has not left that place.
    home: Point2,
    rigid_since: Stamp,
}

/// A sighting by the lidar.
#[derive(Clone, Copy, Debug)]
pub(super) struct LidarSighting {
    pub(super) log_odds: f32,
    /// Returns that it rests on.
    pub(super) points: u16,
    pub(super) surroundings: Surroundings,
    pub(super) position: Point2,
    pub(super) distance_m: f32,
    pub(super) stamp: Stamp,
}

impl Evidence {
    pub(super) const fn new(position: Point2, stamp: Stamp) -> Self {
        Self {
            score: 0.0,
            sweeps: 0.0,
            above: 0,
            part: 0,
            waist: 0,
            has_moved: false,
            home: position,
            rigid_since: stamp,
        }
    }

    /// The lidar found it.
    pub(super) fn see(&mut self, seen: &LidarSighting) {
        let share = (f32::from(seen.points) / POINTS_ENOUGH).min(1.0);
        self.weigh(share * seen.log_odds);
        self.above = counted(self.above, seen.surroundings.has(Surroundings::ABOVE));
        self.part = counted(self.part, seen.surroundings.has(Surroundings::PART));
        self.waist = counted(self.waist, seen.surroundings.has(Surroundings::WAIST));
        if self.home.distance(seen.position) > RIGID_M + RIGID_PER_M * seen.distance_m {
            (self.home, self.rigid_since) = (seen.position, seen.stamp);
        }
    }

    /// The lidar looked at its open place and did not find it.
    pub(super) fn miss(&mut self) {
        self.weigh(UNSEEN);
    }

    fn weigh(&mut self, log_odds: f32) {
        self.sweeps += 1.0;
        let share = (1.0 / (self.sweeps + PRIOR_SWEEPS)).max(SHARE_MIN);
        self.score += share * (log_odds - self.score);
    }

    /// How probably it moves.
    pub(super) fn note_motion(&mut self, moving_probability: f32) {
        self.has_moved |= moving_probability >= MOVED;
    }

    /// The same person was followed before.
    pub(super) fn continue_from(&mut self, old: &Self) {
        self.has_moved |= old.has_moved;
    }

    /// It moves, or it moved at some time.
    pub(super) fn has_moved(&self, moving_probability: f32) -> bool {
        self.has_moved || moving_probability >= MOVES
    }

    /// What it is, if it is no person.
    pub(super) fn explain(&self, now: Stamp, moving_probability: f32) -> Option<Explanation> {
        if self.has_moved(moving_probability) {
            return None;
        }
        let is_rigid = matches!(self.rigid_since.age(now), Age::Past(age_us) if age_us >= RIGID_US);
        if self.above >= AGREE_MIN {
            Some(Explanation::GoesOnAbove)
        } else if self.waist >= AGREE_MIN {
            Some(Explanation::NarrowWaist)
        } else if self.part >= AGREE_MIN && is_rigid {
            Some(Explanation::RigidPart)
        } else {
            (self.sweeps >= SWEEPS_MIN && self.score < LIKELY_MIN).then_some(Explanation::UnlikelyShape)
        }
    }
}

fn counted(count: u8, agrees: bool) -> u8 {
    if agrees { count.saturating_add(1).min(AGREE_MAX) } else { count.saturating_sub(1) }
}
