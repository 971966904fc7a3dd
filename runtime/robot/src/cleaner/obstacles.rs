//! What stands on the floor and is not on the map: people who wait, trolleys, cartons.
//!
//! Every scan marks the cells where it ends short of what the map shows. A mark fades after a while, so that a person
//! who has left blocks no path; one that a beam passes is gone at once.

use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::{Point2, Pose2, wrap_angle};
use floorguard_types::sensing::{BeamReturn, Scan};

use crate::site::{Floor, ends_of};

/// A beam that ends this near to something on the map is explained by it, metres.
const EXPLAINED_M: f32 = 0.25;
/// Farther beams say too little about who stands there later, metres.
const RANGE_M: f32 = 6.0;
/// A mark, and where a person was seen, counts this long, seconds.
pub(super) const FADES_S: f32 = 4.0;

/// A beam that ends this much farther than a mark has passed it, metres.
const BEYOND_M: f32 = 0.3;
/// One beam in this many is examined.
const BEAM_INTERVAL: usize = 3;
/// An object on the floor lies there until it is seen to be gone, or this long, seconds.
const LIES_S: f32 = 60.0;
/// Observations of one object are within this of each other, metres.
const SAME_OBSTACLE_M: f32 = 0.15;

/// A person's feet and what it pushes or carries are within this of its middle, metres.
const PERSON_REACH_M: f32 = 0.8;

/// The beam towards a place in the scanner's frame, and both beside it, end beyond it. A beam that was not measured says nothing.
fn is_passed(scan: &Scan, place: Point2) -> bool {
    let beam = (wrap_angle(libm::atan2f(place.y_m, place.x_m) - scan.first_angle_rad)
        .rem_euclid(std::f32::consts::TAU)
        / scan.step_rad.max(1.0e-4))
    .round() as usize;
    let beams = beam.checked_sub(1).and_then(|first| scan.beams.get(first..beam + 2));
    beams.is_some_and(|beams| {
        beams.iter().all(|hit| match hit {
            BeamReturn::Hit(range_mm) | BeamReturn::Free(range_mm) => {
                f32::from(*range_mm) * 1.0e-3 > place.norm() + BEYOND_M
            }
            BeamReturn::Unknown => false,
        })
    })
}

/// Marks on the raster of a floor.
pub struct Obstacles {
    raster: GridGeometry,
    seen_s: Vec<f32>,
    marked: Vec<u32>,
    /// Place, and what is kept around it.
    people: Vec<(Point2, f32)>,
    people_s: f32,
    /// Place, half width and last sight of objects that lie on the floor.
    low_obstacles: Vec<(Point2, f32, f32)>,
}

impl Obstacles {
    /// Nothing seen.
    pub fn new(raster: GridGeometry) -> Self {
        Self {
            raster,
            seen_s: vec![f32::NEG_INFINITY; raster.cell_count()],
            marked: Vec::new(),
            people: Vec::new(),
            people_s: 0.0,
            low_obstacles: Vec::new(),
        }
    }

    /// A scan, seen from the scanner's pose in the map frame. A mark that a beam passes is none any more: who walks leaves
    /// no wall behind.
    pub fn see(&mut self, floor: &Floor, scanner: Pose2, (scan, now_s): (&Scan, f32)) {
        let (marks, raster, to_scanner) = (&mut self.seen_s, self.raster, scanner.inverse());
        self.marked.retain(|cell| {
            let place = to_scanner.transform(raster.centre(*cell as usize));
            let is_old = now_s - marks[*cell as usize] > FADES_S;
            if is_old || is_passed(scan, place) {
                marks[*cell as usize] = f32::NEG_INFINITY;
            }
            marks[*cell as usize] > f32::NEG_INFINITY
        });
        for end in ends_of(scan, BEAM_INTERVAL).filter(|end| end.norm() < RANGE_M) {
            let place = scanner.transform(end);
            let Some(cell) = self.raster.cell_at(place) else { continue };
            if floor.surfaces.clearance_m(place) < EXPLAINED_M
                || floor.clearance.clearance_m(place) < EXPLAINED_M
            {
                continue;
            }
            if self.seen_s[cell] == f32::NEG_INFINITY {
                self.marked.push(cell as u32);
            }
            self.seen_s[cell] = now_s;
        }
    }

    /// The people that the robot knows of, map frame, with what is kept around each, metres, and when they were seen.
    pub fn see_people(&mut self, places: &[(Point2, f32)], seen_s: f32) {
        self.people.clear();
        self.people.extend_from_slice(places);
        self.people_s = seen_s;
    }

    /// Objects on the floor that the camera sees, in the robot's frame at a pose in the map frame. True if one is new.
    /// What belongs to something on the map or to a person is no object: at the edge of a picture legs look low.
    pub fn see_obstacles(
        &mut self,
        floor: &Floor,
        pose: Pose2,
        (low_obstacles, now_s): (&[(Point2, f32)], f32),
    ) -> bool {
        self.low_obstacles.retain(|(_, _, seen_s)| now_s - seen_s <= LIES_S);
        let mut is_new = false;
        for (in_robot, half_m) in low_obstacles {
            let place = pose.transform(*in_robot);
            let is_explained = floor.surfaces.clearance_m(place) < EXPLAINED_M
                || floor.clearance.clearance_m(place) < EXPLAINED_M
                || self.people.iter().any(|(person, _)| person.distance(place) < PERSON_REACH_M);
            if is_explained {
                continue;
            }
            let known =
                self.low_obstacles.iter_mut().find(|(other, ..)| other.distance(place) < SAME_OBSTACLE_M);
            match known {
                Some(known) => *known = (place, half_m.max(known.1), now_s),
                None => {
                    is_new = true;
                    self.low_obstacles.push((place, *half_m, now_s));
                }
            }
        }
        is_new
    }

    /// Something is known to lie within a distance of a place, metres.
    pub fn lies_near(&self, place: Point2, within_m: f32) -> bool {
        self.low_obstacles.iter().any(|(obstacle, ..)| obstacle.distance(place) < within_m)
    }

    /// Places that are taken now, each with a disc around it, metres.
    pub fn places(&self, now_s: f32) -> Vec<(Point2, f32)> {
        let recent = |cell: &&u32| now_s - self.seen_s[**cell as usize] <= FADES_S;
        let marks = self.marked.iter().filter(recent).map(|cell| (self.raster.centre(*cell as usize), 0.0));
        let people = self.people.iter().filter(|_| now_s - self.people_s <= FADES_S);
        let low_obstacles = self.low_obstacles.iter().filter(|(_, _, seen_s)| now_s - seen_s <= LIES_S);
        let low_obstacles = low_obstacles.map(|(place, half_m, _)| (*place, *half_m));
        marks.chain(low_obstacles).chain(people.copied()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::site::rooms;

    /// A scan with every beam as long as `range_mm` tells, 1° apart, around straight ahead.
    fn scan(range_mm: impl Fn(i32) -> Option<u16>) -> Scan {
        let mut scan = Scan::EMPTY;
        scan.first_angle_rad = -90.0_f32.to_radians();
        scan.step_rad = 1.0_f32.to_radians();
        for degrees in -90..=90 {
            let beam = range_mm(degrees).map_or(BeamReturn::Unknown, BeamReturn::Hit);
            scan.beams.push(beam).unwrap();
        }
        scan
    }

    /// Somebody a metre ahead, in the middle of a room.
    #[test]
    fn mark_clears_by_evidence_not_empty_beams() {
        let floor = Floor::new("plain", rooms::plain().unwrap(), 0.17).unwrap();
        let half = |cells: u16| i32::from(cells) / 2;
        let middle = floor.cells.index(half(floor.cells.width()), half(floor.cells.height())).unwrap();
        let middle = floor.cells.centre(middle);
        let scanner = Pose2::new(middle.x_m - 1.0, middle.y_m, 0.0);
        let person = scan(|degrees| (degrees.abs() < 6).then_some(1_000));
        let mut obstacles = Obstacles::new(floor.cells);
        obstacles.see(&floor, scanner, (&person, 0.0));
        assert!(!obstacles.places(0.1).is_empty());
        obstacles.see(&floor, scanner, (&scan(|_| None), 0.2));
        assert!(!obstacles.places(0.2).is_empty(), "blind is not clear");
        obstacles.see(&floor, scanner, (&scan(|degrees| (degrees.abs() < 6).then_some(1_100)), 0.3));
        assert!(!obstacles.places(0.3).is_empty(), "that may be the same one");
        obstacles.see(&floor, scanner, (&scan(|_| Some(30_000)), 0.4));
        assert!(obstacles.places(0.4).is_empty(), "a beam went through");
        obstacles.see(&floor, scanner, (&person, 0.5));
        assert!(obstacles.places(0.5 + FADES_S + 0.1).is_empty(), "it fades");
    }
}
