//! The stages in their order, and what they keep.

use super::context::{PeopleCounters, PeopleOutputOf, SweepContext};
use crate::clusters::{Cluster, ClusterLimits, Clusterer, RingAngles};
use crate::people::candidate_shapes::CandidateShapes;
use crate::people::candidates::CandidateLimits;
use crate::people::splits::Splits;
use crate::shapes::shape::ShapeVector;
use crate::tracking::{
    DetectionOf, PeopleViewOf, TrackOf, TrackerOf, TrackerParameters, Visibility, WaitingViews,
};
use floorguard_types::geometry::{Point2, Point3};
use floorguard_types::profile::{List, ListOf, Native, Profile};
use floorguard_types::sensing::SweepOf;

/// All state of the stage; about 240 KiB, so keep it in a static or on the heap of the host.
///
/// ```
/// use floorguard_perception::people::{PeoplePipeline, RingAngles, SweepContext};
/// use floorguard_types::geometry::{Point3, Pose2, Transform3, Twist2};
/// use floorguard_types::sensing::Sweep;
///
/// static EMPTY: Sweep = Sweep::EMPTY;
/// let mut pipeline = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
/// let sensor_in_base = Transform3::from_mounting(Point3::new(0.0, 0.0, 0.8), 0.0, 0.0, 0.0);
/// let context = SweepContext { sensor_in_base, twist: Twist2::ZERO, base_in_odom: Pose2::default() };
/// let output = pipeline.process(&EMPTY, &context);
/// assert!(output.tracks.is_empty() && output.clusters.is_empty());
/// ```
#[derive(Clone, Debug)]
pub struct PeoplePipelineOf<P: Profile> {
    /// Elevations of the lidar.
    pub angles: RingAngles,
    /// When returns belong together.
    pub cluster_limits: ClusterLimits,
    /// What may be a person.
    pub candidate_limits: CandidateLimits,
    pub(super) clusterer: Clusterer<P>,
    pub(super) clusters: ListOf<Cluster, P::Clusters>,
    pub(super) visibility: Visibility,
    pub(super) detections: ListOf<DetectionOf<P>, P::Detections>,
    pub(super) candidate_shapes: CandidateShapes<P>,
    pub(super) splits: Splits,
    pub(super) tracker: TrackerOf<P>,
    pub(super) counters: PeopleCounters,
    waiting: WaitingViews<P>,
}

/// The stage in the memory of the target.
pub type PeoplePipeline = PeoplePipelineOf<Native>;

impl<P: Profile> PeoplePipelineOf<P> {
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
            clusters: List::EMPTY,
            visibility: Visibility::new(),
            detections: List::EMPTY,
            candidate_shapes: CandidateShapes::new(),
            splits: Splits::new(),
            tracker: TrackerOf::new(parameters),
            counters: PeopleCounters::ZERO,
            waiting: WaitingViews::new(),
        }
    }

    /// Takes in a sweep. Linear in its cells, plus tracks × detections.
    pub fn process(&mut self, sweep: &SweepOf<P>, context: &SweepContext) -> PeopleOutputOf<'_, P> {
        self.find_clusters(sweep, context);
        self.find_people(sweep, context)
    }

    /// People among the clusters of the same sweep; after [`Self::find_clusters`]. Between the two, motion can be
    /// judged (see [`Self::cluster_of`]).
    pub fn find_people(&mut self, sweep: &SweepOf<P>, context: &SweepContext) -> PeopleOutputOf<'_, P> {
        self.find_people_moving(sweep, context, |_| None)
    }

    /// The same, given the places of the fixed frame at which something moves; `None` where unknown.
    pub fn find_people_moving(
        &mut self,
        sweep: &SweepOf<P>,
        context: &SweepContext,
        moving_at: impl Fn(Point2) -> Option<bool>,
    ) -> PeopleOutputOf<'_, P> {
        self.find_detections(sweep, context);
        for detection in self.detections.iter_mut() {
            detection.moving = moving_at(detection.position);
        }
        self.track(sweep, context);
        PeopleOutputOf { clusters: &self.clusters, tracks: self.tracker.tracks(), counters: self.counters }
    }

    /// Takes in what another sensor saw. It waits for the sweep of its time; when the lidar is silent for longer than
    /// 0.2 s, it goes to the tracker without one. True if the tracks are newer now.
    pub fn add_view(&mut self, view: &PeopleViewOf<P>) -> bool {
        self.waiting.add(view, &mut self.tracker);
        self.waiting.give_overdue(&mut self.tracker)
    }

    /// Enters for each cluster, in their order, whether it moves; after [`Self::find_clusters`].
    pub fn note_motion(&mut self, verdicts: impl Iterator<Item = Option<bool>>) {
        for (cluster, moving) in self.clusters.iter_mut().zip(verdicts) {
            cluster.moving = moving;
            let moves = u32::from(moving == Some(true));
            self.counters.moving_clusters = self.counters.moving_clusters.saturating_add(moves);
        }
    }

    /// Which clusters may be people, and how probably; after [`Self::find_clusters`].
    // Not inlined: once in a program.
    #[inline(never)]
    pub fn find_detections(&mut self, sweep: &SweepOf<P>, context: &SweepContext) {
        self.waiting.give_until(sweep.end_stamp, &mut self.tracker);
        self.share_out(sweep, context);
        self.find_candidates(context);
        self.describe_candidates(sweep, context);
        self.splits.clear();
        self.find_upper_bodies(sweep, context);
    }

    /// Takes the detections of the same sweep into the tracks; after [`Self::find_detections`].
    #[inline(never)]
    pub fn track(&mut self, sweep: &SweepOf<P>, context: &SweepContext) {
        let sensor_in_base = context.sensor_in_base.on_floor();
        let odom_in_sensor = context.base_in_odom.compose(sensor_in_base).inverse();
        let visibility = &self.visibility;
        self.tracker.update(sweep.end_stamp, &self.detections, |point| {
            visibility.is_visible(odom_in_sensor.transform(point))
        });
    }

    /// The tracks, as of the newest sweep or view.
    #[must_use]
    pub fn tracks(&self) -> &[TrackOf<P>] {
        self.tracker.tracks()
    }

    /// Views of other sensors that went to the tracker before their turn, since the start.
    #[must_use]
    pub const fn hurried_views(&self) -> u32 {
        self.waiting.hurried
    }

    /// The tracker, for its counters.
    #[must_use]
    pub const fn tracker(&self) -> &TrackerOf<P> {
        &self.tracker
    }

    /// The clusters of the newest sweep, in the robot's frame.
    #[must_use]
    pub fn clusters(&self) -> &[Cluster] {
        &self.clusters
    }

    /// Index of the cluster to which a cell belongs; `None` if to none. Valid from [`Self::find_clusters`] to
    /// [`Self::find_people`], which groups once more.
    #[must_use]
    pub fn cluster_of(&self, column: usize, ring: usize) -> Option<usize> {
        self.clusterer.index_of(column, ring)
    }

    /// The detections of the newest sweep, in the fixed frame.
    #[must_use]
    pub fn detections(&self) -> &[DetectionOf<P>] {
        &self.detections
    }

    /// Lowest and highest coordinates of the returns of a detection of the newest sweep, by its index; robot frame, metres.
    #[must_use]
    pub fn bounds(&self, detection: usize) -> Option<[Point3; 2]> {
        self.candidate_shapes.bounds(detection)
    }

    /// The shape of a detection of the newest sweep, by its index: what the classifier saw.
    #[must_use]
    pub fn shape(&self, detection: usize) -> Option<&ShapeVector> {
        self.candidate_shapes.shape(detection)
    }
}
