//! Rooms for the lidar, and who walks in them.

use floorguard_types::geometry::{Point2, Pose2};

use crate::people::{Build, Person, PersonKind};
use crate::scene::{Material, Scene, SceneBuilder};

/// Names of the rooms.
pub const ROOMS: [&str; 4] = ["box", "office", "person", "drive"];

/// A room, who walks in it, and how the robot drives.
pub struct Room {
    /// What stands.
    pub scene: Scene,
    /// Who is there.
    pub people: Vec<Person>,
    /// Where the robot starts.
    pub start: Pose2,
    /// Ahead, m/s.
    pub speed_mps: f32,
    /// To the left, rad/s.
    pub turn_radps: f32,
}

impl Room {
    /// A room by its name: `box` (the published box 1 m ahead), `office` (table, cupboard, shelf), `person` (a person walks through
    /// the office), `drive` (the robot turns and drives in the office).
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let mut builder = SceneBuilder::default();
        walls(&mut builder);
        let (mut people, mut speed_mps, mut turn_radps) = (Vec::new(), 0.0, 0.0);
        if name == "box" {
            // 0.4 m wide and deep on a pedestal of 0.1 m: its top is 0.5 m high (Dalmedico et al. 2019).
            builder.cuboid((1.2, 0.0, 0.0), (0.4, 0.4), (0.1, 0.5), Material::Matte);
        } else {
            furniture(&mut builder);
        }
        match name {
            "box" | "office" => {}
            "person" => people.push(walker()),
            "drive" => (speed_mps, turn_radps) = (0.03, 0.02),
            _ => return None,
        }
        let start = Pose2::new(0.0, 0.0, 0.0);
        Some(Self { scene: builder.build(), people, start, speed_mps, turn_radps })
    }
}

/// 6 m by 5 m, 2.4 m high.
fn walls(builder: &mut SceneBuilder) {
    let corners = [[-2.5, -2.5], [3.5, -2.5], [3.5, 2.5], [-2.5, 2.5]];
    for (number, from) in corners.iter().enumerate() {
        builder.wall(*from, corners[(number + 1) % 4], 2.4, Material::Matte);
    }
}

fn furniture(builder: &mut SceneBuilder) {
    builder.table((2.4, -1.4, 0.0), (1.4, 0.8), 0.75);
    builder.cuboid((1.2, 2.1, 0.0), (0.8, 0.5), (0.0, 1.8), Material::Matte);
    builder.shelf((3.2, 1.2, 1.57), (1.2, 0.3), 1.6);
    builder.cuboid((2.0, 0.4, 0.3), (0.4, 0.3), (0.0, 0.4), Material::Matte);
}

fn walker() -> Person {
    Person {
        id: 1,
        kind: PersonKind::Adult,
        build: Build::SAME,
        position: Point2::new(2.2, 1.2),
        velocity: Point2::new(0.0, -0.2),
        heading_rad: -1.57,
        gait_rad: 0.0,
        goals: Vec::new(),
        goal: 0,
        speed_mps: 0.2,
        starts_us: 0,
        sees_robot: false,
        walk: None,
    }
}
