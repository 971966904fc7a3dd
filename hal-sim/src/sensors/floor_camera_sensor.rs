//! The floor camera of a robot that drives: depth of whatever stands or lies before it, and colour of the floor with the
//! dirt that really lies there.

use floorguard_perception::floor::DepthNoise;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::ImageSize;

use super::depth_camera::DepthCamera;
use crate::dirt::DirtyFloor;
use crate::floor::{FloorCamera, FloorKind, FloorScene, PictureMoment};
use crate::people::Person;
use crate::scene::Scene;

/// Radius of a speck, metres.
const SPECK_M: f32 = 0.006;
/// What is this much nearer than the floor is no floor: in the colour picture it has a colour of its own, metres.
const STANDS_M: f32 = 0.03;
/// Farther lamps are left out, metres.
const LIT_M: f32 = 7.0;
/// Lamps over a square of this half side, metres.
const LAMPS_M: f32 = 25.0;

/// The camera and the floor that it looks at.
#[derive(Clone, Debug)]
pub struct FloorCameraSensor {
    depth: DepthCamera,
    colour: FloorCamera,
    floor: FloorScene,
    seed: u64,
}

/// From where the camera looks down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorCameraMounting {
    /// Above the floor, metres.
    pub height_m: f32,
    /// Before the robot's origin, metres.
    pub forward_m: f32,
    /// Downwards from the horizon, radians.
    pub pitch_rad: f32,
}

/// What the camera saw at one moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FloorFrame {
    /// Millimetres along the optical axis, row by row; 0 where nothing came back.
    pub depth_mm: Vec<u16>,
    /// Red, green, blue, row by row.
    pub rgb: Vec<u8>,
}

impl FloorCameraSensor {
    /// Columns and rows of the depth picture.
    pub const DEPTH_SIZE: ImageSize = ImageSize { width: 160, height: 120 };
    /// Columns and rows of the colour picture, of the same view.
    pub const COLOUR_SIZE: ImageSize = ImageSize { width: 320, height: 240 };
    /// Focal length of the depth picture, pixels.
    pub const FOCAL_PX: f32 = 131.25;
    /// Where it is on the robot.
    pub const MOUNTING: FloorCameraMounting =
        FloorCameraMounting { height_m: 0.72, forward_m: 0.9, pitch_rad: 0.85 };

    /// The camera over a floor of a kind.
    #[must_use]
    pub fn new(floor: FloorKind, seed: u64) -> Self {
        let FloorCameraMounting { height_m, forward_m, pitch_rad } = Self::MOUNTING;
        Self {
            depth: DepthCamera {
                size: Self::DEPTH_SIZE,
                focal_px: Self::FOCAL_PX,
                height_m,
                pitch_rad,
                forward_m,
                scale: 1.0,
                noise: DepthNoise::NGUYEN,
            },
            colour: FloorCamera {
                size: Self::COLOUR_SIZE,
                focal_px: 2.0 * Self::FOCAL_PX,
                height_m,
                pitch_rad,
                forward_m,
                ..FloorCamera::default()
            },
            floor: FloorScene::new(floor, LAMPS_M, seed),
            seed,
        }
    }

    /// What is seen from a pose at a time; `frame` draws the noise.
    pub(crate) fn render(
        &self,
        (scene, people, dirt): (&Scene, &[Person], Option<&DirtyFloor>),
        robot: Pose2,
        PictureMoment { frame, at_s }: PictureMoment,
    ) -> FloorFrame {
        let seed = self.seed.wrapping_mul(1_000_003).wrapping_add(u64::from(frame));
        let standing = self.depth.picture(scene, people, robot, seed);
        let is_speck = |place| dirt.is_some_and(|dirt| dirt.is_speck_within(place, SPECK_M));
        // Lamps far away give little light and cost as much time as near ones.
        let mut floor = self.floor.clone();
        let here = Point2::new(robot.x_m, robot.y_m);
        floor.lighting.lamps.retain(|lamp| lamp.above_in_world.distance(here) < LIT_M);
        let mut picture = floor.picture_with(&self.colour, robot, PictureMoment { frame, at_s }, is_speck);
        let (width, small) = (Self::COLOUR_SIZE.width, Self::DEPTH_SIZE.width);
        for (index, pixel) in picture.rgb.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let place = index / width / 2 * small + index % width / 2;
            let (Some(depth_mm), Some(rgb)) =
                (standing.depth_mm.get(place), standing.rgb.as_chunks::<3>().0.get(place))
            else {
                continue;
            };
            if *depth_mm > 0 && f32::from(*depth_mm) * 1.0e-3 < self.floor_depth_m(place / small) - STANDS_M {
                *pixel = *rgb;
            }
        }
        FloorFrame { depth_mm: standing.depth_mm, rgb: picture.rgb }
    }

    /// Depth of the empty floor in a row of the depth picture, metres.
    fn floor_depth_m(&self, row: usize) -> f32 {
        let (sin, cos) = libm::sincosf(self.depth.pitch_rad);
        let y = (row as f32 - (self.depth.size.height as f32 - 1.0) / 2.0) / self.depth.focal_px;
        let down = sin + y * cos;
        if down > 0.05 { self.depth.height_m / down } else { f32::INFINITY }
    }
}
