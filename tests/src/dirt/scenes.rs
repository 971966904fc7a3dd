//! Scenes for the comparison: a robot drives towards dirt of one kind on a floor of one kind, while somebody's shadow
//! passes, under lamps that shine back, sometimes over the line of a safety projector.

use floorguard_perception::floor::Plane;
use floorguard_perception::floor::dirt::FloorView;
use floorguard_sim::floor::{DirtKind, FloorCamera, FloorKind, FloorScene, MarkingColour, Spill};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::PinholeCamera;

/// Frames of a scene; the last one is judged.
pub const FRAMES: u32 = 5;
/// Travel and time between frames.
const STEP_M: f32 = 0.12;
const STEP_S: f32 = 0.3;
/// Spots of dirt in view.
const SPILLS: usize = 3;

/// A scene and the poses from which it is seen.
pub struct Approach {
    /// The floor.
    pub scene: FloorScene,
    /// The camera.
    pub camera: FloorCamera,
    last: Pose2,
}

impl Approach {
    /// The scene of a floor, a kind of dirt and a number; another seed is another scene.
    pub fn new(floor: FloorKind, dirt: DirtKind, (number, seed): (u64, u64)) -> Self {
        let index = |position: Option<usize>| position.unwrap_or(0) as u64;
        let floor_index = index(FloorKind::ALL.iter().position(|kind| *kind == floor));
        let dirt_index = index(DirtKind::ALL.iter().position(|kind| *kind == dirt));
        let seed =
            seed.wrapping_mul(100_000).wrapping_add(10_000 * floor_index + 1_000 * dirt_index + number);
        let mut random = Pcg32::new(seed, 1);
        let mut scene = FloorScene::new(floor, 4.0, seed);
        let last = Pose2::new(0.0, 0.0, random.uniform_between(-3.0, 3.0));
        for spill in 0..SPILLS {
            let across = -0.275 + 0.275 * spill as f32 + random.uniform_between(-0.1, 0.1);
            let place = last.transform(Point2::new(random.uniform_between(0.75, 1.5), across));
            scene.spills.push(Spill::random(dirt, place, &mut random));
        }
        let near = Point2::new(random.uniform_between(0.7, 1.5), random.uniform_between(-0.4, 0.4));
        let last_s = STEP_S * (FRAMES - 1) as f32;
        scene.lighting.add_shadow(last.transform(near), last_s, &mut random);
        if number % 2 == 1 {
            let colour = if number % 4 == 1 { MarkingColour::Red } else { MarkingColour::Green };
            scene.marking = Some((1.25, colour));
        }
        Self { scene, camera: FloorCamera::default(), last }
    }

    /// Where the robot is at a frame.
    pub fn pose(&self, frame: u32) -> Pose2 {
        let left = (FRAMES - 1 - frame) as f32;
        self.last.compose(Pose2::new(-STEP_M * left, 0.0, 0.02 * left))
    }

    /// When a frame is taken.
    pub fn time_s(&self, frame: u32) -> f32 {
        STEP_S * frame as f32
    }
}

/// The detector's parameters for the simulated camera.
pub fn view(camera: &FloorCamera, robot_in_map: Pose2) -> FloorView {
    let centre = [(camera.size.width as f32 - 1.0) / 2.0, (camera.size.height as f32 - 1.0) / 2.0];
    FloorView {
        camera: PinholeCamera::new([camera.focal_px; 2], centre).expect("a simulated camera is calibrated"),
        plane: Plane::of_mounting(camera.height_m, camera.pitch_rad).expect("it is above the floor"),
        robot_in_map,
        camera_in_robot: Pose2::new(camera.forward_m, 0.0, 0.0),
    }
}
