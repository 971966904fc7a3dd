//! Lanes for a robot that is longer than it is wide: straight passes that begin where it can stand in their direction without
//! having backed, and end where its field meets a wall.
//!
//! First parallel lanes, every other one the opposite way; then what they leave, at walls and behind shelves, by the lane that
//! passes over most of it for the way that it takes.

use std::f32::consts::FRAC_PI_2;

use floorguard_cleaning::Lane;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::motion::Gear;

use super::ground::{Ground, QUARTERS};

/// Places along a lane are looked at in steps of half a cell, metres.
const STEP_M: f32 = 0.05;
/// A lane over fewer cells than this is not worth its turns.
const CELLS_MIN: usize = 8;
/// What it takes to get to a lane counts as so much of its length, metres.
const APPROACH_M: f32 = 2.0;
/// Lanes at most.
const LANES_MAX: usize = 1_000;

/// A straight piece that the robot can drive, with the cells that its brush passes over.
#[derive(Clone, Debug)]
struct Run {
    lane: Lane,
    /// How far on the rear axle is by then, metres, and the cell; in the order of the way.
    cells: Vec<(f32, u32)>,
}

impl Run {
    /// How many of its cells are left, and how far on the first and the last of them are.
    fn left(&self, is_left: &[bool]) -> (usize, [f32; 2]) {
        let mut left = self.cells.iter().filter(|(_, cell)| is_left[*cell as usize]).map(|(along_m, _)| *along_m);
        let Some(first_m) = left.next() else { return (0, [0.0; 2]) };
        let (count, last_m) = left.fold((1, first_m), |(count, _), along_m| (count + 1, along_m));
        (count, [first_m, last_m])
    }

    /// The part of it that passes over what is left.
    fn part(&self, [first_m, last_m]: [f32; 2]) -> Lane {
        let length_m = self.lane.from.distance(self.lane.to).max(1.0e-3);
        let at = |along_m: f32| {
            let share = (along_m / length_m).clamp(0.0, 1.0);
            let mix = |a: f32, b: f32| a + share * (b - a);
            Point2::new(mix(self.lane.from.x_m, self.lane.to.x_m), mix(self.lane.from.y_m, self.lane.to.y_m))
        };
        Lane { from: at(first_m - 2.0 * STEP_M), to: at(last_m + 2.0 * STEP_M) }
    }
}

/// Lanes over all cells that the mission answers for, as far as straight passes along the axes of the map get to them.
pub(super) fn lanes_over(ground: &Ground) -> Vec<Lane> {
    let mut is_left = ground.floor.reachable.clone();
    let mut lanes = Vec::new();
    let long = usize::from(ground.raster().height() > ground.raster().width());
    for (number, across_m) in lines(ground, long, 2.0 * ground.lane_m()).into_iter().enumerate() {
        let quarter = if number % 2 == 0 { long } else { long + 2 };
        for run in runs(ground, quarter, across_m) {
            if run.left(&is_left).0 >= CELLS_MIN {
                run.cells.iter().for_each(|(_, cell)| is_left[*cell as usize] = false);
                lanes.push(run.lane);
            }
        }
    }
    let all: Vec<Run> = (0..QUARTERS)
        .flat_map(|quarter| {
            let lines = lines(ground, quarter, ground.lane_m());
            lines.into_iter().flat_map(move |across_m| runs(ground, quarter, across_m))
        })
        .collect();
    while lanes.len() < LANES_MAX {
        let worth = |run: &Run| {
            let (count, [first_m, last_m]) = run.left(&is_left);
            (count >= CELLS_MIN).then(|| (count as f32 / (last_m - first_m + APPROACH_M), [first_m, last_m]))
        };
        let worthy = all.iter().filter_map(|run| worth(run).map(|(worth, part)| (worth, part, run)));
        let Some((_, part, run)) = worthy.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        lanes.push(run.part(part));
        run.cells.iter().for_each(|(_, cell)| is_left[*cell as usize] = false);
    }
    lanes
}

/// Where parallel lines lie across a direction, as many as the spacing needs, between the outermost places of the rear axle.
fn lines(ground: &Ground, quarter: usize, spacing_m: f32) -> Vec<f32> {
    let raster = ground.raster();
    let across = |cell: usize| {
        let centre = raster.centre(cell);
        if quarter.is_multiple_of(2) { centre.y_m } else { centre.x_m }
    };
    let places = || (0..raster.cell_count()).filter(|cell| ground.floor.passable[*cell]).map(across);
    let (low_m, high_m) = (places().fold(f32::MAX, f32::min), places().fold(f32::MIN, f32::max));
    if low_m > high_m {
        return Vec::new();
    }
    let count = ((high_m - low_m) / spacing_m).ceil().max(1.0);
    (0..=count as usize).map(|line| low_m + (high_m - low_m) * line as f32 / count).collect()
}

/// The pieces of a line that can be driven in a direction.
fn runs(ground: &Ground, quarter: usize, across_m: f32) -> Vec<Run> {
    let raster = ground.raster();
    let (heading_rad, origin) = (quarter as f32 * FRAC_PI_2, raster.origin_in_map());
    let (width_m, height_m) =
        (f32::from(raster.width()) * raster.resolution_m(), f32::from(raster.height()) * raster.resolution_m());
    let place = |along_m: f32| match quarter {
        0 => Point2::new(origin.x_m + along_m, across_m),
        1 => Point2::new(across_m, origin.y_m + along_m),
        2 => Point2::new(origin.x_m + width_m - along_m, across_m),
        _ => Point2::new(across_m, origin.y_m + height_m - along_m),
    };
    let length_m = if quarter.is_multiple_of(2) { width_m } else { height_m };
    let (mut found, mut open): (Vec<Run>, Option<(f32, Run)>) = (Vec::new(), None);
    for step in 0..=(length_m / STEP_M) as u32 {
        let along_m = step as f32 * STEP_M;
        let at = place(along_m);
        let pose = Pose2::new(at.x_m, at.y_m, heading_rad);
        if !ground.is_free(pose, Gear::Ahead) {
            found.extend(open.take().map(|(_, run)| run));
            continue;
        }
        if open.is_none() && !ground.is_headed(at, quarter) {
            continue;
        }
        let (from_m, run) =
            open.get_or_insert_with(|| (along_m, Run { lane: Lane { from: at, to: at }, cells: Vec::new() }));
        run.lane.to = at;
        ground.under_brush(pose, 0.0, |cell| {
            let known = run.cells.iter().rev().take(64).any(|(_, other)| *other == cell as u32);
            if ground.floor.reachable[cell] && !known {
                run.cells.push((along_m - *from_m, cell as u32));
            }
        });
    }
    found.extend(open.map(|(_, run)| run));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cleaner::body::Body;
    use crate::cleaner::pace::{among_people, pace_of};
    use crate::cleaner::path_finder::PathFinder;
    use crate::cleaner::plan::MissionPlan;
    use crate::site::scrubber;
    use floorguard_configuration::{EXAMPLE, parse};

    /// The supermarket: nearly all floor that the brush can get to, by lanes that lie on free floor.
    #[test]
    fn lanes_pass_over_reachable_floor() {
        let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
        let mut ground = Ground::new(&MissionPlan::supermarket(), (Body::of(&robot), scrubber::BRUSH)).unwrap();
        let mut path_finder = PathFinder::new(*ground.raster(), among_people(&robot, pace_of(&robot)));
        ground.explore(&mut path_finder);
        let lanes = lanes_over(&ground);
        let mut passed = vec![false; ground.raster().cell_count()];
        for lane in &lanes {
            let heading_rad = libm::atan2f(lane.to.y_m - lane.from.y_m, lane.to.x_m - lane.from.x_m);
            let begin = Pose2::new(lane.from.x_m, lane.from.y_m, heading_rad);
            for step in 0..=(lane.from.distance(lane.to) / STEP_M) as u32 {
                let pose = begin.compose(Pose2::new(step as f32 * STEP_M, 0.0, 0.0));
                assert!(ground.is_free(pose, Gear::Ahead), "{lane:?} at {pose:?}");
                ground.under_brush(pose, 0.0, |cell| passed[cell] = true);
            }
        }
        let reachable = || (0..passed.len()).filter(|cell| ground.floor.reachable[*cell]);
        let (all, swept) = (reachable().count(), reachable().filter(|cell| passed[*cell]).count());
        let way_m: f32 = lanes.iter().map(|lane| lane.from.distance(lane.to)).sum();
        let area_m2 = all as f32 * 0.01;
        println!("{} lanes, {way_m} m over {area_m2} m²; {swept} of {all} cells", lanes.len());
        assert!(swept as f32 > 0.95 * all as f32, "{swept} of {all}");
        assert!(way_m < 2.0 * area_m2 / (2.0 * ground.lane_m()), "{way_m} m over {area_m2} m²");
        assert!(lanes.len() < 150, "{}", lanes.len());
    }
}
