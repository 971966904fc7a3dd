//! From the objects of a sweep to verdicts: moving or static. Source: book, Motion, on the clusters of `people`.
//!
//! Differs from the source where measuring showed why (see `parts`, `reference`, `seen_through`): what is followed from
//! sweep to sweep is what changed, not the cluster around it, and it is compared with half a second ago.

use super::confidence::{Confidence, MovingObject};
use super::correspondence::{MotionObject, correspond};
use super::parameters::MotionParameters;
use super::parts::{Part, Parts};
use super::reference::References;
use super::seen_through::{Before, SeenThrough};
use super::voxels::{Voxels, cell};
use crate::clusters::{Cluster, RingAngles, SweepFrame};
use crate::people::{PeoplePipelineOf, SweepContext};
use floorguard_types::capacities::SWEEP_RINGS;
use floorguard_types::geometry::{Point2, Point3, Pose2};
use floorguard_types::number::{nearest_f32, truncating_u32};
use floorguard_types::profile::{List, ListOf, Native, Profile, Size};
use floorguard_types::sensing::SweepOf;
use floorguard_types::time::Stamp;

/// Without a sweep for longer, chains and references are given up, microseconds (book, Motion: Confidence).
const GAP_MAX_US: u64 = 300_000;
/// A robot that is farther from where it was has not driven there, metres per second.
const JUMP_MPS: f32 = 6.0;

/// What is known of one object of the sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// It was judged: near enough, and within the capacity.
    pub judged: bool,
    /// It moves, with the confidence of several sweeps: it changed, and a moving object is where its middle
    /// is.
    pub moving: bool,
    /// It changed against the moment before, in this sweep alone.
    pub changed: bool,
    /// Its returns within reach.
    pub points: u16,
    /// Of them those that fill space which was free, or which the object itself hid.
    pub new_points: u16,
    /// Of them those about whose place nothing was known.
    pub unknown_points: u16,
}

/// What happened, counted since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionCounters {
    /// Sweeps taken in.
    pub sweeps: u32,
    /// Times that the past was given up: a gap, a step back in time, or a jump of the pose.
    pub resets: u32,
    /// Sweeps of which less than half was measured: not judged.
    pub blind_sweeps: u32,
    /// Objects that were not judged because the list was full.
    pub dropped_objects: u32,
    /// Moving objects beyond the capacity.
    pub dropped_moving: u32,
}

/// What a sweep yielded.
#[derive(Clone, Copy, Debug)]
pub struct MotionOutput<'a> {
    /// One per object of the sweep, in the same order.
    pub verdicts: &'a [Verdict],
    /// Moving objects, in the frame of the odometry.
    pub moving: &'a [MovingObject],
    /// Everything this near to the robot was judged, metres; `None` while there is nothing to compare with.
    pub judged_within_m: Option<f32>,
}

/// All state; about 600 KiB for `Host`, 190 KiB for `Board`: keep it in a static or on the heap of the host.
#[derive(Clone, Debug)]
pub struct MotionDetectorOf<P: Profile> {
    parameters: MotionParameters,
    references: References<P>,
    /// This sweep's own range image.
    now: SeenThrough,
    parts: Parts<P>,
    confidence: Confidence<P>,
    before: ListOf<MotionObject, P::MotionObjects>,
    verdicts: ListOf<Verdict, P::Clusters>,
    last: Option<(Stamp, Pose2)>,
    /// Measured columns of the fullest sweep of late.
    most_columns: usize,
    counters: MotionCounters,
}

/// A detector in the memory of the target.
pub type MotionDetector = MotionDetectorOf<Native>;

impl<P: Profile> MotionDetectorOf<P> {
    /// Farthest from the robot that is judged, along x and y each, metres.
    const REACH_M: f32 = Voxels::<P::MotionVoxels>::REACH_M;

    /// Nothing seen yet.
    #[must_use]
    pub const fn new(parameters: MotionParameters) -> Self {
        Self {
            parameters,
            references: References::new(),
            now: SeenThrough::new(),
            parts: Parts::new(),
            confidence: Confidence::new(),
            before: List::EMPTY,
            verdicts: List::EMPTY,
            last: None,
            most_columns: 0,
            counters: MotionCounters {
                sweeps: 0,
                resets: 0,
                blind_sweeps: 0,
                dropped_objects: 0,
                dropped_moving: 0,
            },
        }
    }

    /// Judges the objects that the pipeline has just found in the same sweep: call it between
    /// [`PeoplePipeline::find_clusters`] and [`PeoplePipeline::find_people`]. Linear in the cells, quadratic in the objects
    /// (at most 256).
    pub fn process(
        &mut self,
        people: &PeoplePipelineOf<P>,
        sweep: &SweepOf<P>,
        context: &SweepContext,
    ) -> MotionOutput<'_> {
        self.counters.sweeps = self.counters.sweeps.saturating_add(1);
        let measured = sweep.used_columns().iter().filter(|column| column.measured).count();
        let whole = measured.saturating_mul(20) >= self.most_columns.saturating_mul(19);
        // Slowly forgotten: a lidar may be configured to a narrower sector.
        self.most_columns = measured.max(self.most_columns.saturating_sub(self.most_columns / 64));
        self.choose(people.clusters());
        if measured.saturating_mul(2) < self.most_columns {
            // Almost nothing was measured: no verdict, and the past stays what it was.
            self.counters.blind_sweeps = self.counters.blind_sweeps.saturating_add(1);
            return self.output(None);
        }
        let elapsed_s = self.elapsed_s(sweep.end_stamp, context.base_in_odom);
        let judged_within_m = self.references.oldest().map(|_| Self::REACH_M);
        self.last = Some((sweep.end_stamp, context.base_in_odom));
        self.compare_sweep(people, sweep, context, whole.then_some(measured));
        self.conclude(people.clusters(), context.base_in_odom, elapsed_s);
        self.output(judged_within_m)
    }

    fn output(&self, judged_within_m: Option<f32>) -> MotionOutput<'_> {
        MotionOutput { verdicts: &self.verdicts, moving: &self.confidence.moving, judged_within_m }
    }

    /// Seconds since the sweep before. Gives up the past where it cannot be compared with.
    fn elapsed_s(&mut self, now: Stamp, base_in_odom: Pose2) -> f32 {
        let Some((before, pose)) = self.last else { return 0.0 };
        let elapsed_us = now.as_micros().checked_sub(before.as_micros()).filter(|us| *us <= GAP_MAX_US);
        let driven_m =
            Point2::new(pose.x_m, pose.y_m).distance(Point2::new(base_in_odom.x_m, base_in_odom.y_m));
        match elapsed_us.map(|us| nearest_f32(us) * 1.0e-6) {
            Some(elapsed_s) if driven_m <= JUMP_MPS * elapsed_s + 0.1 => elapsed_s,
            _ => {
                self.counters.resets = self.counters.resets.saturating_add(1);
                self.references.clear();
                self.before.clear();
                self.confidence.break_chains(&self.parameters);
                0.0
            }
        }
    }

    /// Chooses what is judged: objects within reach, the nearest where there are too many.
    fn choose(&mut self, clusters: &[Cluster]) {
        self.verdicts.clear();
        let in_reach = |cluster: &Cluster| cluster.nearest_m < Self::REACH_M;
        let count = clusters.iter().filter(|cluster| in_reach(cluster)).count();
        let farthest_m =
            if count > P::MotionObjects::N { Self::nth_distance_m(clusters) } else { f32::INFINITY };
        let mut judged = 0;
        for cluster in clusters {
            let chosen = in_reach(cluster) && cluster.nearest_m <= farthest_m && judged < P::MotionObjects::N;
            judged += usize::from(chosen);
            // Same capacity: never full.
            let _ = self.verdicts.push(Verdict { judged: chosen, ..Verdict::default() });
        }
        let dropped = truncating_u32(count.saturating_sub(judged));
        self.counters.dropped_objects = self.counters.dropped_objects.saturating_add(dropped);
    }

    /// The distance within which as many objects lie as the capacity allows; by halving an interval, 16 times.
    fn nth_distance_m(clusters: &[Cluster]) -> f32 {
        let (mut within_m, mut beyond_m) = (0.0, Self::REACH_M);
        for _ in 0..16 {
            let middle_m = 0.5 * (within_m + beyond_m);
            if clusters.iter().filter(|cluster| cluster.nearest_m <= middle_m).count() <= P::MotionObjects::N
            {
                within_m = middle_m;
            } else {
                beyond_m = middle_m;
            }
        }
        within_m
    }

    /// Asks for every return of an object what was there before, and enters it where a new reference is due.
    fn compare_sweep(
        &mut self,
        people: &PeoplePipelineOf<P>,
        sweep: &SweepOf<P>,
        context: &SweepContext,
        whole_columns: Option<usize>,
    ) {
        let odom = Place::new(context.base_in_odom);
        let parts = &mut self.parts;
        parts.clear();
        self.now.take(sweep, context);
        let (now, confidence) = (&self.now, &mut self.confidence);
        confidence.begin(|place| now.is_hidden(place, &people.angles));
        if let Some(reference) = self.references.oldest() {
            let mut below: Option<(usize, Point3)> = None;
            for_each_return(people, sweep, context, |cluster, place, in_base| {
                let Some(verdict) = self.verdicts.get_mut(cluster).filter(|verdict| verdict.judged) else {
                    return;
                };
                verdict.points = verdict.points.saturating_add(1);
                let point = odom.transform(in_base);
                let voxel = cell(point);
                parts.count(voxel);
                if reference.voxels.holds(voxel) {
                    return;
                }
                match reference.seen.before(point, &people.angles) {
                    Before::Same => {}
                    before if is_new(before, now, &people.angles) => {
                        verdict.new_points = verdict.new_points.saturating_add(1);
                        let is_upright =
                            below.is_some_and(|(other, low)| other + 1 == place && stands_on(point, low));
                        below = Some((place, point));
                        parts.add(point, is_upright);
                    }
                    _ => {
                        verdict.unknown_points = verdict.unknown_points.saturating_add(1);
                        confidence.note_unknown(point, &self.parameters);
                    }
                }
            });
        }
        if let Some(measured) = whole_columns
            && let Some(reference) = self.references.renew(sweep.end_stamp, measured)
        {
            reference.seen.take(sweep, context);
            for_each_return(people, sweep, context, |_, _, in_base| {
                reference.voxels.insert(odom.transform(in_base))
            });
        }
    }

    /// Correspondence, results and confidence.
    fn conclude(&mut self, clusters: &[Cluster], base_in_odom: Pose2, elapsed_s: f32) {
        let odom = Place::new(base_in_odom);
        self.parts.finish(self.parameters.points_min, self.parameters.sensitivity);
        let mut now = ListOf::<MotionObject, P::MotionObjects>::EMPTY;
        let mut changed = ListOf::<bool, P::MotionObjects>::EMPTY;
        for part in self.parts.list.iter() {
            // Same capacities: never full.
            let _ = now.push(MotionObject {
                centroid: part.centroid,
                volume_m3: part.volume_m3(),
                points: part.points,
            });
            let _ = changed.push(true);
        }
        let predecessors = correspond::<P::MotionObjects>(&self.before, &now, elapsed_s, &self.parameters);
        self.confidence.update(&now, &changed, &predecessors, &self.parameters);
        self.counters.dropped_moving = self.confidence.dropped;
        for (cluster, verdict) in
            clusters.iter().zip(self.verdicts.iter_mut()).filter(|(_, verdict)| verdict.judged)
        {
            verdict.changed = self.parameters.has_changed(verdict.new_points, verdict.points);
            let centroid = odom.transform(cluster.centroid);
            verdict.moving = verdict.changed && self.confidence.is_near(centroid, &self.parameters);
        }
        self.before = now;
    }

    /// What happened so far.
    #[must_use]
    pub const fn counters(&self) -> MotionCounters {
        self.counters
    }

    /// What changed in the newest sweep, in the frame of the odometry, whether believed in yet or not.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts.list
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &MotionParameters {
        &self.parameters
    }
}

impl MotionParameters {
    /// The decision of step 6, multiplied out: the object before is taken to have had as many returns.
    fn has_changed(&self, new_points: u16, points: u16) -> bool {
        u32::from(new_points) * u32::from(self.sensitivity) > 2 * u32::from(points)
    }
}

/// The place was free, or what stood before it is gone now: then it has receded. Otherwise it has only come out of a
/// shadow.
fn is_new(before: Before, now: &SeenThrough, angles: &RingAngles) -> bool {
    match before {
        Before::Free => true,
        Before::JustBehind(front) => now.is_gone(front, angles),
        Before::Same | Before::Hidden | Before::Unknown => false,
    }
}

/// Two returns of neighbouring rings belong to a surface that stands rather than lies.
fn stands_on(above: Point3, below: Point3) -> bool {
    let (x, y, z) = (above.x_m - below.x_m, above.y_m - below.y_m, above.z_m - below.z_m);
    x * x + y * y <= z * z
}

/// A pose with its sine and cosine worked out once.
#[derive(Clone, Copy)]
struct Place {
    x_m: f32,
    y_m: f32,
    sin: f32,
    cos: f32,
}

impl Place {
    fn new(pose: Pose2) -> Self {
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        Self { x_m: pose.x_m, y_m: pose.y_m, sin, cos }
    }

    fn transform(&self, point: Point3) -> Point3 {
        let Point3 { x_m, y_m, z_m } = point;
        Point3::new(
            self.x_m + self.cos * x_m - self.sin * y_m,
            self.y_m + self.sin * x_m + self.cos * y_m,
            z_m,
        )
    }
}

/// Every return within reach that belongs to an object, in the robot's frame, with the index of the object.
fn for_each_return<P: Profile>(
    people: &PeoplePipelineOf<P>,
    sweep: &SweepOf<P>,
    context: &SweepContext,
    mut act: impl FnMut(usize, usize, Point3),
) {
    let frames = SweepFrame::new(sweep, &context.sensor_in_base, context.twist);
    for (index, column) in sweep.used_columns().iter().enumerate().filter(|(_, column)| column.measured) {
        let frame = frames.column(column);
        for (ring, (raw, angle)) in column.range_raw.iter().zip(people.angles.rings).enumerate() {
            if *raw == 0 || frame.range_m(*raw) * angle.1 > MotionDetectorOf::<P>::REACH_M {
                continue;
            }
            if let Some(cluster) = people.cluster_of(index, ring) {
                act(cluster, index * SWEEP_RINGS + ring, frame.point(*raw, angle));
            }
        }
    }
}
