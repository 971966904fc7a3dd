//! The dirt of a run: the brush goes over it with the robot, and the sensor hears what it picks up.

use floorguard_types::geometry::Pose2;
use floorguard_types::random::Pcg32;

use crate::can::CanFrame;
use crate::dirt::{DirtSensor, DirtyFloor, raster_of};
use crate::robot::{BrushDeck, RobotParameters};
use crate::scenario::Scenario;
use crate::scene::Scene;

/// Floor, brush and sensor.
#[derive(Clone, Debug)]
pub struct DirtyWorld {
    floor: DirtyFloor,
    brush: BrushDeck,
    pickup: f32,
    sensor: DirtSensor,
    before: Pose2,
    random: Pcg32,
}

impl DirtyWorld {
    /// The dirt of a scenario; `None` where it has none.
    pub fn new((scenario, scene): (&Scenario, &Scene), robot: &RobotParameters, seed: u64) -> Option<Self> {
        let (raster, expected) = raster_of(&scenario.dirt_patches(scene, seed))?;
        let mut random = Pcg32::new(seed, 63);
        Some(Self {
            floor: DirtyFloor::draw(raster, &expected, &mut random),
            brush: robot.brush,
            pickup: scenario.dirt.as_ref()?.pickup.clamp(0.0, 1.0),
            sensor: DirtSensor::new(robot.nodes.dirt_sensor, seed),
            before: scenario.start_pose(),
            random,
        })
    }

    /// The robot has moved to a pose within the last `lasts_us`; gives the sensor's message when it is due.
    pub fn step(&mut self, pose: Pose2, (now_us, lasts_us): (u64, u64)) -> Option<CanFrame> {
        let pass = self.brush.pass(self.before, pose);
        self.before = pose;
        let now_s = now_us as f32 * 1.0e-6;
        let units = self.floor.sweep(&pass, now_s, (self.pickup, &mut self.random));
        self.sensor.hear(units, lasts_us as f32 * 1.0e-6);
        self.sensor.tick(now_us)
    }

    /// What lies there.
    pub const fn floor(&self) -> &DirtyFloor {
        &self.floor
    }
}
