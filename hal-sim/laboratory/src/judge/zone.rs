//! The protective zone that applies to the true motion.

use floorguard_runtime::configuration::{DirectionOfTravel, FieldPair, RobotConfiguration};
use floorguard_types::geometry::Point2;

use super::shape::distance_m;
use super::truth::Truth;

/// Below this speed the robot counts as standing, m/s: half a millimetre per tick of 10 ms.
pub const STANDING_MPS: f32 = 0.05;

/// The zones of the configuration.
#[derive(Clone, Debug)]
pub struct TrueZones {
    fields: Vec<FieldPair>,
}

impl TrueZones {
    /// Of a robot.
    #[must_use]
    pub fn new(robot: &RobotConfiguration) -> Self {
        Self { fields: robot.fields.iter().cloned().collect() }
    }

    /// The pair of fields that applies at a speed.
    #[must_use]
    pub fn applying(&self, speed_mps: f32) -> Option<&FieldPair> {
        let direction = if speed_mps < 0.0 { DirectionOfTravel::Reverse } else { DirectionOfTravel::Forward };
        let of_direction = || self.fields.iter().filter(|field| field.direction == direction);
        of_direction()
            .filter(|field| field.speed_max_mps >= speed_mps.abs())
            .min_by(|a, b| a.speed_max_mps.total_cmp(&b.speed_max_mps))
            .or_else(|| of_direction().max_by(|a, b| a.speed_max_mps.total_cmp(&b.speed_max_mps)))
    }

    /// How deep something that the safety scanner can see reaches into an outline, metres; negative: the gap to the
    /// nearest object.
    #[must_use]
    pub fn intrusion_m(outline: &[Point2], truth: &Truth) -> f32 {
        let people = truth.people.iter().flat_map(|person| &person.ground);
        depth_m(outline, truth, people, &truth.obstacles_in_robot)
    }

    /// The same for anything at any height of the robot.
    #[must_use]
    pub fn nearness_m(outline: &[Point2], truth: &Truth) -> f32 {
        let people = truth.people.iter().flat_map(|person| &person.body);
        let raised_m = depth_m(outline, truth, people, &truth.raised_in_robot);
        raised_m.max(Self::intrusion_m(outline, truth))
    }
}

fn depth_m<'a>(
    outline: &[Point2],
    truth: &Truth,
    discs: impl Iterator<Item = &'a (Point2, f32)>,
    points: &[Point2],
) -> f32 {
    let to_robot = truth.robot.inverse();
    let discs = discs.map(|(middle, radius_m)| radius_m - distance_m(outline, to_robot.transform(*middle)));
    let points = points.iter().map(|point| -distance_m(outline, *point));
    discs.chain(points).fold(f32::MIN, f32::max)
}
