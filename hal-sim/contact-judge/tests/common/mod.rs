//! A robot of the judge's tests, and how to drive it.
#![allow(dead_code, reason = "every test uses some of it")]

use floorguard_contact_judge::{
    BodyPart, Brakes, ContactJudge, Job, Limb, LimbName, Moment, Person, Report, RobotMotion, RobotPose,
    Sensor, SensorView, Setup, Solid, Surface, Thing, ThingKind,
};

/// From moment to moment, seconds.
pub const STEP_S: f32 = 0.01;

/// 1.4 m long, 0.8 m wide, 0.75 m high, with a mast up to 0.88 m.
pub fn body() -> Vec<BodyPart> {
    let part = |name: &str, outline_m: [[f32; 2]; 4], height_m| BodyPart {
        name: name.to_owned(),
        outline_m: outline_m.to_vec(),
        height_m,
    };
    vec![
        part("body", [[-0.45, -0.4], [0.95, -0.4], [0.95, 0.4], [-0.45, 0.4]], [0.02, 0.75]),
        part("mast", [[0.45, -0.05], [0.55, -0.05], [0.55, 0.05], [0.45, 0.05]], [0.75, 0.88]),
    ]
}

/// A scanner in front at 0.15 m, a lidar at 0.8 m.
pub fn sensors() -> Vec<Sensor> {
    let scanner = Sensor {
        name: "scanner".into(),
        at_m: [0.9, 0.0, 0.15],
        yaw_rad: 0.0,
        view: SensorView::Plane { half_angle_rad: 135.0_f32.to_radians(), step_rad: 0.5_f32.to_radians() },
        range_m: [0.0, 29.9],
        delay_s: 0.22,
        above_floor_m: 0.0,
        sees_holes: false,
        beams_min: 2,
    };
    let elevations_rad = (0..16_u8).map(|ring| (f32::from(ring) * 2.0 - 15.0).to_radians()).collect();
    let lidar = Sensor {
        name: "lidar".into(),
        at_m: [0.5, 0.0, 0.8],
        view: SensorView::Rings { elevations_rad, step_rad: 0.4_f32.to_radians() },
        range_m: [0.45, 100.0],
        above_floor_m: 0.1,
        ..scanner.clone()
    };
    vec![scanner, lidar]
}

pub fn setup(things: Vec<Thing>) -> Setup {
    Setup {
        body: body(),
        wheels_m: vec![[0.8, 0.0], [0.0, 0.3], [0.0, -0.3]],
        bumpers: Vec::new(),
        mass_kg: 300.0,
        brakes: Brakes { response_s: 0.15, deceleration_mps2: 0.8, wheel_m: [0.8, 0.0] },
        sensors: sensors(),
        things,
        job: Job::None,
    }
}

pub fn block(name: &str, at_m: [f32; 2], size_m: [f32; 2], z_m: [f32; 2]) -> Thing {
    Thing {
        name: name.into(),
        kind: ThingKind::Solid,
        solid: Solid::Box {
            centre_m: [at_m[0], at_m[1], (z_m[0] + z_m[1]) / 2.0],
            half_m: [size_m[0] / 2.0, size_m[1] / 2.0, (z_m[1] - z_m[0]) / 2.0],
            yaw_rad: 0.0,
            slope_rad: 0.0,
        },
        surface: Surface::Opaque,
        from_s: 0.0,
    }
}

/// Somebody who stands: a leg at the place, a torso over it.
pub fn person(at_m: [f32; 2], velocity_mps: [f32; 2]) -> Person {
    let rod = |z_m: [f32; 2], radius_m| Solid::Capsule {
        from_m: [at_m[0], at_m[1], z_m[0] + radius_m],
        to_m: [at_m[0], at_m[1], z_m[1] - radius_m],
        radius_m,
    };
    let limbs = vec![
        Limb { name: LimbName::LowerLeg, solid: rod([0.0, 0.8], 0.07) },
        Limb { name: LimbName::Torso, solid: rod([0.7, 1.5], 0.16) },
    ];
    Person { id: 1, kind: "adult", velocity_mps, limbs }
}

/// Drives a robot from the origin: `motion` of the time, `people` of the time.
pub fn drive(
    setup: Setup,
    seconds: f32,
    motion: impl Fn(f32) -> RobotMotion,
    people: impl Fn(f32) -> Vec<Person>,
) -> Report {
    let mut judge = ContactJudge::new(setup).expect("a body");
    let mut pose = RobotPose::default();
    for step in 0..(seconds / STEP_S) as u32 {
        let at_s = step as f32 * STEP_S;
        let now = motion(at_s);
        let people = people(at_s);
        judge.observe(&Moment { at_s: f64::from(at_s), pose, motion: now, people: &people });
        pose = pose.after(now, STEP_S);
    }
    judge.report(Some(0.0), None)
}

pub fn straight(forward_mps: f32) -> impl Fn(f32) -> RobotMotion {
    move |_| RobotMotion { forward_mps, turn_radps: 0.0 }
}

pub fn no_people(_: f32) -> Vec<Person> {
    Vec::new()
}
