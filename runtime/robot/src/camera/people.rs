//! People in the pictures of the camera, and where it could have seen somebody: one more source for the list of people.
//!
//! A picture without a known floor says nothing about anybody. Where something stands before a place, or nothing came back,
//! nobody is missed there.

use floorguard_perception::floor::Plane;
use floorguard_perception::people::{Appearance, Detection, PeopleSensor, PeopleView};
use floorguard_perception::rgbd_people::{RgbdDetection, RgbdParameters, RgbdPeopleFinder};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, DepthImage, ImageSize, PinholeCamera, Scan};
use floorguard_types::time::Stamp;

use floorguard_configuration::CameraConfiguration;

/// An occluder begins at this height and ends at that of a head, metres.
const HIDES_M: [f32; 2] = [0.1, 1.8];
/// Bearings on which the picture is laid for that, radians: no camera sees more than 120°.
const BEAMS: u16 = 241;
const STEP_RAD: f32 = 0.5 * core::f32::consts::PI / 180.0;
/// Stride over the picture's columns and rows for the visibility of people.
const EVERY: usize = 2;
/// Legs are recognised up to here, metres, if the picture shows them so high (book, Depth people: Leg band).
const LEGS_MAX_M: f32 = 4.0;
const LEGS_TOP_M: f32 = 0.4;

/// The memory of one camera.
pub struct DepthPeopleStage {
    size: ImageSize,
    camera: PinholeCamera,
    camera_in_robot: Pose2,
    recognised_m: f32,
    finder: Box<RgbdPeopleFinder>,
    /// People left out because the list was full, since the start.
    pub dropped: u32,
}

impl DepthPeopleStage {
    /// For a camera on a robot.
    #[must_use]
    pub fn new(camera: &CameraConfiguration) -> Self {
        let mounting = &camera.mounting;
        let [_, top_ray, forward] = camera.camera.ray(0.5 * camera.size.width as f32, 0.0);
        let down_rad = mounting.pitch_rad + libm::atan2f(top_ray, forward);
        let shows_m = (mounting.position.z_m - LEGS_TOP_M) / libm::tanf(down_rad.max(1.0e-3));
        Self {
            size: camera.size,
            camera: camera.camera,
            camera_in_robot: Pose2::new(mounting.position.x_m, mounting.position.y_m, mounting.yaw_rad),
            recognised_m: shows_m.clamp(0.0, LEGS_MAX_M),
            finder: Box::new(RgbdPeopleFinder::new(RgbdParameters::new(camera.camera))),
            dropped: 0,
        }
    }

    /// Processes a picture above a floor that this very picture showed; the robot's pose is the odometry's. `None` for
    /// a picture of another size.
    #[must_use]
    pub fn process(
        &mut self,
        depth_mm: &[u16],
        (plane, robot_in_odom): (&Plane, Pose2),
        stamp: Stamp,
    ) -> Option<PeopleView> {
        let image = DepthImage::new(stamp, self.size, depth_mm).ok()?;
        let found = self.finder.find_people((&image, None), plane, self.camera_in_robot).ok()?;
        let mut view = PeopleView::new(PeopleSensor::DepthCamera);
        view.stamp = stamp;
        for person in &found.people {
            if !view.add(detection(person, robot_in_odom)) {
                self.dropped = self.dropped.saturating_add(1);
            }
        }
        let scan = self.in_view(&image, plane);
        view.open.measure(&scan, robot_in_odom.compose(self.camera_in_robot), self.recognised_m);
        Some(view)
    }

    /// The picture as a scan: the nearest occluder by bearing.
    fn in_view(&self, image: &DepthImage<'_>, plane: &Plane) -> Scan {
        let [right, ahead] = plane.axes();
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let first_angle_rad = -0.5 * STEP_RAD * f32::from(BEAMS - 1);
        let mut beams = [BeamReturn::Unknown; BEAMS as usize];
        for (row, depths) in image.rows().enumerate().step_by(EVERY) {
            for (column, depth) in depths.iter().enumerate().step_by(EVERY).filter(|(_, depth)| **depth > 0) {
                let point = self
                    .camera
                    .ray(column as f32, row as f32)
                    .map(|along| along * f32::from(*depth) * 1.0e-3);
                let place = Point2::new(dot(ahead, point), -dot(right, point));
                let bearing_rad = libm::atan2f(place.y_m, place.x_m);
                let index = (bearing_rad - first_angle_rad) / STEP_RAD + 0.5;
                let Some(beam) = beams.get_mut(index as usize).filter(|_| index >= 0.0) else { continue };
                let hides = (HIDES_M[0]..HIDES_M[1]).contains(&plane.height_m(point));
                let range_mm = (place.norm() * 1_000.0) as u16;
                *beam = match (*beam, hides) {
                    (BeamReturn::Hit(nearest_mm), true) => BeamReturn::Hit(nearest_mm.min(range_mm)),
                    (_, true) => BeamReturn::Hit(range_mm),
                    (BeamReturn::Unknown, false) => BeamReturn::Free((LEGS_MAX_M * 1_000.0) as u16),
                    (known, false) => known,
                };
            }
        }
        let mut scan = Scan { stamp: image.stamp(), first_angle_rad, step_rad: STEP_RAD, ..Scan::default() };
        // Fewer beams than the capacity of a scan.
        let _ = scan.beams.extend_from_slice(&beams);
        scan
    }
}

fn detection(person: &RgbdDetection, robot_in_odom: Pose2) -> Detection {
    let [xx, _, yy] = person.covariance_m2;
    Detection {
        position: robot_in_odom.transform(person.position_in_base),
        distance_m: person.distance_m,
        sigma_m: libm::sqrtf(0.5 * (xx + yy)),
        likeness: person.confidence,
        points: 1,
        moving: None,
        appearance: Appearance::UNKNOWN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::{PeopleInbox, Stages, new_perception};
    use crate::camera::FloorStage;
    use floorguard_configuration::{CameraSource, EXAMPLE, parse};
    use floorguard_perception::people::{PeopleOutput, SweepContext};
    use floorguard_runtime::tasks::JudgeMotion as _;
    use floorguard_sim::people::{Build, Person, PersonKind};
    use floorguard_sim::scene::{Material, SceneBuilder};
    use floorguard_sim::sensors::DepthCamera;
    use floorguard_types::geometry::Twist2;
    use floorguard_types::sensing::Sweep;

    /// Looks down by 14° from 0.9 m, at the robot's nose.
    const CAMERA: DepthCamera =
        DepthCamera { height_m: 0.9, pitch_rad: 0.25, forward_m: 0.9, ..DepthCamera::FORWARD_SMALL };

    fn picture(walked_m: f32, shot: u64) -> Vec<u16> {
        let mut builder = SceneBuilder::default();
        builder.wall([7.0, -9.0], [7.0, 9.0], 3.0, Material::Matte);
        builder.wall([3.0, 0.6], [3.0, 2.4], 1.4, Material::Matte);
        let person = Person {
            id: 1,
            kind: PersonKind::Adult,
            build: Build::SAME,
            position: Point2::new(3.2, walked_m - 0.6),
            velocity: Point2::new(0.0, 1.0),
            heading_rad: 1.57,
            gait_rad: 4.0 * walked_m,
            goals: Vec::new(),
            goal: 0,
            speed_mps: 1.0,
            starts_us: 0,
            sees_robot: false,
            walk: None,
        };
        CAMERA.picture(&builder.build(), &[person], Pose2::default(), shot).depth_mm
    }

    /// From pictures to the list of people: the camera's bit, the right place and velocity; nobody is missed behind a
    /// partition, beside the picture or beyond where legs are recognised.
    #[test]
    fn camera_only_person_is_listed() {
        let robot = parse("robot.toml", EXAMPLE).expect("the example is right").robot;
        let mut mounting = robot.lidar.mounting;
        (mounting.position.x_m, mounting.position.y_m, mounting.position.z_m) = (0.9, 0.0, 0.9);
        (mounting.pitch_rad, mounting.yaw_rad) = (0.25, 0.0);
        let camera = CameraConfiguration {
            source: CameraSource::Devices { depth: "/dev/video0".into(), colour: None },
            size: CAMERA.size,
            camera: PinholeCamera::new([CAMERA.focal_px; 2], [79.5, 59.5]).expect("a camera"),
            mounting,
        };
        let mut floor = FloorStage::new(&robot, &camera).expect("above the floor");
        let mut people = DepthPeopleStage::new(&camera);
        let inbox = PeopleInbox::default();
        let mut ring = new_perception(&robot, Stages::AsOnBoard);
        ring.motion.listen_to(inbox.clone());
        let (mut seen, mut newest) = (0, None);
        for shot in 0..10_u64 {
            let stamp = Stamp::from_micros(1_000_000 + shot * 100_000);
            let depth_mm = picture(0.1 * shot as f32, shot);
            let _ = floor.process(&depth_mm, Pose2::default(), (stamp, stamp));
            let view =
                floor.plane().and_then(|plane| people.process(&depth_mm, (plane, Pose2::default()), stamp));
            let view = view.expect("the floor is known");
            seen += view.detections.len();
            newest = Some(view.clone());
            inbox.put(view);
            let context = SweepContext {
                sensor_in_base: ring.sensor_in_base,
                twist: Twist2::ZERO,
                base_in_odom: Pose2::default(),
            };
            let sweep = Sweep { end_stamp: stamp, ..Sweep::EMPTY };
            let PeopleOutput { tracks, .. } = ring.motion.people(&mut ring.people, &sweep, &context);
            if shot == 9 {
                let track =
                    tracks.iter().find(|track| track.sensors(stamp).contains(PeopleSensor::DepthCamera));
                let track = track.unwrap_or_else(|| panic!("{seen} sightings, {tracks:?}"));
                let (place, velocity) = (track.state.position, track.state.velocity);
                assert!(place.distance(Point2::new(3.2, 0.3)) < 0.25, "{place:?}");
                assert!((0.5..1.5).contains(&velocity.y_m) && velocity.x_m.abs() < 0.4, "{velocity:?}");
            }
        }
        let open = newest.expect("ten views").open;
        assert!(open.is_visible(Point2::new(2.6, -0.6)), "free floor in the picture");
        assert!(!open.is_visible(Point2::new(4.0, 1.6)), "behind the partition");
        assert!(!open.is_visible(Point2::new(2.0, 3.0)), "beside the picture");
        assert!(!open.is_visible(Point2::new(6.0, -1.0)), "too far for legs");
    }
}
