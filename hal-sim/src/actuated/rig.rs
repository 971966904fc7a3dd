//! Lidar, motor and robot in a room, a millisecond at a time.

use floorguard_types::geometry::Pose2;
use parry3d::math::Vector;
use parry3d::query::Ray;

use super::lidar::{LidarModel, ScanLidar};
use super::motor::TurningMotor;
use super::picture::{MirrorCamera, PersonView, Ring};
use super::room::Room;
use crate::can::CanFrame;
use crate::people::{BodyPart, Person, body_parts};
use crate::scene::Scene;

const STEP_US: u64 = 1_000;
/// Height of the lidar above the floor, metres (Dalmedico et al. 2019).
const HEIGHT_M: f32 = 0.57;
const REACH_M: f32 = 12.0;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RigFault {
    /// Something holds the motor from this time on, microseconds.
    MotorStalled {
        /// Microseconds.
        from_us: u64,
    },
    /// Each `every`-th angle of the motor arrives, the others are lost.
    AnglesLost {
        /// 2 or more.
        every: u32,
    },
    /// Each `every`-th scan has one wrong character.
    DamagedCheck {
        /// 1: all of them.
        every: u32,
    },
}

/// What arrives at the robot's computer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RigEvent {
    /// Bytes of the lidar.
    Lidar(Vec<u8>),
    /// A frame on the bus.
    Frame(CanFrame),
}

/// The world of the lidar.
pub struct Rig {
    room: Room,
    lidar: ScanLidar,
    motor: TurningMotor,
    faults: Vec<RigFault>,
    pose: Pose2,
    now_us: u64,
    on_the_way: Vec<(u64, RigEvent)>,
    scans: u32,
    angles: u32,
    mounted: MountedLidar,
    /// Another world moves robot and people.
    is_carried: bool,
}

/// Where the lidar is on its robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountedLidar {
    /// The motor's axis in the base frame, forward and left, and the height of the optical centre, metres.
    pub place_m: [f32; 3],
    /// The motor's node.
    pub node: u8,
}

impl MountedLidar {
    /// Over the robot's centre (Dalmedico et al. 2019).
    pub const PUBLISHED: Self = Self { place_m: [0.0, 0.0, HEIGHT_M], node: 11 };
}

impl Rig {
    /// At time 0. The motor is node 11.
    #[must_use]
    pub fn new(room: Room, model: LidarModel, (faults, seed): (Vec<RigFault>, u64)) -> Self {
        Self::mounted(room, model, (MountedLidar::PUBLISHED, faults, seed))
    }

    /// On a robot of another world: its scene, and [`Rig::follow`] from step to step.
    #[must_use]
    pub fn carried(scene: Scene, model: LidarModel, (mounted, seed): (MountedLidar, u64)) -> Self {
        let start = Pose2::default();
        let room = Room { scene, people: Vec::new(), start, speed_mps: 0.0, turn_radps: 0.0 };
        Self { is_carried: true, ..Self::mounted(room, model, (mounted, Vec::new(), seed)) }
    }

    fn mounted(
        room: Room,
        model: LidarModel,
        (mounted, faults, seed): (MountedLidar, Vec<RigFault>, u64),
    ) -> Self {
        let (lidar, motor, pose) = (ScanLidar::new(model, seed), TurningMotor::new(mounted.node), room.start);
        Self {
            room,
            lidar,
            motor,
            faults,
            pose,
            now_us: 0,
            on_the_way: Vec::new(),
            scans: 0,
            angles: 0,
            mounted,
            is_carried: false,
        }
    }

    /// Where people and robot are now.
    pub fn follow(&mut self, people: &[Person], pose: Pose2) {
        self.room.people.clear();
        self.room.people.extend_from_slice(people);
        self.pose = pose;
    }

    /// Where the robot really is.
    #[must_use]
    pub const fn pose(&self) -> Pose2 {
        self.pose
    }

    /// Where the lidar really looks, radians from straight ahead.
    #[must_use]
    pub const fn angle_rad(&self) -> f64 {
        self.motor.angle_rad()
    }

    /// The panoramic picture.
    #[must_use]
    pub fn picture(&self, camera: &MirrorCamera) -> Ring {
        camera.picture(&self.room.scene, &self.room.people, self.pose)
    }

    /// Where people are in the picture.
    #[must_use]
    pub fn people(&self, camera: &MirrorCamera) -> Vec<PersonView> {
        camera.people(&self.room.people, self.pose)
    }

    /// Bytes for the lidar.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.lidar.receive(bytes, self.now_us);
    }

    /// A frame for the motor.
    pub fn receive_can(&mut self, frame: &CanFrame) {
        let mut out = Vec::new();
        self.motor.receive(frame, self.now_us, &mut out);
        self.send(out);
    }

    /// Frames arrive 0.3 ms later; angles may be lost.
    fn send(&mut self, frames: Vec<CanFrame>) {
        for frame in frames {
            let every = self.faults.iter().find_map(|fault| match fault {
                RigFault::AnglesLost { every } => Some((*every).max(1)),
                _ => None,
            });
            if frame.id == 0x180 + u32::from(self.mounted.node) {
                self.angles += 1;
                if every.is_some_and(|every| !self.angles.is_multiple_of(every)) {
                    continue;
                }
            }
            self.on_the_way.push((self.now_us + 300, RigEvent::Frame(frame)));
        }
    }

    /// Plays on; what arrives is given with its time.
    pub fn advance_to(&mut self, at_us: u64, sink: &mut dyn FnMut(u64, RigEvent)) {
        while self.now_us + STEP_US <= at_us {
            self.step();
            let due = self.now_us;
            let (arrived, later): (Vec<_>, Vec<_>) =
                std::mem::take(&mut self.on_the_way).into_iter().partition(|(at_us, _)| *at_us <= due);
            self.on_the_way = later;
            for (at_us, event) in arrived {
                sink(at_us, event);
            }
        }
    }

    fn step(&mut self) {
        let step_s = STEP_US as f32 * 1.0e-6;
        let (before_rad, before_pose, begin_us) = (self.motor.angle_rad(), self.pose, self.now_us);
        self.now_us += STEP_US;
        let now_us = self.now_us;
        self.motor.is_blocked = self
            .faults
            .iter()
            .any(|fault| matches!(fault, RigFault::MotorStalled { from_us } if now_us >= *from_us));
        let mut out = Vec::new();
        self.motor.tick(now_us, step_s, &mut out);
        self.send(out);
        self.drive(step_s);
        let turned_rad = self.motor.angle_rad() - before_rad;
        let bodies: Vec<BodyPart> = self.room.people.iter().flat_map(body_parts).collect();
        let scene = &self.room.scene;
        let [axis_x_m, axis_y_m, height_m] = self.mounted.place_m;
        let axis = before_pose.compose(Pose2::new(axis_x_m, axis_y_m, 0.0));
        let range_m = |at_us: f64, elevation_rad: f64| {
            let part = ((at_us - begin_us as f64) / STEP_US as f64).clamp(0.0, 1.0);
            let azimuth = f64::from(before_pose.heading_rad) + before_rad + part * turned_rad;
            let (sin, cos) = libm::sincos(elevation_rad);
            let direction =
                Vector::new((cos * libm::cos(azimuth)) as f32, (cos * libm::sin(azimuth)) as f32, sin as f32);
            let origin = Vector::new(axis.x_m, axis.y_m, height_m);
            let ray = Ray::new(origin, direction);
            let body = bodies.iter().filter_map(|part| part.cast(&ray, REACH_M));
            body.chain(scene.cast(origin, direction, REACH_M).map(|hit| hit.range_m)).reduce(f32::min)
        };
        let arrives = self.lidar.measure(now_us, range_m);
        for (at_us, bytes) in arrives {
            let bytes = self.damaged(bytes);
            self.on_the_way.push((at_us, RigEvent::Lidar(bytes)));
        }
    }

    fn damaged(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        if !bytes.starts_with(b"M") || bytes.len() < 200 {
            return bytes;
        }
        self.scans += 1;
        let every = self.faults.iter().find_map(|fault| match fault {
            RigFault::DamagedCheck { every } => Some((*every).max(1)),
            _ => None,
        });
        if every.is_some_and(|every| self.scans.is_multiple_of(every)) {
            bytes[100] = if bytes[100] == b'0' { b'1' } else { b'0' };
        }
        bytes
    }

    fn drive(&mut self, step_s: f32) {
        if self.is_carried {
            return;
        }
        let (sin, cos) = libm::sincosf(self.pose.heading_rad);
        let ahead_m = self.room.speed_mps * step_s;
        self.pose = Pose2::new(
            self.pose.x_m + cos * ahead_m,
            self.pose.y_m + sin * ahead_m,
            self.pose.heading_rad + self.room.turn_radps * step_s,
        );
        for person in &mut self.room.people {
            person.advance(step_s);
        }
    }
}
