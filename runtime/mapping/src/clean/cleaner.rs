//! The two passes.

use floorguard_mapping::people_removal::{
    Column, ColumnGrid, FanReturn, FanRule, FloorHeight, FreeSpace, JudgeRule, JudgedSweep, PointVerdict,
    SweepFan, SweepJudge, SweepOutcome,
};
use floorguard_types::geometry::{Point3, Transform3};

use super::sweep::{FAN_RINGS, RawSweep};
use super::track::Track;
use super::voxels::GrowingVoxels;

/// Cells of azimuth of a fan: one a degree.
const FAN_CELLS: usize = 360;
/// Poses along a sweep: 0.8 ms apart, in which a robot that turns at 1 rad/s moves a point 10 m away by 8 mm.
const KNOTS: usize = 128;
/// Columns along an edge: 20 m each way.
const SIDE: u16 = 400;

/// How maps are cleaned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CleanConfig {
    /// Edge of a voxel, metres.
    pub voxel_m: f32,
    /// How much of a ray counts as clear.
    pub fan: FanRule,
    /// How objects are judged.
    pub judge: JudgeRule,
    /// Elevation of each ring of the lidar, lowest first, radians; NaN for rings that it lacks.
    pub elevations_rad: [f32; FAN_RINGS],
}

/// What was left out; everything else is in the map or removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CleanCounts {
    /// Sweeps that gave evidence.
    pub observed: u64,
    /// Sweeps at whose time no pose is known.
    pub without_pose: u64,
    /// Sweeps in which no floor was found; their evidence counts, nothing of them is removed.
    pub without_floor: u64,
}

/// Cleans a map. First [`observe`](Self::observe) every sweep of all surveys, then [`judge`](Self::judge) them.
pub struct Cleaner {
    space: FreeSpace<GrowingVoxels>,
    fan: Box<SweepFan<FAN_RINGS, FAN_CELLS>>,
    limits: Box<[[f32; FAN_CELLS]; FAN_RINGS]>,
    rule: FanRule,
    judge: SweepJudge<Box<[Column]>>,
    points_in_map: Vec<Point3>,
    sensors_in_map: Vec<Point3>,
    /// What was left out.
    pub counts: CleanCounts,
}

impl CleanConfig {
    /// With the values of the book for a lidar of these rings.
    #[must_use]
    pub fn new(elevations_rad: [f32; FAN_RINGS]) -> Self {
        let (fan, judge) = (FanRule::default(), JudgeRule::default());
        Self { voxel_m: 0.1, fan, judge, elevations_rad }
    }

    /// The same for a VLP-16: 2° from −15° to 15°.
    #[must_use]
    pub fn vlp16() -> Self {
        Self::new(std::array::from_fn(|ring| {
            if ring < 16 { (2.0 * ring as f32 - 15.0).to_radians() } else { f32::NAN }
        }))
    }
}

impl Cleaner {
    /// A cleaner without evidence. `None` if an edge of a voxel is below 0.02 m or above 1 m.
    #[must_use]
    pub fn new(config: &CleanConfig) -> Option<Self> {
        let columns = vec![Column::default(); usize::from(SIDE) * usize::from(SIDE)].into_boxed_slice();
        let grid = ColumnGrid::new(SIDE, columns).ok()?;
        Some(Self {
            space: FreeSpace::new(config.voxel_m, GrowingVoxels::default())?,
            fan: Box::new(SweepFan::new(config.elevations_rad)),
            limits: Box::new([[0.0; FAN_CELLS]; FAN_RINGS]),
            rule: config.fan,
            judge: SweepJudge::new(config.judge, grid),
            points_in_map: Vec::new(),
            sensors_in_map: Vec::new(),
            counts: CleanCounts::default(),
        })
    }

    /// First pass: enters hits and clear rays. False if no pose is known for the sweep; it is counted.
    pub fn observe(&mut self, sweep: &RawSweep, track: &Track) -> bool {
        if !self.place(sweep, track) {
            self.counts.without_pose += 1;
            return false;
        }
        self.counts.observed += 1;
        self.fan.clear();
        self.space.begin_sweep();
        for (each, (point, sensor)) in
            sweep.returns.iter().zip(self.points_in_map.iter().zip(&self.sensors_in_map))
        {
            self.space.hit(*point);
            self.fan.enter(FanReturn {
                ring: usize::from(each.ring),
                point_in_sensor: each.point_in_sensor,
                point_in_map: *point,
                sensor_in_map: *sensor,
            });
        }
        let space = &mut self.space;
        self.fan.for_each_clear(self.rule, &mut self.limits, |ray| space.pass(ray.from, ray.to));
        true
    }

    /// Second pass: a verdict for each return. `None` if no pose or no floor is known: then nothing of it is removed, and it
    /// belongs into no map without a pose.
    pub fn judge(
        &mut self,
        sweep: &RawSweep,
        track: &Track,
        verdicts: &mut Vec<PointVerdict>,
    ) -> Option<SweepOutcome> {
        verdicts.clear();
        verdicts.resize(sweep.returns.len(), PointVerdict::OutsideBand);
        if !self.place(sweep, track) {
            return None;
        }
        let sensor_in_map = *self.sensors_in_map.get(self.sensors_in_map.len() / 2)?;
        let mut heights = FloorHeight::below(sensor_in_map.z_m);
        self.points_in_map.iter().for_each(|point| heights.enter(point.z_m));
        let Some(floor_m) = heights.floor_m() else {
            self.counts.without_floor += 1;
            return None;
        };
        let points_in_map = &self.points_in_map;
        Some(self.judge.judge(&self.space, JudgedSweep { points_in_map, sensor_in_map, floor_m, verdicts }))
    }

    /// The returns of the sweep that was observed or judged last, in the map.
    #[must_use]
    pub fn points_in_map(&self) -> &[Point3] {
        &self.points_in_map
    }

    /// The space as seen so far.
    #[must_use]
    pub const fn space(&self) -> &FreeSpace<GrowingVoxels> {
        &self.space
    }

    /// Puts the returns into the map, each by the pose at its time.
    fn place(&mut self, sweep: &RawSweep, track: &Track) -> bool {
        self.points_in_map.clear();
        self.sensors_in_map.clear();
        let step_s = sweep.duration_s() / KNOTS as f64;
        let mut knots = [Transform3::IDENTITY; KNOTS];
        for (index, knot) in knots.iter_mut().enumerate() {
            let Some(pose) = track.at(sweep.start_s + (index as f64 + 0.5) * step_s) else { return false };
            *knot = pose;
        }
        let per_s = if step_s > 0.0 { (1.0 / step_s) as f32 } else { 0.0 };
        for each in &sweep.returns {
            let pose = &knots[((each.offset_s * per_s) as usize).min(KNOTS - 1)];
            self.points_in_map.push(pose.transform(each.point_in_sensor));
            self.sensors_in_map.push(pose.translation);
        }
        true
    }
}
