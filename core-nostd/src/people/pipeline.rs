//! The whole way from a sweep to the list of people.

use heapless::Vec;

use super::association::DETECTIONS_MAX;
use super::candidates::{CandidateLimits, Detection};
use super::clusters::{Cluster, ClusterLimits, Clusterer, Obstacles, rings_of};
use super::ground::FloorWalk;
use super::labels::NONE;
use super::looks::Looks;
use super::person_model::{person_log_odds, probability};
use super::projection::{ColumnFrame, RingAngles, RingProfile, SweepFrame};
use super::shape::{ShapeBuilder, ShapeVector};
use super::splits::{SEEDS_MAX, Splits};
use super::tracker::{Track, Tracker, TrackerParameters};
use super::visibility::Visibility;
use crate::capacities::{CLUSTERS_MAX, SWEEP_RINGS};
use crate::geometry::{Point2, Point3, Pose2, Transform3, Twist2};
use crate::sensing::{Sweep, SweepColumn};

/// Where the sensor was while it measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepContext {
    /// The lidar on the robot; its z is the height above the floor.
    pub sensor_in_base: Transform3,
    /// The robot's speed during the sweep.
    pub twist: Twist2,
    /// The robot at the end of the sweep, in the fixed frame of the tracks.
    pub base_in_odom: Pose2,
}

/// What happened to the returns of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PeopleCounters {
    /// Returns in the sweep.
    pub points: u32,
    /// Returns that are floor.
    pub floor_points: u32,
    /// Things found.
    pub clusters: u32,
    /// Of them those that move by themselves.
    pub moving_clusters: u32,
    /// Things that may be people.
    pub candidates: u32,
    /// Things dropped for want of room.
    pub dropped_clusters: u32,
    /// Candidates dropped for want of room.
    pub dropped_candidates: u32,
    /// Columns that were not measured.
    pub unknown_columns: u32,
}

impl PeopleCounters {
    const ZERO: Self = Self {
        points: 0,
        floor_points: 0,
        clusters: 0,
        moving_clusters: 0,
        candidates: 0,
        dropped_clusters: 0,
        dropped_candidates: 0,
        unknown_columns: 0,
    };
}

/// What a sweep told.
#[derive(Clone, Copy, Debug)]
pub struct PeopleOutput<'a> {
    /// Things of this sweep, in the robot's frame.
    pub clusters: &'a [Cluster],
    /// People and what looks like them, in the fixed frame.
    pub tracks: &'a [Track],
    /// Where the returns went.
    pub counters: PeopleCounters,
}

/// All state of the stage; about 240 KiB, so keep it in a static or on the heap of the host.
#[derive(Clone, Debug)]
pub struct PeoplePipeline {
    /// Elevations of the lidar.
    pub angles: RingAngles,
    /// When returns belong together.
    pub cluster_limits: ClusterLimits,
    /// What may be a person.
    pub candidate_limits: CandidateLimits,
    clusterer: Clusterer,
    things: Vec<Cluster, CLUSTERS_MAX>,
    visibility: Visibility,
    detections: Vec<Detection, DETECTIONS_MAX>,
    looks: Looks,
    splits: Splits,
    tracker: Tracker,
    counters: PeopleCounters,
}

/// Measurement noise of a cluster's centre, metres (D.2, 3-D lidar), and its growth per metre of distance.
const SIGMA_M: f32 = 0.1;
const SIGMA_PER_M: f32 = 0.004;
/// The middle of what is left of somebody half hidden is not the middle of the body, and wanders with what hides it.
const OCCLUDED: f32 = 1.3;

impl PeoplePipeline {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new(angles: RingAngles) -> Self {
        Self::with_tracker(angles, TrackerParameters::DEFAULT)
    }

    /// Nothing seen yet, with a tracker of one's own parameters.
    #[must_use]
    pub const fn with_tracker(angles: RingAngles, parameters: TrackerParameters) -> Self {
        Self {
            angles,
            cluster_limits: ClusterLimits::DEFAULT,
            candidate_limits: CandidateLimits::DEFAULT,
            clusterer: Clusterer::new(),
            things: Vec::new(),
            visibility: Visibility::new(),
            detections: Vec::new(),
            looks: Looks::new(),
            splits: Splits::new(),
            tracker: Tracker::new(parameters),
            counters: PeopleCounters::ZERO,
        }
    }

    /// Takes in a sweep. Linear in its cells, plus tracks × detections.
    pub fn process(&mut self, sweep: &Sweep, context: &SweepContext) -> PeopleOutput<'_> {
        self.find_things(sweep, context);
        self.find_people(sweep, context)
    }

    /// People among the things of the same sweep; after [`Self::find_things`]. Between the two, motion can be judged
    /// (see [`Self::thing_of`]).
    pub fn find_people(&mut self, sweep: &Sweep, context: &SweepContext) -> PeopleOutput<'_> {
        self.find_people_moving(sweep, context, |_| None)
    }

    /// The same, told which places of the fixed frame something moves at; `None` where nobody knows.
    pub fn find_people_moving(
        &mut self,
        sweep: &Sweep,
        context: &SweepContext,
        moving_at: impl Fn(Point2) -> Option<bool>,
    ) -> PeopleOutput<'_> {
        self.find_detections(sweep, context);
        for detection in &mut self.detections {
            detection.moving = moving_at(detection.position);
        }
        self.track(sweep, context);
        PeopleOutput { clusters: &self.things, tracks: self.tracker.tracks(), counters: self.counters }
    }

    /// Enters for each thing, in their order, whether it moves; after [`Self::find_things`].
    pub fn note_motion(&mut self, verdicts: impl Iterator<Item = Option<bool>>) {
        for (thing, moving) in self.things.iter_mut().zip(verdicts) {
            thing.moving = moving;
            let moves = u32::from(moving == Some(true));
            self.counters.moving_clusters = self.counters.moving_clusters.saturating_add(moves);
        }
    }

    /// Which things may be people, and how probably; after [`Self::find_things`].
    pub fn find_detections(&mut self, sweep: &Sweep, context: &SweepContext) {
        self.share_out(sweep, context);
        self.find_candidates(context);
        self.look(sweep, context);
        self.splits.clear();
        self.find_upper_bodies(sweep, context);
    }

    /// Floor and clusters.
    pub fn find_things(&mut self, sweep: &Sweep, context: &SweepContext) {
        self.counters = PeopleCounters::default();
        self.clusterer.clear();
        self.visibility.clear();
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        let mut obstacles = Obstacles::default();
        let mut profile = frames.still(&SweepColumn::UNKNOWN).profile(&self.angles);
        for column in sweep.used_columns() {
            obstacles.present = 0;
            if column.measured {
                if !frames.is_level() {
                    profile = frames.still(column).profile(&self.angles);
                }
                self.find_obstacles(column, &profile, &mut obstacles);
            } else {
                self.counters.unknown_columns = self.counters.unknown_columns.saturating_add(1);
            }
            self.clusterer.enter_column(&obstacles, &self.cluster_limits);
        }
        self.gather(sweep, &frames);
        // Element by element: a clone of the whole vector would pass over the stack.
        self.things.clear();
        for thing in &self.clusterer.clusters {
            // Same capacity: never full.
            let _ = self.things.push(*thing);
        }
        self.counters.clusters = self.things.len() as u32;
        self.counters.dropped_clusters = self.clusterer.dropped;
    }

    /// What of a column is neither floor nor too far nor too high.
    fn find_obstacles(&mut self, column: &SweepColumn, profile: &RingProfile, obstacles: &mut Obstacles) {
        let range_max_m = self.cluster_limits.range_max_m;
        let mut walk = FloorWalk::default();
        let (mut returns, mut near) = (0_u16, 0_u16);
        for ring in 0..SWEEP_RINGS {
            let raw = column.range_raw.get(ring).copied().unwrap_or(0);
            let (Some((along, rise, height_m)), Some(count)) =
                (profile.get(ring), obstacles.counts.get_mut(ring))
            else {
                continue;
            };
            if raw == 0 {
                continue;
            }
            let bit = 1_u16.wrapping_shl(ring as u32);
            returns |= bit;
            let raw = f32::from(raw);
            let (distance_m, height_m) = (raw * along, raw * rise + height_m);
            walk.step(bit, distance_m, height_m);
            if distance_m <= range_max_m && height_m < CEILING_M {
                near |= bit;
                *count = counts(distance_m);
            }
        }
        // Only the walk's end tells what was floor.
        let floor = walk.floor();
        obstacles.present = near & !floor;
        self.counters.points = self.counters.points.saturating_add(returns.count_ones());
        self.counters.floor_points = self.counters.floor_points.saturating_add(floor.count_ones());
        self.visibility.column(column.azimuth_cdeg, obstacles);
    }

    /// Turns the entered columns into clusters.
    fn gather(&mut self, sweep: &Sweep, frames: &SweepFrame) {
        self.clusterer.close(&self.cluster_limits);
        for (index, column) in sweep.used_columns().iter().enumerate() {
            if self.clusterer.present_in(index) != 0 {
                let cells = (&frames.column(column), &column.range_raw, &self.angles);
                self.clusterer.add_column(index, cells, &self.cluster_limits);
            }
        }
        self.clusterer.finish();
    }

    /// People who touch a desk or a trolley are one thing with it. What stands out above it is grouped once more, on
    /// its own, where a nearby thing is too wide for a person.
    fn find_upper_bodies(&mut self, sweep: &Sweep, context: &SweepContext) {
        let too_wide = |thing: &Cluster| {
            let [width_m, depth_m, height_m] = thing.extent_m();
            let widest_m = width_m.max(depth_m);
            widest_m > self.candidate_limits.width_max_m
                && height_m > 0.3
                && thing.nearest_m < UPPER_BODY_RANGE_M
        };
        if !self.things.iter().any(too_wide) {
            return;
        }
        self.clusterer.clear();
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        let mut obstacles = Obstacles::default();
        let mut profile = frames.still(&SweepColumn::UNKNOWN).profile(&self.angles);
        for (index, column) in sweep.used_columns().iter().enumerate() {
            obstacles.present = 0;
            // What stands that high is an obstacle among the first things, too.
            let before = self.clusterer.present_in(index);
            if before != 0 {
                if !frames.is_level() {
                    profile = frames.still(column).profile(&self.angles);
                }
                find_upper_obstacles((column, before), &profile, &mut obstacles);
            }
            self.clusterer.enter_column(&obstacles, &self.cluster_limits);
        }
        self.gather(sweep, &frames);
        for index in 0..self.clusterer.clusters.len().min(CLUSTERS_MAX) {
            let Some(upper) = self.clusterer.clusters.get(index).copied() else { continue };
            if self.candidate_limits.admits_upper_body(&upper) {
                let detection = detection(&upper, context);
                let known =
                    self.detections.iter().any(|other| other.position.distance(detection.position) < 0.5);
                if !known {
                    self.propose(detection, index, &upper, context);
                }
            }
        }
        self.look(sweep, context);
    }

    /// Gathers the shape of the new candidates and asks the classifier.
    // Not inlined, here and below: each frame is gone before the next one comes.
    #[inline(never)]
    fn look(&mut self, sweep: &Sweep, context: &SweepContext) {
        if !self.looks.begin() {
            return;
        }
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        for (index, column) in sweep.used_columns().iter().enumerate().filter(|(_, column)| column.measured) {
            let Some(labels) = self.clusterer.labels_of(index) else { continue };
            let mut frame: Option<ColumnFrame> = None;
            let mut known = (NONE, None);
            for ring in rings_of(self.clusterer.present_in(index)) {
                let (Some(label), Some(raw), Some(angle)) =
                    (labels.get(ring), column.range_raw.get(ring), self.angles.rings.get(ring))
                else {
                    continue;
                };
                // Neighbours mostly belong to the same thing: it is looked up once.
                if *label != known.0 {
                    let cluster = self.clusterer.cluster_of_label(*label);
                    let slot = cluster.and_then(|cluster| Some((cluster, self.looks.slot(cluster)?)));
                    known = (*label, slot);
                }
                let Some((cluster, mut slot)) = known.1 else { continue };
                let point = frame.get_or_insert_with(|| frames.column(column)).point(*raw, *angle);
                if self.splits.is_shared(cluster) {
                    let Some(share) = self.splits.slot(cluster, point) else { continue };
                    slot = share;
                }
                self.looks.add(slot, point, ring);
            }
        }
        let detections = &mut self.detections;
        self.looks.finish(|slot, shape| {
            if let Some(detection) = detections.get_mut(slot) {
                detection.likeness = probability(person_log_odds(shape));
            }
        });
    }

    /// Things in which the tracker expects several people are shared out among them.
    #[inline(never)]
    fn share_out(&mut self, sweep: &Sweep, context: &SweepContext) {
        self.splits.clear();
        let odom_in_base = context.base_in_odom.inverse();
        for (index, thing) in self.things.iter().enumerate() {
            let expected = self.tracker.expected(sweep.end_stamp);
            self.splits.consider(index, thing, expected.map(|place| odom_in_base.transform(place)));
        }
        if self.splits.is_empty() {
            return;
        }
        let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
        for (index, column) in sweep.used_columns().iter().enumerate() {
            let mut frame: Option<ColumnFrame> = None;
            for ring in rings_of(self.clusterer.present_in(index)) {
                let (Some(raw), Some(angle)) = (column.range_raw.get(ring), self.angles.rings.get(ring))
                else {
                    continue;
                };
                let index =
                    self.clusterer.index_of(index, ring).filter(|thing| self.splits.is_shared(*thing));
                if let Some((index, thing)) = index.and_then(|index| Some((index, self.things.get(index)?))) {
                    let point = frame.get_or_insert_with(|| frames.column(column)).point(*raw, *angle);
                    self.splits.add(index, point, thing.nearest_m);
                }
            }
        }
    }

    #[inline(never)]
    fn find_candidates(&mut self, context: &SweepContext) {
        self.detections.clear();
        self.looks.clear();
        let sensor_height_m = context.sensor_in_base.translation.z_m;
        for index in 0..self.things.len().min(CLUSTERS_MAX) {
            let Some(thing) = self.things.get(index).copied() else { continue };
            if !self.splits.is_shared(index) && self.candidate_limits.admits(&thing, sensor_height_m) {
                self.propose(detection(&thing, context), index, &thing, context);
            }
        }
        for index in 0..SEEDS_MAX {
            let Some((thing, part)) = self.splits.part(index) else { continue };
            if self.candidate_limits.admits(&part, sensor_height_m) {
                let slot = self.propose(detection(&part, context), thing, &part, context);
                self.splits.assign(index, slot);
            }
        }
    }

    /// Slot of the new candidate. Out of room: the farthest candidate goes first.
    fn propose(
        &mut self,
        detection: Detection,
        index: usize,
        thing: &Cluster,
        context: &SweepContext,
    ) -> Option<usize> {
        self.counters.candidates = self.counters.candidates.saturating_add(1);
        let mut slot = self.detections.len();
        if let Err(detection) = self.detections.push(detection) {
            self.counters.dropped_candidates = self.counters.dropped_candidates.saturating_add(1);
            let others = self.detections.iter_mut().enumerate();
            let farthest = others.max_by(|(_, a), (_, b)| a.distance_m.total_cmp(&b.distance_m));
            let (row, worse) = farthest.filter(|(_, other)| other.distance_m > detection.distance_m)?;
            *worse = detection;
            slot = row;
        }
        let heights_m = (thing.lower.z_m, thing.upper.z_m);
        let builder = ShapeBuilder::new(context.sensor_in_base.translation, thing.centroid, heights_m);
        self.looks.set(slot, index, builder, thing);
        Some(slot)
    }

    #[inline(never)]
    fn track(&mut self, sweep: &Sweep, context: &SweepContext) {
        let origin = context.sensor_in_base.translation;
        let [[cos, ..], [sin, ..], _] = context.sensor_in_base.rotation;
        let sensor_in_base = Pose2::new(origin.x_m, origin.y_m, libm::atan2f(sin, cos));
        let odom_in_sensor = context.base_in_odom.compose(sensor_in_base).inverse();
        let visibility = &self.visibility;
        self.tracker.update(sweep.end_stamp, &self.detections, |point| {
            visibility.is_visible(odom_in_sensor.transform(point))
        });
    }

    /// The tracker, for its counters.
    #[must_use]
    pub const fn tracker(&self) -> &Tracker {
        &self.tracker
    }

    /// The things of the newest sweep, in the robot's frame.
    #[must_use]
    pub fn things(&self) -> &[Cluster] {
        &self.things
    }

    /// Index of the thing to which a cell belongs; `None` if to none. Valid from [`Self::find_things`] to
    /// [`Self::find_people`], which groups once more.
    #[must_use]
    pub fn thing_of(&self, column: usize, ring: usize) -> Option<usize> {
        self.clusterer.index_of(column, ring)
    }

    /// The detections of the newest sweep, in the fixed frame.
    #[must_use]
    pub fn detections(&self) -> &[Detection] {
        &self.detections
    }

    /// Lowest and highest coordinates of the returns of a detection of the newest sweep, by its index; robot frame, metres.
    #[must_use]
    pub fn bounds(&self, detection: usize) -> Option<[Point3; 2]> {
        self.looks.bounds(detection)
    }

    /// The shape of a detection of the newest sweep, by its index: what the classifier saw.
    #[must_use]
    pub fn shape(&self, detection: usize) -> Option<&ShapeVector> {
        self.looks.shape(detection)
    }
}

/// Returns above this height hang over people's heads, metres.
const CEILING_M: f32 = 2.1;

/// Above this height a desk, a trolley or a counter has ended and a torso has not, metres.
const UPPER_BODY_M: f32 = 1.05;
/// Farther away too few rings hit a torso alone, metres.
const UPPER_BODY_RANGE_M: f32 = 8.0;

/// What of the obstacles of a column stands out above desks.
fn find_upper_obstacles(
    (column, before): (&SweepColumn, u16),
    profile: &RingProfile,
    obstacles: &mut Obstacles,
) {
    for ring in rings_of(before) {
        let (Some(raw), Some((along, rise, height_m)), Some(count)) =
            (column.range_raw.get(ring), profile.get(ring), obstacles.counts.get_mut(ring))
        else {
            continue;
        };
        let raw = f32::from(*raw);
        let (distance_m, height_m) = (raw * along, raw * rise + height_m);
        if height_m >= UPPER_BODY_M && distance_m < UPPER_BODY_RANGE_M {
            *count = counts(distance_m);
            obstacles.present |= 1_u16.wrapping_shl(ring as u32);
        }
    }
}

/// Horizontal distance in counts of 2 mm, as the clusterer takes it: an obstacle is never 0.
fn counts(distance_m: f32) -> u16 {
    ((distance_m * 500.0) as u16).max(1)
}

/// A thing as a measurement for the tracker; nobody has looked at its shape yet.
fn detection(thing: &Cluster, context: &SweepContext) -> Detection {
    let centre = Point2::new(thing.centroid.x_m, thing.centroid.y_m);
    Detection {
        position: context.base_in_odom.transform(centre),
        distance_m: thing.nearest_m,
        sigma_m: (SIGMA_M + SIGMA_PER_M * thing.nearest_m) * if thing.occluded { OCCLUDED } else { 1.0 },
        likeness: 0.5,
        points: thing.points,
        moving: None,
    }
}
