//! Drives to a goal through buildings with dead ends: the goal is reached, or the robot calls for help and is right.
//!
//! Whether there is a way is looked up in the true building, which the robot's own map and planners never see.

use std::collections::VecDeque;

use floorguard_sim::scene::Scene;
use floorguard_types::geometry::{Point2, Pose2};

use super::dead_end_world::DeadEndWorld;
use super::driving::without_need;
use super::summary::{RunOutcome, WorldFile};
use super::watched;
use crate::world::{Observation, Plan};

/// The longest drive, seconds of robot time.
const DRIVE_S: u64 = 300;
/// Obstructed for so long in all, the robot calls for help, seconds.
const HELP_S: f32 = 60.0;
/// Every second firing of the lidar is cast, and the one after it repeats it.
const LIDAR_GRAIN: usize = 2;
/// A way on which the robot's middle line keeps this far from everything is one that it must find, metres: half its width, 0.4 m,
/// and what its guard keeps beside a slow robot.
pub(super) const WIDE_M: f32 = 0.75;
/// Where there is no way with this, the body does not fit, metres: half its width and a hand's breadth.
pub(super) const NARROW_M: f32 = 0.45;
/// Cells of the search, metres.
const CELL_M: f32 = 0.1;
/// What the judge of contacts says of a robot that is not safe to drive, or has no way.
const STANDS: [&str; 2] = ["the robot never became ready", "the robot never moved"];
/// The search begins and ends at the nearest cell with room, within this, metres.
const NEAR_M: f32 = 1.2;

/// A wall is found between two places when one of the samples between them is this near to it, metres: half of their spacing.
const THIN_M: f32 = 0.03;

/// One drive. It fails by a contact, a missed stop, a stand without a true reason, or where it does not arrive although there is a way.
#[must_use]
pub fn dead_end_drive(seed: u64) -> RunOutcome {
    let command = format!("floorguard campaign dead-ends --seed {seed} --trials 1");
    match dead_end_observation(seed, |_| {}) {
        Ok((world, observation)) => {
            let ended = judge_dead_end(&world, &observation);
            let without_need = without_need(&observation);
            let (ending, failure) = (ended.as_ref().ok().copied(), ended.err());
            let world = failure.as_ref().map(|failure| file_of(&world, (seed, failure)));
            let verdict = Some(observation.verdict);
            RunOutcome { command, failure, verdict, without_need, ending, world }
        }
        Err(error) => RunOutcome { command, failure: Some(format!("{error:#}")), ..RunOutcome::default() },
    }
}

fn file_of(world: &DeadEndWorld, (seed, failure): (u64, &str)) -> WorldFile {
    let Pose2 { x_m, y_m, heading_rad } = world.goal;
    let (name, goal) =
        (format!("dead-ends-{seed}.toml"), format!("{x_m:.2},{y_m:.2},{:.0}", heading_rad.to_degrees()));
    let play =
        format!("floorguard simulate --scenario {name} --seed {seed} --navigate {goal} --duration {DRIVE_S}");
    WorldFile { text: format!("# {play}\n# {failure}\n{}", world.scenario.to_toml()), name }
}

/// Plays the drive of a seed; `change` may take something from its robot.
///
/// # Errors
/// The world cannot be played.
pub fn dead_end_observation(
    seed: u64,
    change: impl FnOnce(&mut Plan),
) -> anyhow::Result<(DeadEndWorld, Observation)> {
    let world = DeadEndWorld::drawn(seed);
    let mut plan = Plan::of("dead-ends", world.scenario.clone(), seed, DRIVE_S * 1_000_000)?;
    plan.navigation_settings.help_after_s = HELP_S;
    let mut plan = plan.navigating(world.goal)?;
    plan.lidar_grain = LIDAR_GRAIN;
    change(&mut plan);
    let observation = watched(&plan)?;
    Ok((world, observation))
}

/// How a drive ended, if that is a good end.
///
/// # Errors
/// Why it fails.
pub fn judge_dead_end(world: &DeadEndWorld, observation: &Observation) -> Result<&'static str, String> {
    let verdict = &observation.verdict;
    // That it stands may be right: whether it is, is looked up below.
    if !verdict.passed && verdict.failures.iter().any(|failure| !STANDS.contains(&failure.as_str())) {
        return Err(verdict.why_not());
    }
    let drive = verdict.navigation.as_ref().ok_or("nobody drove")?;
    if drive.reached {
        return Ok("the goal is reached");
    }
    let words = format!("{} ({:.1} m off after {:.0} s)", drive.reason, drive.off_goal_m, drive.took_s);
    if drive.false_claim {
        return Err(format!("it says that it is at the goal: {words}"));
    }
    if let Some(shortfall) = drive.stands_without_reason() {
        return Err(shortfall);
    }
    if !drive.calls_help() {
        return Err(format!("it neither arrives nor calls for help: {words}"));
    }
    let robot = observation.robot_path.last().copied().unwrap_or_default();
    match way_to(world, (robot, &observation.came)) {
        Way::Wide => Err(format!("it calls for help although there is a way: {words}")),
        Way::Narrow => Ok("help is called for: the body fits through, but hardly"),
        Way::None => Ok("help is called for: there is no way"),
    }
}

/// What the true building offers from where the robot ended to its goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// One with room on both sides.
    Wide,
    /// One through which the body fits, if it turns nowhere.
    Narrow,
    /// None.
    None,
}

/// The best way from a pose, with what has come, by its index among the furniture.
#[must_use]
pub fn way_to(world: &DeadEndWorld, (robot, came): (Pose2, &[usize])) -> Way {
    let here = Point2::new(robot.x_m, robot.y_m);
    let scene = world.scenario.scene.build_with(came);
    let goal = Point2::new(world.goal.x_m, world.goal.y_m);
    let leads = |clear_m: f32| leads_to(&scene, (here, goal), clear_m);
    match (leads(WIDE_M), leads(NARROW_M)) {
        (true, _) => Way::Wide,
        (false, true) => Way::Narrow,
        (false, false) => Way::None,
    }
}

/// Flood of the floor that is this far from everything, from one place to the other.
fn leads_to(scene: &Scene, (from, to): (Point2, Point2), clear_m: f32) -> bool {
    let Some([low, high]) = scene.bounds() else { return true };
    let count = |from_m: f32, to_m: f32| ((to_m - from_m) / CELL_M).ceil().max(1.0) as usize;
    let (width, height) = (count(low.x_m, high.x_m), count(low.y_m, high.y_m));
    let place = |cell: usize| {
        let (column, row) = ((cell % width) as f32, (cell / width) as f32);
        Point2::new(low.x_m + (column + 0.5) * CELL_M, low.y_m + (row + 0.5) * CELL_M)
    };
    let has_room =
        |cell: usize| scene.nearest_obstacle(place(cell)).is_none_or(|(_, gap_m)| gap_m >= clear_m);
    let free: Vec<bool> = (0..width * height).map(has_room).collect();
    // Not through a wall: nothing stands between the place and its cell.
    let is_open = |from: Point2, to: Point2| {
        let steps = (from.distance(to) / (0.5 * CELL_M)).ceil().max(1.0) as u32;
        (0..=steps).all(|step| {
            let share = step as f32 / steps as f32;
            let (dx_m, dy_m) = (to.x_m - from.x_m, to.y_m - from.y_m);
            let at = Point2::new(from.x_m + share * dx_m, from.y_m + share * dy_m);
            scene.nearest_obstacle(at).is_none_or(|(_, gap_m)| gap_m > THIN_M)
        })
    };
    let nearest = |to: Point2| {
        let is_near = |cell: &usize| free[*cell] && place(*cell).distance(to) < NEAR_M;
        let near = (0..free.len()).filter(is_near).filter(|cell| is_open(place(*cell), to));
        near.min_by(|a, b| place(*a).distance(to).total_cmp(&place(*b).distance(to)))
    };
    let (Some(begin), Some(end)) = (nearest(from), nearest(to)) else { return false };
    let (mut seen, mut queue) = (vec![false; free.len()], VecDeque::from([begin]));
    seen[begin] = true;
    while let Some(cell) = queue.pop_front() {
        if cell == end {
            return true;
        }
        let column = cell % width;
        let beside = [
            (column > 0).then(|| cell - 1),
            (column + 1 < width).then(|| cell + 1),
            cell.checked_sub(width),
            (cell + width < free.len()).then(|| cell + width),
        ];
        for next in beside.into_iter().flatten().filter(|next| free[*next]) {
            if !std::mem::replace(&mut seen[next], true) {
                queue.push_back(next);
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_sim::scene::{FurnitureFile, FurnitureKind};

    /// A world without furniture, whose doors stand open; what is put into the way decides.
    fn emptied(seed: u64) -> DeadEndWorld {
        let mut world = DeadEndWorld::drawn(seed);
        world.scenario.scene.furniture.clear();
        (world.scenario.start.at_m, world.goal) = ([4.0, 6.0], Pose2::new(16.0, 6.0, 0.0));
        world
    }

    fn way(world: &DeadEndWorld, came: &[usize]) -> Way {
        way_to(world, (world.scenario.start_pose(), came))
    }

    /// Doors of 1.5 m and more are wide; a leaf that takes a third of each leaves too little; both shut leave nothing.
    #[test]
    fn doors_decide_whether_there_is_a_way() {
        let mut world = emptied(1);
        let gaps: Vec<[f32; 2]> = world.scenario.scene.wall[4..]
            .windows(2)
            .map(|pair| [pair[0].to_m[1], pair[1].from_m[1]])
            .collect();
        assert_eq!(gaps.len(), 2);
        let leaf = |[low, high]: [f32; 2], share: f32| FurnitureFile {
            appears_s: Some(10.0),
            ..FurnitureFile::new(
                FurnitureKind::Box,
                [10.0, low + 0.5 * share * (high - low)],
                ([0.1, share * (high - low)], 2.0),
            )
        };
        world.scenario.scene.furniture = gaps.iter().map(|gap| leaf(*gap, 0.3)).collect();
        assert_eq!((way(&world, &[]), way(&world, &[0, 1])), (Way::Wide, Way::Narrow));
        world.scenario.scene.furniture = gaps.iter().map(|gap| leaf(*gap, 1.0)).collect();
        assert_eq!((way(&world, &[]), way(&world, &[0, 1])), (Way::Wide, Way::None));
        assert_eq!(way(&world, &[1]), Way::Wide, "the other door is open");
        // Beside the shut door, too: the nearest room is not looked for through it.
        let middle_m = 0.5 * (gaps[0][0] + gaps[0][1]);
        (world.scenario.start.at_m, world.goal) = ([9.8, middle_m], Pose2::new(10.9, middle_m, 0.0));
        assert_eq!(way(&world, &[0, 1]), Way::None);
    }

    /// What is written of a failed drive is its world again.
    #[test]
    fn world_of_a_failed_drive_can_be_played() {
        let world = emptied(3);
        let WorldFile { name, text } = file_of(&world, (3, "it stands"));
        assert_eq!(name, "dead-ends-3.toml");
        let play = "# floorguard simulate --scenario dead-ends-3.toml --seed 3 --navigate 16.00,6.00,0 ";
        assert!(text.starts_with(play), "{text}");
        let read = floorguard_sim::scenario::Scenario::from_toml(&text).unwrap();
        assert_eq!(read.to_toml(), world.scenario.to_toml());
    }
}
