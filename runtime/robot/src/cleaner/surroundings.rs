//! Where the robot may be at this moment: the floor of the map, what stands on it now, and an escape path for a robot
//! that a person has come too near to.

use floorguard_mapping::{GridCoordinates, GridGeometry};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::Gear;

use super::body::{DISCS, FootprintDiscs};
use super::ground::Ground;
use super::obstacles::Obstacles;
use super::refused::RefusedMotion;

/// Within this distance of where it stands the robot may stay as near to objects as it is, metres.
const AROUND_M: f32 = 0.9;
/// Places ahead of the rear axle with the clearance that they need so that nothing is in the warning zone,
/// metres.
const WARNING_M: [(f32, f32); 3] = [(0.2, 0.75), (0.9, 0.75), (1.6, 0.6)];
/// Factor of the travel time there.
const SLOW: f32 = 2.0;
/// What a raster of cells may take from a distance, metres.
const RASTER_M: f32 = 0.05;

/// What stands around the robot, for one search.
pub struct Surroundings<'a> {
    ground: &'a Ground,
    /// Distance from every cell to what is not on the map, metres; infinite where that is far.
    gaps_m: Vec<f32>,
    start: Pose2,
    least_ahead_m: [f32; DISCS],
    least_back_m: [f32; DISCS],
    /// What the guard has refused, and when it is now, seconds.
    refused: (RefusedMotion, f32),
}

impl<'a> Surroundings<'a> {
    /// Of a robot that stands at `start`.
    pub fn new(ground: &'a Ground, (obstacles, now_s): (&Obstacles, f32), start: Pose2) -> Self {
        let reach_m = ground.body.ahead.radius_m.max(ground.body.back.radius_m) + 0.1;
        let gaps_m = gaps(ground.raster(), &obstacles.places(now_s), reach_m);
        let mut here = Self {
            ground,
            gaps_m,
            start,
            least_ahead_m: [0.0; DISCS],
            least_back_m: [0.0; DISCS],
            refused: (RefusedMotion::default(), now_s),
        };
        let least = |discs: &FootprintDiscs| {
            discs.places(start).map(|place| (here.clearance_m(place) - RASTER_M).clamp(0.0, discs.radius_m))
        };
        let (ahead, back) = (least(&ground.body.ahead), least(&ground.body.back));
        (here.least_ahead_m, here.least_back_m) = (ahead, back);
        here
    }

    /// The same, where the guard has refused a motion.
    pub fn after(self, refused: RefusedMotion) -> Self {
        Self { refused: (refused, self.refused.1), ..self }
    }

    /// From a place to the nearest object, metres.
    fn clearance_m(&self, place: Point2) -> f32 {
        let gap_m = self.ground.raster().cell_at(place).and_then(|cell| self.gaps_m.get(cell));
        gap_m.map_or(0.0, |gap_m| gap_m.min(self.ground.floor.clearance.clearance_m(place)))
    }

    /// The robot may be there. Near the start no disc of it need be farther from objects than it is already: a person
    /// nearby blocks no path that leads away.
    pub fn is_free(&self, pose: Pose2, gear: Gear) -> bool {
        let body = &self.ground.body;
        let (discs, least_m, count) = match gear {
            Gear::Ahead | Gear::Spin => (&body.ahead, &self.least_ahead_m, DISCS),
            // What lies ahead is left behind when driving backwards.
            Gear::Back => (&body.back, &self.least_back_m, DISCS - 1),
        };
        let is_near = libm::hypotf(pose.x_m - self.start.x_m, pose.y_m - self.start.y_m) < AROUND_M;
        discs.places(pose).iter().zip(least_m).take(count).all(|(place, least_m)| {
            let clearance_m = self.clearance_m(*place);
            clearance_m >= discs.radius_m || (is_near && *least_m > 0.0 && clearance_m >= *least_m)
        })
    }

    /// Factor of the time against open floor the robot takes there; `None`: it may not be there. With something in its
    /// warning zone the guard lets it go slowly only, and what it has just refused comes last.
    pub fn slowness(&self, pose: Pose2, gear: Gear) -> Option<f32> {
        if !self.is_free(pose, gear) {
            return None;
        }
        let is_tight = |ahead_m: f32, least_m: f32| {
            self.clearance_m(pose.transform(Point2::new(ahead_m, 0.0))) < least_m
        };
        let is_slow = gear == Gear::Ahead && WARNING_M.iter().any(|(ahead, least)| is_tight(*ahead, *least));
        let (refused, now_s) = self.refused;
        Some(if is_slow { SLOW } else { 1.0 } * refused.slowness(pose, gear, now_s))
    }

    /// The robot can go straight on from a pose by so much.
    pub fn is_clear_ahead(&self, pose: Pose2, path_m: f32) -> bool {
        let steps = (path_m / 0.3).ceil().max(1.0) as i32;
        (1..=steps).all(|step| {
            let share = step as f32 / steps as f32;
            self.is_free(pose.compose(Pose2::new(share * path_m, 0.0, 0.0)), Gear::Ahead)
        })
    }
}

/// Distances from the cells of a raster to places with a disc around each, as far as `reach_m`.
fn gaps(raster: &GridGeometry, places: &[(Point2, f32)], reach_m: f32) -> Vec<f32> {
    let mut gaps_m = vec![f32::INFINITY; raster.cell_count()];
    for (place, around_m) in places {
        let reach = ((reach_m + around_m) * raster.cells_per_metre()).ceil() as i32;
        let GridCoordinates { column, row } = raster.coordinates_of(*place);
        for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
            let Some(cell) = raster.index(column + dx, row + dy) else { continue };
            let gap_m = raster.centre(cell).distance(*place) - around_m;
            gaps_m[cell] = gaps_m[cell].min(gap_m.max(0.0));
        }
    }
    gaps_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cleaner::body::Body;
    use crate::cleaner::plan::MissionPlan;
    use crate::site::scrubber;
    use floorguard_configuration::{EXAMPLE, parse};

    fn ground() -> Ground {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let plan = MissionPlan::supermarket();
        Ground::new(&plan, (Body::of(&robot), scrubber::BRUSH)).unwrap()
    }

    /// Somebody has stepped close to the nose of the robot: backwards is free, ahead is not, and the same place is barred to
    /// a robot that comes from afar.
    #[test]
    fn near_person_blocks_ahead_not_retreat() {
        let ground = ground();
        let here = Pose2::new(5.0, 0.0, 0.0);
        let mut obstacles = Obstacles::new(*ground.raster());
        let ahead = |path_m: f32| here.compose(Pose2::new(path_m, 0.0, 0.0));
        let free = Surroundings::new(&ground, (&obstacles, 0.0), here);
        assert!(free.is_free(ahead(0.15), Gear::Ahead) && free.is_clear_ahead(here, 1.0));
        obstacles.see_people(&[(Point2::new(6.4, 0.0), 0.15)], 0.0);
        let near = Surroundings::new(&ground, (&obstacles, 0.0), here);
        assert!(!near.is_free(ahead(0.15), Gear::Ahead) && !near.is_clear_ahead(here, 1.0));
        assert!(near.is_free(ahead(-0.15), Gear::Ahead), "not nearer than it is");
        assert!(near.is_free(ahead(-0.15), Gear::Back));
        let afar = Surroundings::new(&ground, (&obstacles, 0.0), Pose2::new(0.0, 0.0, 0.0));
        assert!(!afar.is_free(ahead(-0.15), Gear::Ahead));
    }

    #[test]
    fn robot_is_slower_beside_a_shelf() {
        let ground = ground();
        let obstacles = Obstacles::new(*ground.raster());
        let around = Surroundings::new(&ground, (&obstacles, 0.0), Pose2::default());
        assert_eq!(around.slowness(Pose2::new(5.0, 0.0, 0.0), Gear::Ahead), Some(1.0));
        assert_eq!(around.slowness(Pose2::new(5.0, 1.32, 0.0), Gear::Ahead), Some(SLOW));
        assert_eq!(around.slowness(Pose2::new(5.0, 2.0, 0.0), Gear::Ahead), None);
    }
}
