//! What comes into the scene while the world runs: a trolley that is left, a door that shuts.

use floorguard_types::geometry::Point2;

use super::Simulation;
use crate::scene::{FurnitureFile, Scene, SceneFile};

/// Nothing comes nearer to a body than this, metres.
const GAP_M: f32 = 0.4;
/// A disc around a person, metres.
const PERSON_M: f32 = 0.4;

/// Furniture that is not there at the start.
pub(super) struct Arrivals {
    file: SceneFile,
    /// Moment, seconds, and index in the file; the soonest last.
    waiting: Vec<(f32, usize)>,
    came: Vec<usize>,
}

impl Arrivals {
    pub(super) fn of(file: &SceneFile) -> Self {
        let pieces = file.furniture.iter().enumerate();
        let mut waiting: Vec<_> = pieces.filter_map(|(at, piece)| Some((piece.appears_s?, at))).collect();
        waiting.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        Self {
            file: if waiting.is_empty() { SceneFile::default() } else { file.clone() },
            waiting,
            came: Vec::new(),
        }
    }

    /// The scene with what is due and has room; none: nothing comes.
    fn scene_at(&mut self, now_s: f32, bodies: &[(Point2, f32)]) -> Option<Scene> {
        let has_room = |piece: &FurnitureFile| {
            let [x_m, y_m] = piece.at_m;
            let gap_m = |(place, radius_m): &(Point2, f32)| place.distance(Point2::new(x_m, y_m)) - radius_m;
            bodies.iter().all(|body| gap_m(body) > piece.reach_m() + GAP_M)
        };
        let due = self.waiting.iter().rposition(|(from_s, at)| {
            *from_s <= now_s && self.file.furniture.get(*at).is_some_and(has_room)
        })?;
        let (_, at) = self.waiting.remove(due);
        self.came.push(at);
        Some(self.file.build_with(&self.came))
    }
}

impl Simulation {
    /// What has come since the start, by its index among the scenario's furniture.
    #[must_use]
    pub fn came(&self) -> &[usize] {
        &self.arrivals.came
    }

    /// Lets come what is due.
    pub(super) fn let_come(&mut self, now_us: u64) {
        if self.arrivals.waiting.is_empty() {
            return;
        }
        let pose = self.body.pose();
        let robot = self.parameters.footprint.iter().map(|corner| (pose.transform(*corner), 0.0));
        let people = self.crowd.people.iter().map(|person| (person.position, PERSON_M));
        let middle = (Point2::new(pose.x_m, pose.y_m), 0.0);
        let bodies: Vec<_> = people.chain(robot).chain([middle]).collect();
        if let Some(scene) = self.arrivals.scene_at(now_us as f32 * 1.0e-6, &bodies) {
            self.scene = scene;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    const DOOR: &str = r#"
title = "a door that shuts"
[scene]
wall = [{ from_m = [-2.0, 3.0], to_m = [6.0, 3.0] }]
furniture = [
  { kind = "box", at_m = [5.0, 0.0], size_m = [0.1, 1.6], height_m = 2.0, appears_s = 0.2 },
  { kind = "box", at_m = [0.5, 0.0], size_m = [0.4, 0.4], height_m = 2.0, appears_s = 0.1 },
  { kind = "box", at_m = [2.0, -3.0], size_m = [0.4, 0.4], height_m = 2.0 },
]
"#;

    /// A door shuts when its time has come, not on the robot, and is on no map.
    #[test]
    fn what_comes_waits_for_the_robot() {
        let scenario = Scenario::from_toml(DOOR).unwrap();
        let mut simulation = Simulation::new(&scenario, 1).unwrap();
        let names = |scene: &Scene| scene.truth().iter().map(|part| part.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(simulation.scene()), ["wall 1", "box 3"]);
        simulation.advance_to(150_000, &mut |_| {});
        assert_eq!(names(simulation.scene()), ["wall 1", "box 3"], "the robot stands where box 2 would");
        simulation.advance_to(300_000, &mut |_| {});
        assert_eq!(names(simulation.scene()), ["wall 1", "box 3", "box 1"]);
        assert_eq!(names(&scenario.scene.build()), ["wall 1", "box 3"]);
    }
}
