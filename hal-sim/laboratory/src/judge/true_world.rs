//! From the simulator's true state to the plain numbers that the judge of contacts takes.

use floorguard_contact_judge as judge;
use floorguard_sim::people::{BodyPart, Limb, Person, body_parts, limbs};
use floorguard_sim::robot::{
    BodyPrism, BridgedScans, HokuyoModel, LidarDevice, RobotBody, RobotParameters, RplidarModel,
    ScannerDevice, SensorMount, SickModel,
};
use floorguard_sim::scene::{DropTruth, Material, PartShape, PartTruth};
use floorguard_sim::sensors::{FloorCameraMounting, FloorCameraSensor};
use floorguard_sim::simulation::Simulation;
use floorguard_types::sensing::ImageSize;

use crate::plan::Plan;

/// From the measurement of a scanner or a lidar to the order to brake, seconds: what the safety manual budgets.
const DELAY_S: f32 = 0.22;
/// The same for the floor camera, which takes five pictures a second and thinks about each, seconds.
const CAMERA_DELAY_S: f32 = 0.5;
/// The same for the floor switches, seconds.
const SWITCH_DELAY_S: f32 = 0.05;
/// So high a floor switch is mounted, metres.
const SWITCH_M: f32 = 0.1;
/// Returns of a lidar and points of a depth camera this low above the floor may be the floor, metres.
const FLOOR_M: [f32; 2] = [0.10, 0.03];

/// A lidar that hangs so much lower than the robot's file says measures the floor as high as a low object, which a robot must not drive
/// over, metres. It excuses a job, and no contact.
const LOW_LIDAR_M: f32 = 0.05;

/// Everything that the judge knows before a run.
#[must_use]
pub fn setup(plan: &Plan, simulation: &Simulation) -> judge::Setup {
    let parameters = simulation.parameters();
    let prism = |prism: &BodyPrism| judge::BodyPart {
        name: prism.name.to_owned(),
        outline_m: prism.outline_m.clone(),
        height_m: prism.height_m,
    };
    let wheels_m: Vec<[f32; 2]> =
        RobotBody::wheels_m(parameters).iter().map(|place| [place.x_m, place.y_m]).collect();
    // The front wheel, or one of several that brake.
    let wheel_m = wheels_m.first().copied().unwrap_or_default();
    let scene = simulation.scene();
    judge::Setup {
        body: parameters.body.iter().map(prism).collect(),
        wheels_m,
        bumpers: parameters.bumpers.iter().filter(|_| plan.scenario.bumpers).map(prism).collect(),
        mass_kg: parameters.mass_kg,
        brakes: judge::Brakes {
            response_s: plan.robot.limits.response_s,
            deceleration_mps2: plan.robot.limits.braking_mps2,
            wheel_m,
        },
        sensors: sensors(simulation.nominal(), plan.has_camera),
        things: scene.truth().iter().map(thing).chain(scene.drops().iter().map(hole)).collect(),
        job: job(plan),
    }
}

fn job(plan: &Plan) -> judge::Job {
    let is_driven = plan.command.is_some() || plan.navigation.is_some();
    if plan.mission.is_some() || is_driven || !plan.scenario.manoeuvre.is_empty() {
        return judge::Job::Mission;
    }
    match plan.scenario.route.waypoints_m.as_slice() {
        [] => judge::Job::None,
        places => judge::Job::Route(places.to_vec()),
    }
}

/// A part of the scene as it is.
pub fn thing(part: &PartTruth) -> judge::Thing {
    let [x, y, z] = part.centre_m;
    let solid = match part.shape {
        PartShape::Box(half_m) => judge::Solid::Box {
            centre_m: part.centre_m,
            half_m,
            yaw_rad: part.yaw_rad,
            slope_rad: part.slope_rad,
        },
        PartShape::Post(radius_m, height_m) => {
            judge::Solid::Cylinder { foot_m: [x, y, z - height_m / 2.0], radius_m, height_m }
        }
    };
    let surface = match part.material {
        Material::Glass => judge::Surface::Glass,
        Material::Mirror => judge::Surface::Mirror,
        _ => judge::Surface::Opaque,
    };
    judge::Thing { name: part.name.clone(), kind: judge::ThingKind::Solid, solid, surface, from_s: 0.0 }
}

fn hole(drop: &DropTruth) -> judge::Thing {
    let [x, y] = drop.centre_m;
    judge::Thing {
        name: "hole in the floor".to_owned(),
        kind: judge::ThingKind::Drop,
        solid: judge::Solid::Box {
            centre_m: [x, y, -drop.depth_m / 2.0],
            half_m: [drop.size_m[0] / 2.0, drop.size_m[1] / 2.0, drop.depth_m / 2.0],
            yaw_rad: drop.yaw_rad,
            slope_rad: 0.0,
        },
        surface: judge::Surface::Opaque,
        from_s: 0.0,
    }
}

/// A second scanner, an S300, that is as fast as the first one.
fn rear_scanner(mount: SensorMount, first: &judge::Sensor) -> judge::Sensor {
    judge::Sensor {
        name: "rear scanner".to_owned(),
        at_m: [mount.x_m, mount.y_m, mount.z_m],
        yaw_rad: mount.yaw_rad,
        view: judge::SensorView::Plane {
            half_angle_rad: 135.0_f32.to_radians(),
            step_rad: 0.5_f32.to_radians(),
        },
        ..first.clone()
    }
}

/// Elevations of all beams of a lidar, and the step between its columns: also those that the robot does not look at.
fn beams_of(lidar: LidarDevice) -> (Vec<f32>, f32) {
    let down = |rings: u8, step_deg: f32| {
        (0..rings).map(|ring| (15.0 - f32::from(ring) * step_deg).to_radians()).collect()
    };
    match lidar {
        LidarDevice::Vlp16 | LidarDevice::PandarXt16 => (down(16, 2.0), 0.4),
        LidarDevice::PandarXt32 => (down(32, 1.0), 0.4),
        LidarDevice::Bridged(elevations) => {
            (elevations.iter().map(|mdeg| (*mdeg as f32 * 1.0e-3).to_radians()).collect(), 360.0 / 1_024.0)
        }
        // Its beams wander: half a degree apart they have been everywhere within a fifth of a second.
        LidarDevice::LivoxMid360 { hangs } => {
            let side = if hangs { -1.0 } else { 1.0 };
            let steps = (0..=118_u8).map(|step| (side * (f32::from(step) * 0.5 - 7.0)).to_radians());
            (steps.collect(), 0.9)
        }
        LidarDevice::Ouster(device) => {
            let elevations = device.altitude_mdeg.iter().map(|mdeg| (*mdeg as f32 * 1.0e-3).to_radians());
            (elevations.collect(), 360.0 / f32::from(device.columns_per_turn))
        }
    }
}

/// Half of the sector of a scanner, degrees, and its beams.
pub(super) const fn plane_of(scanner: ScannerDevice) -> (f32, u16) {
    match scanner {
        ScannerDevice::S300 => (135.0, 541),
        ScannerDevice::MicroScan3(beams) => (137.5, beams),
        ScannerDevice::Hokuyo(HokuyoModel::Ust) => (135.0, 1_081),
        ScannerDevice::Hokuyo(HokuyoModel::Urg04lx) => (119.5, 680),
        ScannerDevice::Sick(SickModel::Tim5xx) => (135.0, 811),
        ScannerDevice::Sick(SickModel::Lms1xx) => (135.0, 541),
        // All around: the first beam is the last one, too.
        ScannerDevice::Rplidar(RplidarModel::A) => (180.0, 301),
        ScannerDevice::Rplidar(RplidarModel::S) => (180.0, 721),
        ScannerDevice::Bridged(scans) => plane_of_bridged(scans),
    }
}

/// The narrower side counts for both: what only the wider one sees is no excuse.
const fn plane_of_bridged(scans: BridgedScans) -> (f32, u16) {
    let step_deg = scans.step_udeg as f32 * 1.0e-6;
    let first_deg = scans.first_udeg as f32 * 1.0e-6;
    if step_deg * scans.beams as f32 > 359.9 {
        return (180.0, scans.beams + 1);
    }
    let half_deg = (-first_deg).min(first_deg + step_deg * (scans.beams - 1) as f32).max(0.0);
    (half_deg, (2.0 * half_deg / step_deg) as u16 + 1)
}

/// The sensors where the robot's file says that they are: what is misplaced or taken away is no excuse.
fn sensors(parameters: &RobotParameters, has_camera: bool) -> Vec<judge::Sensor> {
    let (scanner, lidar) = (parameters.scanner, parameters.lidar);
    let (half_deg, beams) = plane_of(parameters.scanner_device);
    let step_rad = (2.0 * half_deg / f32::from(beams.max(2) - 1)).to_radians();
    let scanner = judge::Sensor {
        name: "scanner".to_owned(),
        at_m: [scanner.x_m, scanner.y_m, scanner.z_m],
        yaw_rad: scanner.yaw_rad,
        view: judge::SensorView::Plane { half_angle_rad: half_deg.to_radians(), step_rad },
        range_m: [0.0, 29.9],
        delay_s: DELAY_S,
        above_floor_m: 0.0,
        sees_holes: false,
        beams_min: 2,
    };
    let rear_scanner = parameters.rear_scanner.map(|mount| rear_scanner(mount, &scanner));
    let (elevations_rad, step_deg) = beams_of(parameters.lidar_device);
    let lidar = judge::Sensor {
        name: "lidar".to_owned(),
        at_m: [lidar.x_m, lidar.y_m, lidar.z_m],
        yaw_rad: lidar.yaw_rad,
        view: judge::SensorView::Rings { elevations_rad, step_rad: step_deg.to_radians() },
        range_m: [0.45, 100.0],
        above_floor_m: FLOOR_M[0],
        ..scanner.clone()
    };
    let FloorCameraMounting { height_m, forward_m, pitch_rad } = FloorCameraSensor::MOUNTING;
    let ImageSize { width: columns, height: rows } = FloorCameraSensor::DEPTH_SIZE;
    let size = [columns, rows].map(|count| count as u16);
    let camera = judge::Sensor {
        name: "floor camera".to_owned(),
        at_m: [forward_m, 0.0, height_m],
        yaw_rad: 0.0,
        view: judge::SensorView::Camera { pitch_rad, size, focal_px: FloorCameraSensor::FOCAL_PX },
        range_m: [0.4, 8.0],
        delay_s: CAMERA_DELAY_S,
        above_floor_m: FLOOR_M[1],
        sees_holes: true,
        ..scanner.clone()
    };
    let switches = parameters.floor_switches_m.iter().flatten().map(|[x, y]| judge::Sensor {
        name: "floor switch".to_owned(),
        at_m: [*x, *y, SWITCH_M],
        view: judge::SensorView::Down,
        range_m: [0.0, 0.5],
        delay_s: SWITCH_DELAY_S,
        // It feels that there is a floor, be it higher or not.
        above_floor_m: SWITCH_M,
        sees_holes: true,
        beams_min: 1,
        ..scanner.clone()
    });
    let switches: Vec<judge::Sensor> = switches.collect();
    let camera = has_camera.then_some(camera);
    [scanner, lidar].into_iter().chain(rear_scanner).chain(camera).chain(switches).collect()
}

/// A person as it is.
#[must_use]
pub fn person(person: &Person) -> judge::Person {
    let parts = body_parts(person);
    let names = limbs(person.kind).iter().map(|limb| limb_name(*limb));
    judge::Person {
        id: person.id,
        kind: person.kind.name(),
        velocity_mps: [person.velocity.x_m, person.velocity.y_m],
        limbs: parts.iter().zip(names).map(|(part, name)| judge::Limb { name, solid: solid(part) }).collect(),
    }
}

const fn limb_name(limb: Limb) -> judge::LimbName {
    match limb {
        Limb::Leg => judge::LimbName::LowerLeg,
        Limb::Torso => judge::LimbName::Torso,
        Limb::Arm => judge::LimbName::Arm,
        Limb::Head => judge::LimbName::Head,
        Limb::Thing => judge::LimbName::Carried,
    }
}

fn solid(part: &BodyPart) -> judge::Solid {
    match part {
        BodyPart::Capsule(capsule) => judge::Solid::Capsule {
            from_m: capsule.segment.a.to_array(),
            to_m: capsule.segment.b.to_array(),
            radius_m: capsule.radius,
        },
        BodyPart::Ball(centre, ball) => {
            judge::Solid::Ball { centre_m: centre.to_array(), radius_m: ball.radius }
        }
        BodyPart::Box(pose, cuboid) => {
            let along = pose.rotation * parry3d::math::Vector::X;
            judge::Solid::Box {
                centre_m: pose.translation.to_array(),
                half_m: cuboid.half_extents.to_array(),
                yaw_rad: libm::atan2f(along.y, along.x),
                slope_rad: 0.0,
            }
        }
    }
}

/// Feeds the judge with every moment of a run.
pub struct TrueContacts {
    judge: judge::ContactJudge,
    /// Parts of the scene that the judge knows.
    known_parts: usize,
    excuse: Option<&'static str>,
}

impl TrueContacts {
    /// Of a run that is about to begin.
    ///
    /// # Errors
    /// The simulated robot's body is none.
    pub fn new(plan: &Plan, simulation: &Simulation) -> Result<Self, judge::BodyError> {
        let is_sound = plan.faults.is_empty() && !plan.scenario.has_broken_devices();
        let is_low = plan.scenario.lidar_misplaced.is_some_and(|lidar| lidar.z_m < -LOW_LIDAR_M);
        let excuse = match (is_sound || plan.is_corrupted, plan.emergency_stop_us.is_empty()) {
            (false, _) => Some("a fault was put in"),
            (true, false) => Some("the emergency stop was pressed"),
            (true, true) => {
                is_low.then_some("its lidar hangs so low that the floor looks like an object to it")
            }
        };
        let known_parts = simulation.scene().truth().len();
        Ok(Self { judge: judge::ContactJudge::new(setup(plan, simulation))?, known_parts, excuse })
    }

    /// Looks at the last moment played.
    pub fn observe(&mut self, simulation: &Simulation) {
        let (pose, twist) = simulation.robot();
        let at_s = simulation.now_us() as f64 * 1.0e-6;
        // What comes while the world runs is the last in the scene.
        for part in simulation.scene().truth().iter().skip(self.known_parts) {
            self.judge.appear(judge::Thing { from_s: at_s, ..thing(part) });
        }
        self.known_parts = simulation.scene().truth().len();
        let people: Vec<judge::Person> = simulation.people().iter().map(person).collect();
        self.judge.observe(&judge::Moment {
            at_s,
            pose: judge::RobotPose { x_m: pose.x_m, y_m: pose.y_m, heading_rad: pose.heading_rad },
            motion: judge::RobotMotion { forward_mps: twist.linear_mps, turn_radps: twist.angular_radps },
            people: &people,
        });
    }

    /// The robot has stopped for something that it believed in its way.
    pub fn stop(&mut self, at_s: f64) {
        self.judge.stop(at_s);
    }

    /// What the run comes to.
    #[must_use]
    pub fn report(&self, ready_s: Option<f64>) -> judge::Report {
        self.judge.report(ready_s, self.excuse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_sim::people::PersonKind;
    use floorguard_sim::scenario::Scenario;
    use std::f32::consts::FRAC_PI_2;

    /// What the judge takes for a body and an object is what the simulator's beams meet: rays from all sides end
    /// alike.
    #[test]
    fn the_judge_is_given_what_the_simulator_plays() {
        let scenario = Scenario::named("supermarket").unwrap();
        let simulation = Simulation::new(&scenario, 1).unwrap();
        for part in simulation.scene().truth() {
            let given = thing(part);
            assert_eq!(given.name, part.name);
            let judge::Solid::Box { centre_m, .. } = given.solid else { panic!("boxes alone") };
            assert_eq!(centre_m, part.centre_m);
        }
        for real in simulation.people() {
            let given = person(real);
            assert_eq!(given.limbs.len(), body_parts(real).len());
            for (limb, part) in given.limbs.iter().zip(body_parts(real)) {
                let around = match (&limb.solid, &part) {
                    (judge::Solid::Capsule { from_m, .. }, BodyPart::Capsule(capsule)) => {
                        *from_m == capsule.segment.a.to_array()
                    }
                    (judge::Solid::Ball { centre_m, .. }, BodyPart::Ball(centre, _)) => {
                        *centre_m == centre.to_array()
                    }
                    (judge::Solid::Box { yaw_rad, .. }, BodyPart::Box(..)) => {
                        (yaw_rad - real.heading_rad).rem_euclid(4.0 * FRAC_PI_2) < 1.0e-3
                            || (real.heading_rad - yaw_rad).rem_euclid(4.0 * FRAC_PI_2) < 1.0e-3
                    }
                    _ => false,
                };
                assert!(around, "{:?} {limb:?}", PersonKind::name(real.kind));
            }
        }
    }

    /// A robot that is towed past its guard runs into what came after the start: the judge knows it.
    #[test]
    fn what_comes_later_can_be_touched() {
        let touched = |appears: &str| {
            let piece = format!("{{ kind = \"box\", at_m = [3.0, 0.0], size_m = [0.4, 0.4]{appears} }}");
            let text = format!("title = \"later\"\n[scene]\nfurniture = [{piece}]\n");
            let plan = Plan::of("later", Scenario::from_toml(&text).unwrap(), 1, 6_000_000).unwrap();
            let mut simulation = plan.simulation().unwrap();
            let mut judge = TrueContacts::new(&plan, &simulation).unwrap();
            simulation.tow(0.6, 0.0);
            for at_us in (0..6_000_000).step_by(10_000) {
                simulation.advance_to(at_us, &mut |_| {});
                judge.observe(&simulation);
            }
            judge.report(Some(0.0)).counts.drove_into_things
        };
        assert_eq!((touched(""), touched(", appears_s = 0.5"), touched(", appears_s = 60.0")), (1, 1, 0));
    }
}
