//! A lidar of 16 rings that is driven through a furnished room: odometry in space.

use cortex_m_semihosting::hprintln;
use floorguard_mapping::lidar_odometry::{
    Bucket, LidarOdometry, MotionAid, OdometryConfig, SweepReturn, SweepTimes,
};
use floorguard_types::geometry::{Point2, Pose2};
use heapless::Vec;
use nalgebra::Vector3;
use static_cell::{ConstStaticCell, StaticCell};

use crate::stopwatch::Stopwatch;

/// Firings of a revolution, and returns of a sweep.
const FIRINGS: usize = 1_800;
const RETURNS: usize = 16 * FIRINGS;
const PERIOD_S: f32 = 0.1;
const SWEEPS: usize = 25;
/// Speed and turn of the lidar.
const MOTION: [f32; 2] = [0.5, 0.25];
/// Low and high corner of a room and of what stands in it, from the lidar's first place, metres.
const ROOM: [[f32; 3]; 2] = [[-4.0, -3.0, -0.8], [5.0, 4.0, 1.8]];
const BOXES: [[[f32; 3]; 2]; 3] = [
    [[2.0, 1.0, -0.8], [3.2, 2.0, 0.0]],
    [[1.5, -2.0, -0.8], [1.9, -1.6, 1.8]],
    [[-4.0, 2.0, -0.8], [-2.0, 2.6, 1.2]],
];
/// Eight cubes each: a room of this size fits.
const BUCKETS: usize = 1_024;

static MAP: ConstStaticCell<[Bucket; BUCKETS]> = ConstStaticCell::new([Bucket::EMPTY; BUCKETS]);
static SWEEP: ConstStaticCell<Vec<SweepReturn, RETURNS>> = ConstStaticCell::new(Vec::new());
static ODOMETRY: StaticCell<LidarOdometry<&'static mut [Bucket], 4_096>> = StaticCell::new();

/// Uniform in −1 to 1, the same every time.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }
}

/// Where the lidar is on its arc.
fn pose_at(time_s: f32) -> Pose2 {
    let [speed, turn] = MOTION;
    let heading = turn * time_s;
    let (sin, cos) = libm::sincosf(heading);
    Pose2::new(speed / turn * sin, speed / turn * (1.0 - cos), heading)
}

/// Where a ray enters and leaves a box.
fn cut(from: [f32; 3], along: [f32; 3], [low, high]: &[[f32; 3]; 2]) -> [f32; 2] {
    let mut span = [f32::NEG_INFINITY, f32::INFINITY];
    for axis in 0..3 {
        let ends = [low[axis], high[axis]].map(|side| (side - from[axis]) / along[axis]);
        span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
    }
    span
}

fn range_m(from: [f32; 3], along: [f32; 3]) -> f32 {
    let [_, wall] = cut(from, along, &ROOM);
    BOXES.iter().fold(wall, |nearest, cuboid| {
        let [enters, leaves] = cut(from, along, cuboid);
        if enters <= leaves && enters > 0.0 { nearest.min(enters) } else { nearest }
    })
}

fn fill(sweep: &mut Vec<SweepReturn, RETURNS>, ends_s: f32, chance: &mut Chance) {
    sweep.clear();
    for firing in 0..FIRINGS {
        let share = firing as f32 / FIRINGS as f32;
        let pose = pose_at(ends_s + (share - 1.0) * PERIOD_S);
        let azimuth = -core::f32::consts::TAU * share;
        let (sin, cos) = libm::sincosf(azimuth);
        for ring in 0..16_u8 {
            let (up, flat) = libm::sincosf((f32::from(ring) * 2.0 - 15.0).to_radians());
            let beam = [flat * cos, flat * sin, up];
            let turned = Pose2::new(0.0, 0.0, pose.heading_rad).transform(Point2::new(beam[0], beam[1]));
            let range =
                range_m([pose.x_m, pose.y_m, 0.0], [turned.x_m, turned.y_m, up]) + 0.01 * chance.next();
            let point_in_sensor = Vector3::new(beam[0] * range, beam[1] * range, beam[2] * range);
            let _ = sweep.push(SweepReturn { point_in_sensor, time_share: share, ring });
        }
    }
}

/// Drives, and prints.
pub fn run() {
    let config = OdometryConfig::default();
    let odometry = ODOMETRY.init_with(|| LidarOdometry::new(&mut MAP.take()[..], config));
    let sweep = SWEEP.take();
    let (mut first, mut later) = (Stopwatch::default(), Stopwatch::default());
    let (mut chance, mut off_m) = (Chance(3), 0.0_f32);
    let times = SweepTimes { since_last_s: f64::from(PERIOD_S), duration_s: f64::from(PERIOD_S) };
    let begun = pose_at(0.0);
    for number in 0..SWEEPS {
        let ends_s = number as f32 * PERIOD_S;
        fill(sweep, ends_s, &mut chance);
        let (outcome, instructions) = Stopwatch::of(|| odometry.push(sweep, times, &MotionAid::default()));
        // The first two are straightened by each other.
        let watch = if number < 2 { &mut first } else { &mut later };
        watch.enter(instructions);
        let truth = begun.inverse().compose(pose_at(ends_s));
        let found = outcome.state.pose.place_m;
        off_m = off_m.max(libm::hypotf(found.x as f32 - truth.x_m, found.y as f32 - truth.y_m));
    }
    first.print("lidar-odometry-first-two");
    later.print("lidar-odometry-sweep");
    hprintln!("bytes lidar-odometry {}", size_of_val(odometry) + BUCKETS * size_of::<Bucket>());
    hprintln!("off_mm lidar-odometry {}", (1.0e3 * off_m) as u32);
}
