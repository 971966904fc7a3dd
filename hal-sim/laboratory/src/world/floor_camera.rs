//! The floor camera of a simulated robot: rendered pictures of what lies before it, through the same stages as a
//! real camera's, five times a second.

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_runtime::configuration::Mounting;
use floorguard_runtime::shared::Shared;
use floorguard_sim::floor::FloorKind;
use floorguard_sim::sensors::{FloorCameraMounting, FloorCameraSensor};
use floorguard_sim::simulation::Simulation;
use floorguard_types::geometry::Point3;
use floorguard_types::sensing::{ImageSize, PinholeCamera};
use floorguard_types::time::Stamp;

use crate::plan::Plan;
use floorguard_configuration::{CameraConfiguration, CameraSource};
use floorguard_robot::camera::{
    ColourPicture, DepthPicture, DirtStage, FloorMounting, FloorStage, PictureCamera, PictureFolder, SeenDirt,
};

/// Between pictures, microseconds: rendering one takes as long as everything else in this time.
const EVERY_US: u64 = 200_000;

/// People get a picture this often, microseconds.
const SHOWN_EVERY_US: u64 = 1_000_000;

/// A rendered camera and the stages for its pictures.
pub struct SimulatedCamera {
    sensor: FloorCameraSensor,
    floor: FloorStage,
    dirt: DirtStage,
    next_us: u64,
    shown_us: Option<u64>,
    picture: Option<ColourPicture>,
    frame: u32,
}

fn pinhole(ImageSize { width, height }: ImageSize, focal_px: f32) -> Option<PinholeCamera> {
    let middle = |side: usize| (side as f32 - 1.0) / 2.0;
    PinholeCamera::new([focal_px; 2], [middle(width), middle(height)])
}

impl SimulatedCamera {
    /// The camera of a plan's robot, over vinyl as supermarkets have it.
    #[must_use]
    pub fn new(plan: &Plan) -> Option<Self> {
        let FloorCameraMounting { height_m, forward_m, pitch_rad } = FloorCameraSensor::MOUNTING;
        let camera = CameraConfiguration {
            source: CameraSource::Devices { depth: "".into(), colour: None },
            size: FloorCameraSensor::DEPTH_SIZE,
            camera: pinhole(FloorCameraSensor::DEPTH_SIZE, FloorCameraSensor::FOCAL_PX)?,
            mounting: Mounting {
                position: Point3::new(forward_m, 0.0, height_m),
                pitch_rad,
                ..plan.robot.lidar.mounting
            },
        };
        let colour = pinhole(FloorCameraSensor::COLOUR_SIZE, 2.0 * FloorCameraSensor::FOCAL_PX)?;
        Some(Self {
            sensor: FloorCameraSensor::new(FloorKind::Vinyl, plan.seed),
            floor: FloorStage::new(&plan.robot, &camera)?,
            dirt: DirtStage::new(FloorCameraSensor::COLOUR_SIZE, colour)?,
            next_us: 0,
            shown_us: None,
            picture: None,
            frame: 0,
        })
    }

    /// What its colour pictures are like.
    pub const PICTURES: PictureCamera = PictureCamera {
        size: FloorCameraSensor::COLOUR_SIZE,
        focal_px: 2.0 * FloorCameraSensor::FOCAL_PX,
        mounting: FloorMounting {
            height_m: FloorCameraSensor::MOUNTING.height_m,
            forward_m: FloorCameraSensor::MOUNTING.forward_m,
            pitch_rad: FloorCameraSensor::MOUNTING.pitch_rad,
        },
    };

    /// Takes a picture when it is time, and tells the rings what it shows; it goes into the folder, too. True if it did.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn attend<M: RawMutex>(
        &mut self,
        simulation: &Simulation,
        shared: &Shared<M>,
        (now_us, folder): (u64, Option<&mut PictureFolder>),
    ) -> anyhow::Result<bool> {
        if now_us < self.next_us {
            return Ok(false);
        }
        self.next_us = now_us + EVERY_US;
        self.frame += 1;
        let picture = simulation.floor_frame(&self.sensor, self.frame);
        let pose = shared.pose.get().unwrap_or_default().pose_in_odometry;
        let now = Stamp::from_micros(now_us);
        shared.floor.publish(self.floor.process(&picture.depth_mm, pose, (now, now)));
        // What it cannot judge stays unknown, and is counted.
        let _ = self.dirt.process(&picture.rgb, &self.floor, pose, (now, now));
        if let Some(folder) = folder {
            let depth = DepthPicture { depth_mm: &picture.depth_mm, size: FloorCameraSensor::DEPTH_SIZE };
            folder.add((now, pose), depth, &picture.rgb)?;
        }
        if self.shown_us.is_none_or(|shown_us| now_us >= shown_us + SHOWN_EVERY_US) {
            self.shown_us = Some(now_us);
            self.picture = Some(ColourPicture { rgb: picture.rgb, size: FloorCameraSensor::COLOUR_SIZE });
        }
        Ok(true)
    }

    /// A picture for people, about once a second; each is given once.
    pub const fn take_picture(&mut self) -> Option<ColourPicture> {
        self.picture.take()
    }

    /// What was seen of the dirt so far, in the odometry frame.
    #[must_use]
    pub fn seen(&self, now_us: u64) -> SeenDirt {
        self.dirt.seen(Stamp::from_micros(now_us))
    }
}
