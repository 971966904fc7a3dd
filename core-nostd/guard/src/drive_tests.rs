//! The memory on a robot that drives: rays are cast at boxes by plain geometry, packet for packet, and what is kept of them when the
//! robot must begin to brake is compared with where they stand.

use crate::tests::fixtures::{config, forward};
use crate::{Cell, GuardConfig, LidarRays, LocalMemory, REACTION_S, STANDOFF_M, Sight, Stopping, Supervisor};
use floorguard_types::capacities::PACKET_RINGS_MAX;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{LidarColumn, LidarPacket};
use floorguard_types::time::Stamp;

/// Firings of a packet, and hundredths of a degree between two.
const COLUMNS: u16 = 24;
const STEP_CDEG: u16 = 20;
/// Nothing is met farther away than this, metres.
const FAR_M: f64 = 20.0;
/// A range is wrong by at most this, metres.
const NOISE_M: f32 = 0.02;

/// A box: least and greatest x, y and z, metres, in the frame in which the robot starts.
#[derive(Clone, Copy, Debug)]
struct Cuboid([[f64; 2]; 3]);

impl Cuboid {
    /// Where a ray enters it, metres along the ray.
    fn entered_m(&self, from: [f64; 3], direction: [f64; 3]) -> Option<f64> {
        let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
        for ((side, from), direction) in self.0.iter().zip(from).zip(direction) {
            let [a, b] = side.map(|end| (end - from) / direction);
            (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
        }
        (enters < leaves).then_some(enters)
    }
}

/// The lidar, 0.5 m ahead of the robot's origin and 0.8 m high.
struct Lidar {
    random: Pcg32,
    azimuth_cdeg: u16,
}

impl Lidar {
    fn new(seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 5);
        let azimuth_cdeg = (random.below(1_800) * 20) as u16;
        Self { random, azimuth_cdeg }
    }

    /// The next packet. Only what lies ahead is cast; nothing is behind.
    fn packet(&mut self, stamp: Stamp, pose: Pose2, boxes: &[Cuboid]) -> LidarPacket {
        let columns = (0..COLUMNS).map(|index| {
            let azimuth_cdeg = (self.azimuth_cdeg + index * STEP_CDEG) % 36_000;
            let mut column =
                LidarColumn { azimuth_cdeg, offset_us: u32::from(index) * 55, ..LidarColumn::SILENT };
            if !(6_000..30_000).contains(&azimuth_cdeg) {
                self.cast(&mut column.range_raw, (azimuth_cdeg, pose), boxes);
            }
            column
        });
        let columns = columns.collect();
        self.azimuth_cdeg = (self.azimuth_cdeg + COLUMNS * STEP_CDEG) % 36_000;
        LidarPacket { stamp, range_unit_mm: 2, rings: 16, columns }
    }

    fn cast(
        &mut self,
        range_raw: &mut [u16; PACKET_RINGS_MAX],
        (azimuth_cdeg, pose): (u16, Pose2),
        boxes: &[Cuboid],
    ) {
        let heading = f64::from(pose.heading_rad);
        let azimuth = heading - f64::from(azimuth_cdeg).to_radians() / 100.0;
        let from =
            [f64::from(pose.x_m) + 0.5 * heading.cos(), f64::from(pose.y_m) + 0.5 * heading.sin(), 0.8];
        for (ring, raw) in range_raw.iter_mut().enumerate().take(16) {
            let elevation = (ring as f64 * 2.0 - 15.0).to_radians();
            let direction =
                [elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin()];
            let floor_m = if direction[2] < 0.0 { -from[2] / direction[2] } else { FAR_M };
            let met_m = boxes.iter().filter_map(|cuboid| cuboid.entered_m(from, direction));
            let range_m = met_m.fold(floor_m.min(FAR_M), f64::min) as f32;
            let range_m = range_m + self.random.uniform_between(-NOISE_M, NOISE_M);
            *raw = (range_m * 500.0) as u16;
        }
    }
}

/// From the robot's origin to its front, metres.
const FRONT_M: f32 = 0.95;
/// Packets in 10 ms, of 754 a second.
const PACKETS: u64 = 8;
/// What is kept may be off by a cell and the noise, metres.
const NEAR_M: f32 = 0.12;

/// The robot drives straight on; whether something is kept across its way where a box stands, when it must begin to brake.
fn is_kept(config: &GuardConfig, cuboid: Cuboid, (mps, seed): (f32, u64)) -> bool {
    let motion = forward(mps);
    let stops_m = Stopping::from(&config.footprint, motion, (&config.drive, REACTION_S)).path_m();
    let [[face_m, back_m], [right_m, left_m], _] = cuboid.0.map(|side| side.map(|end| end as f32));
    let mut drive = Drive::begin(config, seed);
    drive.go((mps, (face_m - FRONT_M - stops_m - STANDOFF_M) / mps), &[cuboid]);
    drive.obstacles(Sight::Met).into_iter().any(|place| {
        (face_m - NEAR_M..back_m + NEAR_M).contains(&place.x_m)
            && (right_m.max(-0.4) - NEAR_M..left_m.min(0.4) + NEAR_M).contains(&place.y_m)
    })
}

/// A robot that drives straight on, and what it remembers.
struct Drive {
    guard: Supervisor,
    lidar: Lidar,
    steps: u64,
}

impl Drive {
    fn begin(config: &GuardConfig, seed: u64) -> Self {
        let guard = Supervisor::new(config.clone(), Stamp::from_micros(1_000_000)).unwrap();
        Self { guard, lidar: Lidar::new(seed), steps: 0 }
    }

    fn go(&mut self, (mps, seconds): (f32, f32), boxes: &[Cuboid]) {
        for _ in 0..(seconds * 100.0) as u64 {
            let now = Stamp::from_micros(1_000_000 + self.steps * 10_000);
            self.steps += 1;
            self.guard.on_wheels(forward(mps), now, now);
            for part in 0..PACKETS {
                let pose = self.guard.memory.pose();
                let packet = self.lidar.packet(now.plus_micros(part * 1_250), pose, boxes);
                self.guard.remember_packet(&packet);
                self.guard.remember_more(&packet);
            }
        }
    }

    /// Where something was met, or may be hidden.
    fn obstacles(&self, wanted: Sight) -> std::vec::Vec<Point2> {
        let mut places = std::vec::Vec::new();
        self.guard.memory.for_each_obstacle((&self.guard.rays, true), |cell, sight| {
            if sight == wanted {
                places.push(cell.middle());
            }
        });
        places
    }

    fn nearest_m(&self, wanted: Sight) -> f32 {
        self.obstacles(wanted).into_iter().map(|place| place.x_m).fold(f32::INFINITY, f32::min)
    }
}

/// A block beside the way whose upper far end alone lies in the rays of the standing robot: it stays when the robot has begun to
/// move and the lowest ring has risen above it, and so does what it may hide.
#[test]
fn fg_req_068_edge_met_at_the_start_stays() {
    let mut config = config();
    config.thresholds.memory_firings = 8;
    let block = Cuboid([[1.0, 1.53], [0.36, 0.42], [0.31, 0.535]]);
    let mut drive = Drive::begin(&config, 3);
    drive.go((0.0, 1.5), &[block]);
    drive.go((0.2, 0.6), &[block]);
    assert!((drive.nearest_m(Sight::Met) - 1.42).abs() < NEAR_M, "{}", drive.nearest_m(Sight::Met));
    assert!(drive.nearest_m(Sight::Hidden) < 1.0, "{}", drive.nearest_m(Sight::Hidden));
    // What goes away while the robot stands is forgotten.
    let mut drive = Drive::begin(&config, 3);
    drive.go((0.0, 1.5), &[block]);
    drive.go((0.0, 1.5), &[]);
    assert!(drive.obstacles(Sight::Met).is_empty(), "{}", drive.nearest_m(Sight::Met));
}

/// The lowest ring meets nothing but the narrow far end of a low object, and passes beside it through the same cell: that is no look
/// through what it has just met.
#[test]
fn fg_req_068_narrow_end_met_at_the_start_stays() {
    let mut config = config();
    config.thresholds.memory_firings = 8;
    config.lidar.floor_clearance_m = 0.08;
    let bar = Cuboid([[2.7, 3.118], [0.29, 0.32], [0.0, 0.1]]);
    for seed in 0..8 {
        let mut drive = Drive::begin(&config, seed);
        drive.go((0.0, 1.3), &[bar]);
        drive.go((0.5, 0.6), &[bar]);
        assert!((drive.nearest_m(Sight::Met) - 3.11).abs() < NEAR_M, "seed {seed}");
        assert!(drive.nearest_m(Sight::Hidden) < 2.7, "seed {seed}");
    }
}

/// What hid a low box goes away when the lowest ring passes over its near side already: nothing has been seen of that side. A box that was
/// in sight has been met as near as it is.
#[test]
fn fg_req_068_side_never_in_sight_is_hidden() {
    let mut config = config();
    config.thresholds.memory_firings = 8;
    config.lidar.floor_clearance_m = 0.08;
    let (low_box, screen) =
        (Cuboid([[5.1, 5.9], [-0.3, 0.3], [0.0, 0.12]]), Cuboid([[5.0, 5.05], [-3.0, 3.0], [0.0, 2.0]]));
    for seed in 0..4 {
        let mut drive = Drive::begin(&config, seed);
        drive.go((0.5, 5.2), &[low_box, screen]);
        drive.go((0.0, 1.5), &[low_box]);
        let face_m = 5.1;
        let [met, hidden] = [Sight::Met, Sight::Hidden].map(|sight| {
            let places = drive.obstacles(sight).into_iter();
            places.filter(|place| place.y_m.abs() < 0.4).collect::<std::vec::Vec<_>>()
        });
        assert!(met.iter().all(|place| place.x_m > face_m + 0.3), "seed {seed}: {met:?}");
        assert!(hidden.iter().any(|place| place.x_m < face_m + 0.25), "seed {seed}: {hidden:?}");
        assert!(hidden.iter().all(|place| place.x_m > face_m - 0.15), "seed {seed}: {hidden:?}");
        let mut drive = Drive::begin(&config, seed);
        drive.go((0.5, 5.2), &[low_box]);
        assert!((drive.nearest_m(Sight::Met) - face_m).abs() < NEAR_M, "seed {seed}");
        assert!(drive.nearest_m(Sight::Hidden) > face_m, "seed {seed}: {}", drive.nearest_m(Sight::Hidden));
    }
}

/// A ramp of one in four is an obstacle, and begins where it meets the floor: there the rays show its height too late.
#[test]
fn fg_req_028_steep_ramp_begins_on_the_floor() {
    let mut config = config();
    config.thresholds.memory_firings = 8;
    config.lidar.floor_clearance_m = 0.08;
    let stairs: std::vec::Vec<Cuboid> = (0..100)
        .map(|stair| f64::from(stair) * 0.015)
        .map(|along_m| Cuboid([[4.5 + along_m, 6.0], [-0.5, 0.5], [0.0, 0.25 * along_m]]))
        .collect();
    let mut drive = Drive::begin(&config, 4);
    drive.go((0.5, 4.4), &stairs);
    let nearest_m = drive.nearest_m(Sight::Met);
    assert!((4.3..4.6).contains(&nearest_m), "{nearest_m}");
}

/// The side of a ramp of one in three that rises to the right is a step, although what lies behind it rises gently, seen from here.
#[test]
fn fg_req_028_side_of_a_ramp_is_a_step() {
    let mut config = config();
    config.thresholds.memory_firings = 8;
    config.lidar.floor_clearance_m = 0.08;
    let strips: std::vec::Vec<Cuboid> = (0..120)
        .map(|strip| f64::from(strip) * 0.01)
        .map(|aside_m| Cuboid([[4.5, 6.0], [-1.3, -0.1 - aside_m], [0.0, 0.3 * aside_m]]))
        .collect();
    let mut drive = Drive::begin(&config, 4);
    drive.go((0.5, 4.4), &strips);
    let on_the_way = |place: &Point2| place.y_m > -0.45;
    let met = drive.obstacles(Sight::Met).into_iter().filter(on_the_way);
    let nearest_m = met.map(|place| place.x_m).fold(f32::INFINITY, f32::min);
    assert!((4.4..4.75).contains(&nearest_m), "{nearest_m}");
}

/// Of so many boxes that are drawn, those that are kept.
fn kept_of(count: u64, firings: u8, draw: fn(&mut Pcg32) -> Cuboid) -> usize {
    let mut config = config();
    config.thresholds.memory_firings = firings;
    config.lidar.floor_clearance_m = 0.08;
    let mut random = Pcg32::new(66, 1);
    let is_kept = |seed: &u64| {
        let cuboid = draw(&mut random);
        is_kept(&config, cuboid, (random.uniform_between(0.5, 1.0), *seed))
    };
    (0..count).filter(is_kept).count()
}

/// Boxes of 12 to 14 cm: one ring after the other passes over each within 0.3 s.
fn low(random: &mut Pcg32) -> Cuboid {
    let mut between = |low: f32, high: f32| f64::from(random.uniform_between(low, high));
    let (face_m, right_m) = (between(5.0, 5.2), between(-0.4, 0.0));
    let (deep_m, wide_m, high_m) = (between(0.2, 0.6), between(0.2, 0.5), between(0.12, 0.14));
    Cuboid([[face_m, face_m + deep_m], [right_m, right_m + wide_m], [0.0, high_m]])
}

/// Boxes of 10 cm, level and deep: of the lidar's rings at most two cross the top before the robot must brake, one long after the other.
fn level(random: &mut Pcg32) -> Cuboid {
    let mut between = |low: f32, high: f32| f64::from(random.uniform_between(low, high));
    let (face_m, right_m) = (between(5.0, 5.2), between(-0.4, -0.2));
    let (deep_m, wide_m) = (between(0.4, 0.6), between(0.4, 0.6));
    Cuboid([[face_m, face_m + deep_m], [right_m, right_m + wide_m], [0.0, 0.10]])
}

/// Bars of 2 to 4 cm across the way, 1 to 2.4 m long.
fn bar(random: &mut Pcg32) -> Cuboid {
    let mut between = |low: f32, high: f32| f64::from(random.uniform_between(low, high));
    let (face_m, wide_m) = (between(5.0, 5.2), between(0.5, 1.2));
    let (low_m, thick_m) = (between(0.2, 0.65), between(0.02, 0.04));
    Cuboid([[face_m, face_m + thick_m], [-wide_m, wide_m], [low_m, low_m + thick_m]])
}

#[test]
fn fg_req_066_what_is_seen_for_a_moment_is_kept() {
    assert_eq!([low, bar, level].map(|draw| kept_of(12, 8, draw)), [12, 12, 12]);
    let with_one = kept_of(12, 1, low);
    assert!((9..12).contains(&with_one), "one firing of a packet meets too little of some: {with_one}");
}

/// The whole level top of a box of 10 cm is kept up to its face when the robot must begin to brake, and nothing before it: two rings
/// cross it, half a second after each other, the first one 3.1 m ahead of the lidar.
#[test]
fn fg_req_066_level_top_is_kept_to_its_face() {
    let mut config = config();
    config.thresholds.memory_firings = 8;
    config.lidar.floor_clearance_m = 0.08;
    for (seed, mps) in [0.5_f32, 0.7, 0.85, 1.0].into_iter().cycle().take(8).enumerate() {
        let face_m = 5.0 + 0.031 * seed as f32;
        let cuboid = Cuboid([[f64::from(face_m), f64::from(face_m) + 0.5], [-0.1, 0.4], [0.0, 0.1]]);
        let stops_m = Stopping::from(&config.footprint, forward(mps), (&config.drive, REACTION_S)).path_m();
        let mut drive = Drive::begin(&config, seed as u64);
        drive.go((mps, (face_m - FRONT_M - stops_m - STANDOFF_M) / mps), &[cuboid]);
        let late_m = drive.nearest_m(Sight::Met) - face_m;
        assert!(late_m.abs() < 0.10, "{mps} m/s, seed {seed}: {late_m}");
    }
}

fn at_ms(ms: u64) -> Stamp {
    Stamp::from_micros(1_000_000 + ms * 1_000)
}

/// The lidar has met these heights at two places beside each other, 3 m ahead, and then the robot drove.
fn nearest_m(heights_m: &[f32], driven_m: f32) -> f32 {
    let mut memory = std::boxed::Box::new(LocalMemory::EMPTY);
    memory.forget();
    memory.follow(forward(0.0), at_ms(0));
    let cell = Cell::of(Point2::new(3.0, 0.0));
    for span in 1..3 {
        for (height_m, x) in heights_m.iter().flat_map(|height_m| [(*height_m, 0), (*height_m, 1)]) {
            memory.meet(Cell { x: cell.x + x, ..cell }, height_m, 0.12);
        }
        memory.follow(forward(0.0), at_ms(span * 310));
    }
    for step in 0..(driven_m * 100.0) as u64 {
        memory.follow(forward(1.0), at_ms(930 + step * 10));
    }
    let (mut nearest_m, mut rays) = (f32::INFINITY, LidarRays::NONE);
    rays.fill(&config().lidar);
    memory.for_each_obstacle((&rays, false), |cell, _| nearest_m = nearest_m.min(cell.middle().x_m));
    nearest_m
}

#[test]
fn fg_req_068_low_object_near_the_start_hides_its_side() {
    let low = nearest_m(&[0.10, 0.12], 0.0);
    assert!((low - 2.42).abs() < 0.08, "half a metre before what was met: {low}");
    assert!((nearest_m(&[0.10, 0.12], 1.5) - low).abs() < 0.01, "still");
    let met = nearest_m(&[0.10, 0.12], 2.5);
    assert!((met - 2.97).abs() < 0.08, "the robot has come to where nothing was hidden: {met}");
    let high = nearest_m(&[0.10, 0.2, 0.3, 0.4], 0.0);
    assert!((high - 2.97).abs() < 0.08, "its upper part was met as near as it is: {high}");
}

/// The far corner of an oblique board of 12 cm is all that stands in the way, 4 cm deep: it is kept wherever the cells lie.
#[test]
fn fg_req_066_corner_in_the_way_is_kept() {
    let mut config = config();
    config.thresholds.memory_firings = 8;
    config.lidar.floor_clearance_m = 0.08;
    let (sin, cos) = 0.394_f64.sin_cos();
    let (long_m, wide_m, mps) = (0.832, 0.118, 0.8);
    let top_m = (sin * long_m + cos * wide_m) / 2.0;
    let stops_m = Stopping::from(&config.footprint, forward(mps), (&config.drive, REACTION_S)).path_m();
    for seed in (0..24_u64).step_by(4) {
        let (middle_x, middle_y) = (5.0 + 0.0093 * seed as f64, -0.36 - top_m);
        let strips: std::vec::Vec<Cuboid> = (0..80)
            .map(|strip| (2.0 * f64::from(strip) + 1.0 - 80.0) / 80.0 * top_m)
            .map(|y| {
                let along = [(-long_m / 2.0 - y * sin) / cos, (long_m / 2.0 - y * sin) / cos];
                let across = [(y * cos - wide_m / 2.0) / sin, (y * cos + wide_m / 2.0) / sin];
                let x = [middle_x + along[0].max(across[0]), middle_x + along[1].min(across[1])];
                Cuboid([x, [middle_y + y - top_m / 80.0, middle_y + y + top_m / 80.0], [0.0, 0.12]])
            })
            .filter(|Cuboid([[back, front], ..])| back < front)
            .collect();
        let corner_m = (middle_x + (cos * long_m - sin * wide_m) / 2.0) as f32;
        let mut drive = Drive::begin(&config, seed);
        drive.go((mps, (corner_m - FRONT_M - stops_m - STANDOFF_M) / mps), &strips);
        let in_the_way = |place: &Point2| place.y_m > -0.45 && place.x_m > 4.0;
        assert!(drive.obstacles(Sight::Met).iter().any(in_the_way), "seed {seed}");
    }
}
