//! Corridor, clutter, walker and the robot's path, all from one seed.

use floorguard_sim::people::{Build, Person, PersonKind};
use floorguard_sim::robot::{RobotBody, RobotParameters};
use floorguard_sim::scene::{Material, Scene, SceneBuilder};
use floorguard_sim::sensors::{LIDAR_PACKET_NS, Lidar, View};
use floorguard_sim::wire::ReturnMode;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::random::Pcg32;

/// Half the width of the corridor, metres.
const HALF_WIDTH_M: f32 = 1.6;
const HEIGHT_M: f32 = 2.5;
/// Clutter reaches at most this far from the wall, metres.
const CLUTTER_DEPTH_M: f32 = 0.45;
/// The walker turns when this far ahead of or behind the robot, metres.
const TURN_M: f32 = 6.0;
/// Beams end here at the latest, metres.
const VIEW_M: f32 = 60.0;

/// What is true at the end of a packet.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Seconds since the start.
    pub time_s: f64,
    /// The robot.
    pub robot: Pose2,
    /// Its speed.
    pub twist: Twist2,
    /// The middle of the walker.
    pub walker: Point2,
}

/// Everything that moves and stands.
pub struct World {
    scene: Scene,
    walker: Person,
    robot: RobotParameters,
    lidar: Lidar,
    speed_mps: f32,
    sway_phase_rad: f32,
    packets: u64,
}

impl World {
    /// The corridor of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 77);
        let speed_mps = random.uniform_between(0.5, 1.5);
        let lane_m = random.uniform_between(0.45, 0.75);
        let walker = Person {
            walk: None,
            id: 1,
            kind: PersonKind::Adult,
            build: Build::SAME,
            position: Point2::new(random.uniform_between(4.0, TURN_M), lane_m),
            velocity: Point2::new(-speed_mps, 0.0),
            heading_rad: std::f32::consts::PI,
            gait_rad: random.uniform_between(0.0, std::f32::consts::TAU),
            goals: Vec::new(),
            goal: 0,
            speed_mps,
            starts_us: 0,
            sees_robot: false,
        };
        Self {
            scene: corridor(&mut random),
            walker,
            robot: RobotParameters::default(),
            lidar: Lidar::new(seed, ReturnMode::Strongest),
            speed_mps: random.uniform_between(0.2, 0.8),
            sway_phase_rad: random.uniform_between(0.0, std::f32::consts::TAU),
            packets: 0,
        }
    }

    /// Where the lidar sits on the robot: forward and up, metres.
    #[must_use]
    pub const fn lidar_mount(&self) -> (f32, f32) {
        (self.robot.lidar.x_m, self.robot.lidar.z_m)
    }

    /// The robot drives along the corridor in slight bends: ±4° in eight seconds.
    fn robot_at(&self, time_s: f32) -> (Pose2, Twist2) {
        const SWAY_RAD: f32 = 0.07;
        const RATE_RADPS: f32 = std::f32::consts::TAU / 8.0;
        let phase = self.sway_phase_rad + RATE_RADPS * time_s;
        let heading_rad = SWAY_RAD * libm::sinf(phase);
        // The integral of the speed along a heading this small.
        let y_m = -0.5 - self.speed_mps * SWAY_RAD / RATE_RADPS * libm::cosf(phase);
        let pose = Pose2::new(self.speed_mps * time_s, y_m, heading_rad);
        let angular_radps = SWAY_RAD * RATE_RADPS * libm::cosf(phase);
        (pose, Twist2 { linear_mps: self.speed_mps, angular_radps })
    }

    /// Plays one packet of the lidar.
    pub fn next_packet(&mut self) -> (Vec<u8>, Moment) {
        let packet_s = LIDAR_PACKET_NS as f64 * 1.0e-9;
        let start_s = self.packets as f64 * packet_s;
        self.packets += 1;
        let (pose, _) = self.robot_at((start_s + 0.5 * packet_s) as f32);
        self.walk(pose.x_m, packet_s as f32);
        let body = RobotBody::new(self.robot.clone(), pose);
        let people = std::slice::from_ref(&self.walker);
        let view = View::new(&self.scene, people, (&body, self.robot.lidar), VIEW_M);
        let payload = self.lidar.measure(&view, ((start_s + 0.5 * packet_s) * 1.0e6) as u64);
        let time_s = start_s + packet_s;
        let (robot, twist) = self.robot_at(time_s as f32);
        (payload, Moment { time_s, robot, twist, walker: self.walker.position })
    }

    fn walk(&mut self, robot_x_m: f32, step_s: f32) {
        let ahead_m = self.walker.position.x_m - robot_x_m;
        if ahead_m < -TURN_M {
            self.walker.velocity.x_m = self.walker.speed_mps + self.speed_mps;
        } else if ahead_m > TURN_M {
            self.walker.velocity.x_m = -self.walker.speed_mps;
        }
        self.walker.advance(step_s);
    }
}

/// Two walls, ends, and clutter along both walls: cupboards, tables, bins, door frames.
fn corridor(random: &mut Pcg32) -> Scene {
    let mut builder = SceneBuilder::default();
    let (from_m, to_m) = (-12.0, 34.0);
    for y in [-HALF_WIDTH_M, HALF_WIDTH_M] {
        builder.wall([from_m, y], [to_m, y], HEIGHT_M, Material::Matte);
    }
    for x in [from_m, to_m] {
        builder.wall([x, -HALF_WIDTH_M], [x, HALF_WIDTH_M], HEIGHT_M, Material::Matte);
    }
    for side in [-1.0_f32, 1.0] {
        let mut x = from_m + 1.0;
        while x < to_m - 1.0 {
            let (length, depth) =
                (random.uniform_between(0.3, 1.4), random.uniform_between(0.2, CLUTTER_DEPTH_M));
            let place = (x + length / 2.0, side * (HALF_WIDTH_M - depth / 2.0 - 0.05), 0.0);
            match random.below(5) {
                0 => builder.cuboid(place, (length, depth), (0.0, 1.9), Material::Matte),
                1 => builder.table(place, (length, depth), 0.74),
                2 => builder.cuboid(place, (0.3, 0.3), (0.0, 0.6), Material::Matte),
                3 => builder.cuboid(place, (0.12, 0.12), (0.0, 2.1), Material::Matte),
                _ => builder.shelf(place, (length, depth), 1.8),
            }
            x += length + random.uniform_between(0.5, 3.0);
        }
    }
    builder.build()
}
