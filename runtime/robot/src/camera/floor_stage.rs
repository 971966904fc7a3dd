//! From a depth picture to what the rings hear of it: floor, objects on it, and whether it is known.

use floorguard_guard::{FloorLimits, FloorObstacle, FloorSight};
use floorguard_perception::floor::dirt::FloorView;
use floorguard_perception::floor::{
    ConfirmedObject, FloorModel, FloorParameters, ObjectFinder, ObjectMemory, PixelClass, Plane,
};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{DepthImage, ImageSize, PinholeCamera};
use floorguard_types::time::{Age, Stamp};

use floorguard_configuration::CameraConfiguration;

/// The search for the floor is seeded.
const SEED: u64 = 1;
/// Beside the robot, metres.
const SIDE_MARGIN_M: f32 = 0.05;
/// A frame takes this long from the light to here, seconds.
const FRAME_S: f32 = 0.1;

/// An object this near to the edge of the picture is about to leave it, metres.
const NEAR_EDGE_M: f32 = 0.15;
/// An object this far behind the front edge is under the robot, where nobody can help any more, metres.
const PASSED_M: f32 = 0.2;
/// Two observations within this are of one object, metres.
const SAME_M: f32 = 0.1;
/// What was not seen for this long may have been taken away, microseconds.
const HIDDEN_US: u64 = 60_000_000;

/// From the camera's foot point to where the picture's lower edge meets the floor, metres; 0 where it shows the foot.
fn nearest_m(camera: &CameraConfiguration) -> f32 {
    let [_, focal_px] = camera.camera.focal_px();
    let [_, middle_px] = camera.camera.centre_px();
    let down_rad = camera.mounting.pitch_rad + ((camera.size.height as f32 - middle_px) / focal_px).atan();
    (camera.mounting.position.z_m / down_rad.tan()).max(0.0)
}

/// The memory of one camera.
pub struct FloorStage {
    size: ImageSize,
    model: FloorModel,
    finder: Box<ObjectFinder>,
    seen: ObjectMemory,
    classes: Vec<PixelClass>,
    camera_in_robot: Pose2,
    limits: FloorLimits,
    plane: Option<Plane>,
    why_blind: Option<String>,
    /// Objects that the robot has come so near to that they left the picture, in the odometry frame, and when they
    /// did.
    hidden: Vec<(Point2, FloorObstacle, Stamp)>,
    /// Nearer than this before the robot's origin nothing is in the picture, metres.
    nearest_m: f32,
}

impl FloorStage {
    /// For a camera on a robot; `None` for a mounting that makes no plane.
    #[must_use]
    pub fn new(robot: &RobotConfiguration, camera: &CameraConfiguration) -> Option<Self> {
        let mounting = &camera.mounting;
        let parameters = FloorParameters::mounted(camera.camera, mounting.position.z_m, mounting.pitch_rad)?;
        let corners = robot.geometry.footprint.iter();
        let (front_m, half_width_m) = corners.fold((f32::MIN, 0.0_f32), |(front, side), corner| {
            (front.max(corner.x_m), side.max(corner.y_m.abs()))
        });
        Some(Self {
            size: camera.size,
            model: FloorModel::new(parameters, SEED),
            finder: Box::default(),
            seen: ObjectMemory::default(),
            classes: vec![PixelClass::Unknown; camera.size.width * camera.size.height],
            camera_in_robot: Pose2::new(mounting.position.x_m, mounting.position.y_m, mounting.yaw_rad),
            limits: FloorLimits {
                half_width_m: half_width_m + SIDE_MARGIN_M,
                front_m,
                braking_mps2: robot.limits.braking_mps2,
                response_s: robot.limits.response_s + FRAME_S,
                unknown_speed_mps: robot.thresholds.warning_speed_mps,
            },
            plane: None,
            why_blind: None,
            hidden: Vec::new(),
            nearest_m: mounting.position.x_m + nearest_m(camera) + NEAR_EDGE_M,
        })
    }

    /// The floor of the newest picture; `None` if it showed none.
    #[must_use]
    pub const fn plane(&self) -> Option<&Plane> {
        self.plane.as_ref()
    }

    /// Why the newest picture showed no floor; `None` if it did.
    #[must_use]
    pub fn why_blind(&self) -> Option<&str> {
        self.why_blind.as_deref()
    }

    /// No picture came, or none that is one: nothing is known.
    pub fn lost(&mut self, now: Stamp) -> FloorSight {
        self.plane = None;
        self.blind(now)
    }

    /// What is reported while no picture is usable.
    #[must_use]
    pub fn blind(&self, stamp: Stamp) -> FloorSight {
        FloorSight { stamp, limits: self.limits, ..FloorSight::default() }
    }

    /// Processes a picture; the robot's pose is the odometry's.
    #[must_use]
    pub fn process(
        &mut self,
        depth_mm: &[u16],
        robot_in_odom: Pose2,
        (stamp, now): (Stamp, Stamp),
    ) -> FloorSight {
        self.plane = None;
        let mut sight = self.blind(stamp);
        let image = match DepthImage::new(stamp, self.size, depth_mm) {
            Ok(image) => image,
            Err(problem) => return self.blinded(problem, sight),
        };
        let estimate = self.model.update(&image, now);
        let parameters = *self.model.parameters();
        let found = match self.finder.find(&image, (&parameters, &estimate), &mut self.classes) {
            Ok(found) => found,
            Err(problem) => return self.blinded(problem, sight),
        };
        self.why_blind = estimate.fault.map(|fault| fault.to_string());
        // Without a floor in this very picture its heights mean nothing.
        sight.is_known = estimate.is_known && estimate.fault.is_none();
        self.plane = sight.is_known.then_some(estimate.plane);
        if sight.is_known {
            let camera_in_odom = robot_in_odom.compose(self.camera_in_robot);
            for obstacle in self.seen.update(&found, camera_in_odom).iter().map(|seen| self.obstacle(seen)) {
                // The list is sorted by distance: what does not fit is farther away.
                let _ = sight.obstacles.push(obstacle);
            }
        }
        self.recall(&mut sight, robot_in_odom);
        sight
    }

    fn blinded(&mut self, why: impl std::fmt::Display, sight: FloorSight) -> FloorSight {
        self.why_blind = Some(why.to_string());
        sight
    }

    /// What lies between the robot and the edge of the picture is still there, though no picture shows it.
    fn recall(&mut self, sight: &mut FloorSight, robot_in_odom: Pose2) {
        let (to_robot, seen) = (robot_in_odom.inverse(), sight.obstacles.len());
        let (front_m, nearest_m, now) = (self.limits.front_m, self.nearest_m, sight.stamp);
        self.hidden.retain(|(place, obstacle, seen)| {
            let ahead_m = to_robot.transform(*place).x_m + obstacle.half_width_m;
            let is_recent = matches!(seen.age(now), Age::Past(age_us) if age_us <= HIDDEN_US);
            is_recent && ahead_m > front_m - PASSED_M && ahead_m < nearest_m + 2.0 * NEAR_EDGE_M
        });
        for (place, obstacle, _) in &self.hidden {
            let position = to_robot.transform(*place);
            let is_seen = sight.obstacles.iter().any(|other| other.position.distance(position) < SAME_M);
            if !is_seen && position.x_m < nearest_m {
                let _ = sight.obstacles.push(FloorObstacle { position, ..*obstacle });
            }
        }
        // Those at the edge of the picture are the next to leave it.
        for obstacle in sight
            .obstacles
            .iter()
            .take(seen)
            .filter(|obstacle| obstacle.position.x_m < nearest_m + NEAR_EDGE_M)
        {
            let place = robot_in_odom.transform(obstacle.position);
            self.hidden.retain(|(other, ..)| other.distance(place) >= SAME_M);
            self.hidden.push((place, *obstacle, now));
        }
    }

    /// How the camera looked at the floor in the last picture; `None` where that was unknown.
    #[must_use]
    pub fn view(&self, camera: PinholeCamera, robot_in_map: Pose2) -> Option<FloorView> {
        let camera_in_robot = self.camera_in_robot;
        self.plane.map(|plane| FloorView { camera, plane, robot_in_map, camera_in_robot })
    }

    /// Of each pixel of the picture that was examined last, whether it shows free floor.
    pub fn is_floor(&self) -> impl Iterator<Item = bool> {
        self.classes.iter().map(|class| *class == PixelClass::Floor)
    }

    /// Columns and rows of the depth picture.
    #[must_use]
    pub const fn size(&self) -> ImageSize {
        self.size
    }

    fn obstacle(&self, seen: &ConfirmedObject) -> FloorObstacle {
        let ([left, near], [right, _]) = (seen.object.low_m, seen.object.high_m);
        FloorObstacle {
            position: self.camera_in_robot.transform(Point2::new(near, -0.5 * (left + right))),
            half_width_m: 0.5 * (right - left),
            height_m: seen.object.height_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_configuration::{CameraSource, EXAMPLE, parse};
    use floorguard_guard::with_floor;

    const SIZE: ImageSize = ImageSize { width: 160, height: 120 };
    const PITCH_RAD: f32 = 0.8;
    const HEIGHT_M: f32 = 0.72;

    fn stage() -> FloorStage {
        let configuration = parse("robot.toml", EXAMPLE).expect("the example is right");
        let mut mounting = configuration.robot.lidar.mounting;
        (mounting.position.x_m, mounting.position.z_m, mounting.pitch_rad) = (0.9, HEIGHT_M, PITCH_RAD);
        let camera = CameraConfiguration {
            source: CameraSource::Devices { depth: "/dev/video0".into(), colour: None },
            size: SIZE,
            camera: PinholeCamera::new([131.0, 131.0], [79.5, 59.5]).expect("a camera"),
            mounting,
        };
        FloorStage::new(&configuration.robot, &camera).expect("above the floor")
    }

    /// A level floor with a block of a height, 12 cm wide, from `ahead_m` before the camera on.
    fn picture(frame: u64, block: Option<(f32, f32)>) -> Vec<u16> {
        let camera = PinholeCamera::new([131.0, 131.0], [79.5, 59.5]).expect("a camera");
        let plane = Plane::of_mounting(HEIGHT_M, PITCH_RAD).expect("a plane");
        let [right, along] = plane.axes();
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let pixel = |index: usize| {
            let ray = camera.ray((index % SIZE.width) as f32, (index / SIZE.width) as f32);
            let down = -dot(plane.normal, ray);
            if down < 0.05 {
                return 0;
            }
            let mut z = HEIGHT_M / down;
            if let Some((ahead_m, height_m)) = block {
                let top = (HEIGHT_M - height_m) / down;
                let (x, y) = (dot(right, ray) * top, dot(along, ray) * top);
                if x.abs() < 0.06 && (ahead_m..ahead_m + 0.12).contains(&y) {
                    z = top;
                }
            }
            // A millimetre to and fro, as living cameras have it.
            (1_000.0 * z) as u16 + ((index as u64 * 7 + frame * 13) % 3) as u16
        };
        (0..SIZE.width * SIZE.height).map(pixel).collect()
    }

    fn limit(stage: &mut FloorStage, frames: &[Vec<u16>]) -> (FloorSight, Option<f32>) {
        let mut sight = FloorSight::default();
        for (frame, depth_mm) in (1_u64..).zip(frames) {
            let at = Stamp::from_micros(33_333 * frame);
            sight = stage.process(depth_mm, Pose2::default(), (at, at));
        }
        let limit = with_floor(Default::default(), Some(&sight), sight.stamp).speed_limit_mps;
        (sight, limit)
    }

    #[test]
    fn obstacle_ahead_slows_free_floor_does_not() {
        let free: Vec<Vec<u16>> = (0..3).map(|frame| picture(frame, None)).collect();
        let (sight, unlimited) = limit(&mut stage(), &free);
        assert!(sight.is_known && sight.obstacles.is_empty(), "{sight:?}");
        assert_eq!(unlimited, None);
        let blocked: Vec<Vec<u16>> = (0..3).map(|frame| picture(frame, Some((0.7, 0.05)))).collect();
        let (sight, slow) = limit(&mut stage(), &blocked);
        let obstacle = sight.obstacles.first().expect("it is seen");
        assert!(
            (obstacle.position.x_m - 1.6).abs() < 0.06 && obstacle.position.y_m.abs() < 0.03,
            "{obstacle:?}"
        );
        assert!((obstacle.height_m - 0.05).abs() < 0.015 && obstacle.half_width_m < 0.1, "{obstacle:?}");
        assert!(slow.is_some_and(|speed| (0.3..0.9).contains(&speed)), "{slow:?}");
    }

    /// Frozen, dark and cut pictures are unknown floor.
    #[test]
    fn bad_pictures_are_unknown_floor() {
        let frozen = vec![picture(0, None); 3];
        let dark = vec![vec![0; SIZE.width * SIZE.height]; 3];
        let cut = vec![vec![700; 99]; 3];
        for (name, frames) in [("frozen", frozen), ("dark", dark), ("cut", cut)] {
            let (sight, slow) = limit(&mut stage(), &frames);
            assert!(!sight.is_known, "{name}");
            assert_eq!(slow, Some(0.3), "{name}");
        }
    }

    /// With the stream goes what was known of the floor: nothing is judged by a plane of earlier.
    #[test]
    fn a_lost_stream_takes_the_floor_with_it() {
        let mut stage = stage();
        let free: Vec<Vec<u16>> = (0..3).map(|frame| picture(frame, None)).collect();
        assert!(limit(&mut stage, &free).0.is_known && stage.plane().is_some());
        assert!(!stage.lost(Stamp::from_micros(200_000)).is_known && stage.plane().is_none());
    }
}
