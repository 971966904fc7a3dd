//! The run from above.

use floorguard_sim::scene::{FurnitureFile, FurnitureKind, SceneFile};
use floorguard_types::geometry::Point2;

use crate::world::{Observation, Plan};
use floorguard_operator::picture::{PersonPath, StopMark, TopView};

/// Half the thickness of a wall in the picture, metres.
const WALL_HALF_M: f32 = 0.06;

/// Everything that the picture shows.
#[must_use]
pub fn top_view(plan: &Plan, observation: &Observation) -> TopView {
    let verdict = &observation.verdict;
    let word = verdict.verdict.words();
    let people = observation
        .people_paths
        .iter()
        .map(|(id, points)| PersonPath { id: u64::from(*id), points: points.clone() });
    let stops = observation.stops.iter().map(|stop| StopMark {
        position: stop.position,
        at_s: stop.at_s,
        cause: stop.kind.clone(),
    });
    TopView {
        title: plan.scenario.title.clone(),
        subtitle: format!(
            "seed {}, {:.0} s, {:.0} m driven, {} stops, verdict: {word}",
            verdict.seed, verdict.duration_s, verdict.distance_m, verdict.stops
        ),
        walls: walls(&plan.scenario.scene),
        obstacles: furniture(&plan.scenario.scene, &observation.came)
            .into_iter()
            .chain(map_boxes(&plan.scenario.scene))
            .collect(),
        robot_path: observation.robot_path.clone(),
        robot_outline: plan.robot.geometry.footprint.iter().copied().collect(),
        swath_width_m: plan.robot_parameters().brush.width_m,
        people: people.collect(),
        stops: stops.collect(),
    }
}

/// Walls and furniture that people cannot be seen through, as they stand at the begin.
#[must_use]
pub fn outlines(scene: &SceneFile) -> Vec<Vec<Point2>> {
    walls(scene).into_iter().chain(furniture(scene, &[])).collect()
}

fn walls(scene: &SceneFile) -> Vec<Vec<Point2>> {
    let outline = |[ax, ay]: [f32; 2], [bx, by]: [f32; 2]| {
        let length_m = (bx - ax).hypot(by - ay).max(1.0e-3);
        let (nx, ny) = (-(by - ay) / length_m * WALL_HALF_M, (bx - ax) / length_m * WALL_HALF_M);
        [(ax + nx, ay + ny), (ax - nx, ay - ny), (bx - nx, by - ny), (bx + nx, by + ny)]
            .map(|(x_m, y_m)| Point2::new(x_m, y_m))
            .to_vec()
    };
    scene.wall.iter().map(|wall| outline(wall.from_m, wall.to_m)).collect()
}

fn map_boxes(scene: &SceneFile) -> Vec<Vec<Point2>> {
    let outline = |[low, high]: [Point2; 2]| {
        vec![low, Point2::new(high.x_m, low.y_m), high, Point2::new(low.x_m, high.y_m)]
    };
    scene.occupied.boxes().into_iter().map(outline).collect()
}

/// A trolley's basket, metres.
const TROLLEY_M: [f32; 2] = [0.95, 0.55];

/// What stands from the begin on, and what has come, by its index.
fn furniture(scene: &SceneFile, came: &[usize]) -> Vec<Vec<Point2>> {
    let is_there = |at: usize, piece: &FurnitureFile| piece.appears_s.is_none() || came.contains(&at);
    let standing = scene.furniture.iter().enumerate().filter(|(at, piece)| is_there(*at, piece));
    standing
        .filter(|(_, piece)| piece.kind != FurnitureKind::Ramp)
        .map(|(_, piece)| {
            let [length_m, width_m] =
                if piece.kind == FurnitureKind::Trolley { TROLLEY_M } else { piece.size_m };
            let (sin, cos) = piece.yaw_deg.to_radians().sin_cos();
            let [x_m, y_m] = piece.at_m;
            [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)]
                .map(|(along, across)| (along * length_m, across * width_m))
                .map(|(a, b)| Point2::new(x_m + cos * a - sin * b, y_m + sin * a + cos * b))
                .to_vec()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_has_come_is_drawn() {
        let mut scene = SceneFile::default();
        for appears_s in [None, Some(0.0), Some(30.0)] {
            let size = ([1.0, 1.0], 1.0);
            let piece = FurnitureFile::new(FurnitureKind::Box, [appears_s.unwrap_or(-9.0), 0.0], size);
            scene.furniture.push(FurnitureFile { appears_s, ..piece });
        }
        let middles = |came: &[usize]| {
            furniture(&scene, came).iter().map(|box_m| box_m[0].x_m - 0.5).collect::<Vec<f32>>()
        };
        assert_eq!((middles(&[]), middles(&[1])), (vec![-9.0], vec![-9.0, 0.0]));
    }
}
