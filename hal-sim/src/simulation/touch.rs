//! What the robot's switches feel: bumpers that run into something, and the floor that ends.

use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query::intersection_test;
use parry3d::shape::{Ball, Capsule, Cuboid, Shape};

use floorguard_types::geometry::{Point2, Pose2};

use crate::can::SafetyChannels;
use crate::people::{BodyPart, Person, body_parts};
use crate::robot::{BodyPrism, RobotParameters};
use crate::scenario::Scenario;
use crate::scene::Scene;

/// What a bumper has met cannot pass through it: it presses the bumper until it has left the whole body, at the bumper's heights.
fn whole(front: &BodyPrism, rear: &BodyPrism) -> (Vector, Cuboid) {
    let both = BodyPrism {
        outline_m: front.outline_m.iter().chain(&rear.outline_m).copied().collect(),
        ..front.clone()
    };
    strip(&both)
}

/// Nobody farther away presses a bumper, metres.
const NEAR_M: f32 = 2.5;

/// The switches of a robot.
#[derive(Clone, Debug)]
pub(super) struct Touch {
    bumpers: Option<[(Vector, Cuboid); 2]>,
    body: (Vector, Cuboid),
    /// In front and at the rear.
    is_pressed: [bool; 2],
    floor: Option<[[Point2; 2]; 2]>,
}

fn strip(prism: &BodyPrism) -> (Vector, Cuboid) {
    let of = |axis: usize, pick: fn(f32, f32) -> f32, from: f32| {
        prism.outline_m.iter().map(|corner| corner[axis]).fold(from, pick)
    };
    let low = Vector::new(of(0, f32::min, f32::MAX), of(1, f32::min, f32::MAX), prism.height_m[0]);
    let high = Vector::new(of(0, f32::max, f32::MIN), of(1, f32::max, f32::MIN), prism.height_m[1]);
    ((low + high) / 2.0, Cuboid::new((high - low) / 2.0))
}

impl Touch {
    /// Of a robot in a scenario: its bumpers feel something or do not, and there are holes in the floor or none.
    pub(super) fn new(parameters: &RobotParameters, scenario: &Scenario, scene: &Scene) -> Self {
        let [front, rear] = &parameters.bumpers;
        let points = parameters.floor_switches_m.map(|end| end.map(|[x, y]| Point2::new(x, y)));
        Self {
            bumpers: (scenario.bumpers && !scenario.deaf_bumpers).then(|| [strip(front), strip(rear)]),
            body: whole(front, rear),
            is_pressed: [false; 2],
            floor: (!scene.drops().is_empty() && !scenario.without_floor_switches).then_some(points),
        }
    }

    /// Sets the channels of what is felt at a pose; leaves those of what cannot be felt.
    pub(super) fn feel(
        &mut self,
        robot: Pose2,
        (scene, people): (&Scene, &[Person]),
        channels: &mut SafetyChannels,
    ) {
        if let Some(bumpers) = &self.bumpers {
            for (bumper, pressed) in bumpers.iter().zip(&mut self.is_pressed) {
                let met = if *pressed { &self.body } else { bumper };
                *pressed = is_pressed(met, robot, scene, people);
            }
            let [front, rear] = self.is_pressed;
            (channels.bumper_front, channels.bumper_rear) = ([!front; 2], [!rear; 2]);
        }
        if let Some(switches) = &self.floor {
            channels.floor =
                switches.map(|end| end.iter().all(|point| scene.has_floor_at(robot.transform(*point))));
        }
    }
}

fn is_pressed((middle, strip): &(Vector, Cuboid), robot: Pose2, scene: &Scene, people: &[Person]) -> bool {
    let turn = Rotation::from_rotation_z(robot.heading_rad);
    let at = robot.transform(Point2::new(middle.x, middle.y));
    let pose = Pose::from_parts(Vector::new(at.x_m, at.y_m, middle.z), turn);
    let presses = |part: &BodyPart| {
        let met = |at: &Pose, shape: &dyn Shape| {
            intersection_test(at, shape, &pose, strip).is_ok_and(|met| met.intersecting)
        };
        match part {
            BodyPart::Capsule(capsule) => met(&Pose::identity(), capsule as &Capsule),
            BodyPart::Ball(centre, ball) => met(&Pose::from_translation(*centre), ball as &Ball),
            BodyPart::Box(at, cuboid) => met(at, cuboid),
        }
    };
    let near = people.iter().filter(|person| person.position.distance(at) < NEAR_M);
    scene.touches(&pose, strip) || near.flat_map(body_parts).any(|part| presses(&part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{DropTruth, Material, SceneBuilder};

    fn felt(scene: &Scene, robot: Pose2) -> SafetyChannels {
        let mut channels = SafetyChannels::default();
        let scenario = Scenario { bumpers: true, ..Scenario::default() };
        Touch::new(&RobotParameters::default(), &scenario, scene).feel(robot, (scene, &[]), &mut channels);
        channels
    }

    #[test]
    fn bumpers_feel_own_end_and_height() {
        let mut builder = SceneBuilder::default();
        builder.cuboid((2.0, 0.0, 0.0), (0.2, 0.2), (0.0, 0.12), Material::Matte);
        builder.cuboid((4.0, 0.0, 0.0), (0.2, 0.2), (0.0, 0.03), Material::Matte);
        builder.cuboid((6.0, 0.0, 0.0), (0.2, 0.2), (0.5, 0.6), Material::Matte);
        let scene = builder.build();
        let at = |x_m: f32| felt(&scene, Pose2::new(x_m, 0.0, 0.0));
        assert_eq!(at(0.96), SafetyChannels { bumper_front: [false; 2], ..SafetyChannels::default() });
        assert_eq!(at(2.54), SafetyChannels { bumper_rear: [false; 2], ..SafetyChannels::default() });
        assert_eq!(at(0.90), SafetyChannels::default());
        // Too low and too high.
        assert_eq!(at(3.0), SafetyChannels::default());
        assert_eq!(at(5.0), SafetyChannels::default());
    }

    /// A box that the braking robot drives over does not free the bumper that has met it.
    #[test]
    fn met_object_presses_until_it_has_left() {
        let mut builder = SceneBuilder::default();
        builder.cuboid((2.0, 0.0, 0.0), (0.05, 0.2), (0.0, 0.12), Material::Matte);
        let scene = builder.build();
        let scenario = Scenario { bumpers: true, ..Scenario::default() };
        let mut touch = Touch::new(&RobotParameters::default(), &scenario, &scene);
        let mut pressed = |x_m: f32| {
            let mut channels = SafetyChannels::default();
            touch.feel(Pose2::new(x_m, 0.0, 0.0), (&scene, &[]), &mut channels);
            !channels.bumper_front[0]
        };
        assert_eq!([0.9, 1.05, 1.5, 2.3].map(&mut pressed), [false, true, true, true]);
        assert_eq!(
            [2.6, 2.3, 1.5].map(&mut pressed),
            [false; 3],
            "behind the robot, and no front bumper meets it"
        );
    }

    #[test]
    fn the_floor_ends_at_a_hole() {
        let mut builder = SceneBuilder::default();
        builder.hole(DropTruth { centre_m: [3.0, 0.0], size_m: [2.0, 4.0], yaw_rad: 0.0, depth_m: 1.0 });
        let scene = builder.build();
        assert_eq!(felt(&scene, Pose2::new(1.05, 0.0, 0.0)).floor, [true, true]);
        assert_eq!(felt(&scene, Pose2::new(1.08, 0.0, 0.0)).floor, [false, true]);
        // A beam goes down to the lower floor.
        let direction = Vector::new(1.0, 0.0, -0.5).normalize();
        let hit = scene.cast(Vector::new(0.5, 0.0, 1.0), direction, 50.0).unwrap();
        assert!((hit.range_m - 4.0 * 1.25_f32.sqrt()).abs() < 1e-3, "{hit:?}");
    }
}
