//! What stands on the floor and is not on the map: people who wait, trolleys, cartons.
//!
//! Every scan marks the cells where it ends short of what the map shows. A mark fades after a while, so that who has left
//! bars no way.

use floorguard_core::geometry::{Point2, Pose2};
use floorguard_core::maps::GridGeometry;

use crate::mission::Floor;

/// A beam that ends this near to something on the map is explained by it, metres.
const EXPLAINED_M: f32 = 0.25;
/// Farther beams say too little about who stands there later, metres.
const RANGE_M: f32 = 6.0;
/// A mark counts this long, seconds.
const FADES_S: f32 = 4.0;

/// Half a person, metres; the room of the robot has a margin of its own.
const PERSON_M: f32 = 0.15;

/// Marks on the raster of a floor.
pub struct Obstacles {
    raster: GridGeometry,
    seen_s: Vec<f32>,
    marked: Vec<u32>,
    people: Vec<Point2>,
    people_s: f32,
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
        }
    }

    /// Ends of beams, in the robot's frame, seen from a pose in the map frame.
    pub fn see(&mut self, floor: &Floor, pose: Pose2, (ends, now_s): (&[Point2], f32)) {
        let marks = &mut self.seen_s;
        self.marked.retain(|cell| now_s - marks[*cell as usize] <= FADES_S);
        for end in ends.iter().filter(|end| end.norm() < RANGE_M) {
            let place = pose.transform(*end);
            let Some(cell) = self.raster.cell_at(place) else { continue };
            if floor.surfaces.clearance_m(place) < EXPLAINED_M
                || floor.clearance.clearance_m(place) < EXPLAINED_M
            {
                continue;
            }
            if now_s - marks[cell] > FADES_S {
                self.marked.push(cell as u32);
            }
            marks[cell] = now_s;
        }
    }

    /// The people that the robot knows of now, map frame.
    pub fn see_people(&mut self, places: &[Point2], now_s: f32) {
        self.people.clear();
        self.people.extend_from_slice(places);
        self.people_s = now_s;
    }

    /// Places that are taken now, each with a disc around it, metres.
    pub fn places(&self, now_s: f32) -> Vec<(Point2, f32)> {
        let recent = |cell: &&u32| now_s - self.seen_s[**cell as usize] <= FADES_S;
        let marks = self.marked.iter().filter(recent).map(|cell| (self.raster.centre(*cell as usize), 0.0));
        let people = self.people.iter().filter(|_| now_s - self.people_s <= FADES_S);
        marks.chain(people.map(|place| (*place, PERSON_M))).collect()
    }
}
