//! The cleaning mission of a scenario: its map as a survey would draw it, and the dirt that is expected.

use floorguard_mapping::{Grid, GridGeometry, Occupancy};
use floorguard_robot::cleaner::{ExpectedDirt, MissionPlan, MissionStrategy, PlanBegin};
use floorguard_robot::navigator::{Journey, NavigationPlan, NavigationSettings};
use floorguard_robot::site::ros_map::OccupancyMap;
use floorguard_sim::scenario::Scenario;
use floorguard_sim::scene::Scene;
use floorguard_types::geometry::{Point2, Pose2};

/// Edge of a pixel of a map that is drawn from a scene, metres.
const PIXEL_M: f32 = 0.05;
/// A pixel this near to an object belongs to it, metres.
const TOUCHES_M: f32 = 0.03;
/// Height of the safety scanner's plane, and of what it sees nothing of, metres.
const HEIGHTS_M: (f32, f32) = (0.15, 0.06);
/// Floor around the start and the route that belongs to a map of a scene without walls, metres.
const AROUND_M: f32 = 4.0;

/// Of a scenario: the map is drawn from its scene as a survey would, and the expectation is the one that the simulator
/// draws the dirt from.
///
/// # Errors
/// The scene is too large for a map.
pub fn plan_of_scenario(
    scenario: &Scenario,
    strategy: MissionStrategy,
    seed: u64,
) -> anyhow::Result<MissionPlan> {
    let scene = scenario.scene.build();
    let dirt = scenario.dirt_patches(&scene, seed).into_iter().map(|patch| {
        let corner = patch.corner();
        ExpectedDirt {
            corner_m: [corner.x_m, corner.y_m],
            edge_m: floorguard_sim::dirt::DirtyPatch::EDGE_M,
            units: patch.units,
        }
    });
    let begin = PlanBegin { strategy, pose_in_map: scenario.start_pose(), seed };
    Ok(MissionPlan::on_map(begin, dirt.collect(), &survey(scenario, &scene)?))
}

/// Of a scenario: a drive to a goal on the map that a survey would draw of its scene.
///
/// # Errors
/// The scene is too large for a map.
pub fn navigation_of_scenario(
    scenario: &Scenario,
    (settings, goal_in_map): (NavigationSettings, Pose2),
    seed: u64,
) -> anyhow::Result<NavigationPlan> {
    let map = survey(scenario, &scenario.scene.build())?;
    let journey = Journey { start_in_map: scenario.start_pose(), goal_in_map };
    Ok(NavigationPlan::on_map(settings, journey, (&map, seed)))
}

/// Draws the map of a scene: what the scanner's plane meets is a surface, what stands above or below it is no floor.
pub(crate) fn survey(scenario: &Scenario, scene: &Scene) -> anyhow::Result<OccupancyMap> {
    let route = scenario.route.waypoints_m.iter().chain([&scenario.start.at_m]);
    let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
    let mut cover = |x_m: f32, y_m: f32, around_m: f32| {
        low = [low[0].min(x_m - around_m), low[1].min(y_m - around_m)];
        high = [high[0].max(x_m + around_m), high[1].max(y_m + around_m)];
    };
    let bounds = scene.bounds();
    // Walls say where the floor ends; without them it goes on around the route.
    let around_m = if bounds.is_some() { 1.0 } else { AROUND_M };
    route.for_each(|[x_m, y_m]| cover(*x_m, *y_m, around_m));
    bounds.into_iter().flatten().for_each(|corner| cover(corner.x_m, corner.y_m, 0.0));
    let count = |axis: usize| u16::try_from(((high[axis] - low[axis]) / PIXEL_M).ceil() as u32 + 1);
    let (width, height) = (count(0)?, count(1)?);
    let geometry = GridGeometry::new(width, height, PIXEL_M, Point2::new(low[0], low[1]))
        .ok_or_else(|| anyhow::anyhow!("the scene is too small for a map"))?;
    let pixel = |index: usize| {
        let place = geometry.centre(index);
        let touches = |height_m| scene.distance_at(place, height_m).is_some_and(|gap_m| gap_m <= TOUCHES_M);
        if touches(HEIGHTS_M.0) {
            Occupancy::Occupied
        } else if touches(HEIGHTS_M.1)
            || scene.nearest_obstacle(place).is_some_and(|(_, gap_m)| gap_m <= TOUCHES_M)
        {
            Occupancy::Unknown
        } else {
            Occupancy::Free
        }
    };
    Ok(Grid::new(geometry, (0..geometry.cell_count()).map(pixel).collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cleaner's own tests read the plan from a file: they know no simulator.
    #[test]
    fn cleaner_test_file_equals_this_plan() {
        let scenario = Scenario::named("supermarket").unwrap();
        let plan = plan_of_scenario(&scenario, MissionStrategy::Guarantee, 1).unwrap();
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../runtime/robot/src/cleaner/supermarket.json");
        if std::env::var_os("FLOORGUARD_WRITE_GOLDEN").is_some() {
            std::fs::write(path, plan.to_text().unwrap() + "\n").unwrap();
        }
        let file = std::fs::read_to_string(path).unwrap_or_default();
        assert_eq!(file.trim_end(), plan.to_text().unwrap(), "FLOORGUARD_WRITE_GOLDEN=1 writes it again");
    }
}
