//! When a path must be planned again.

use floorguard_types::geometry::Pose2;
use floorguard_types::motion::Waypoint;
use floorguard_types::number::{nearest_f32, saturating_usize};

use super::contract::Plan;
use super::gear_outlines::GearOutlines;
use crate::costmap::{CostmapView, footprint_cost};

/// What became of a plan on today's costmap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanState {
    /// The costs have not changed since.
    Current,
    /// They have, but the path is still free: a better one may exist.
    Outdated,
    /// The outline of the robot would touch something at this waypoint, so many metres along the path.
    Blocked {
        /// Index of the first such waypoint.
        waypoint: usize,
        /// Along the path from its first waypoint, metres.
        along_m: f32,
    },
}

/// Along a leg the outline is examined this often, metres.
const SAMPLE_EVERY_M: f32 = 0.1;
/// Looks at one leg at most.
const SAMPLES_MAX: usize = 1_000;

/// A pose on a leg, headed along it as at its beginning, and at its end as there.
fn between(from: &Waypoint, to: &Waypoint, share: f32) -> Pose2 {
    let (a, b) = (from.place_in_map(), to.place_in_map());
    let heading_rad = if share < 1.0 { from.pose_in_map.heading_rad } else { to.pose_in_map.heading_rad };
    Pose2::new(a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m), heading_rad)
}

/// Looks along the rest of a path with the outline that each gear needs. Cost: an outline every 0.1 m, if the costmap has changed.
#[must_use]
pub fn check_plan(
    costmap: CostmapView<'_>,
    outlines: &GearOutlines,
    (plan, rest): (&Plan, &[Waypoint]),
) -> PlanState {
    if costmap.revision() == plan.costmap_revision {
        return PlanState::Current;
    }
    let mut along_m = 0.0;
    let mut before = rest.first().copied();
    for (waypoint, at) in rest.iter().enumerate() {
        let from = before.replace(*at).unwrap_or(*at);
        let length_m = from.place_in_map().distance(at.place_in_map());
        let samples = saturating_usize(length_m / SAMPLE_EVERY_M).min(SAMPLES_MAX).saturating_add(1);
        for sample in 1..=samples {
            let share = nearest_f32(sample) / nearest_f32(samples);
            if footprint_cost(costmap, outlines.of(at.gear), between(&from, at, share)).is_err() {
                return PlanState::Blocked { waypoint, along_m: along_m + share * length_m };
            }
        }
        along_m += length_m;
    }
    PlanState::Outdated
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::costmap::Costs;
    use floorguard_mapping::GridGeometry;
    use floorguard_types::geometry::Point2;
    use floorguard_types::motion::{Footprint, Gear};
    use std::vec;

    #[test]
    fn new_obstacle_is_found_before_contact() {
        let geometry = GridGeometry::new(80, 40, 0.1, Point2::default()).unwrap();
        let mut costs = vec![0; 3_200];
        let corners = [(0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)];
        let outline = Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap();
        let outlines = GearOutlines::alike(outline);
        let path = [1.0, 2.0, 3.0, 4.0, 5.0]
            .map(|x_m| Waypoint { pose_in_map: Pose2::new(x_m, 2.0, 0.0), gear: Gear::Ahead });
        let plan = Plan { waypoints: 5, cost: 1.0, costmap_revision: 1 };
        let state = |costs: &[u8], revision| {
            check_plan(CostmapView::new(geometry, costs, revision).unwrap(), &outlines, (&plan, &path))
        };
        assert_eq!(state(&costs, 1), PlanState::Current);
        assert_eq!(state(&costs, 2), PlanState::Outdated);
        costs[geometry.cell_at(Point2::new(4.25, 2.35)).unwrap()] = Costs::LETHAL;
        let PlanState::Blocked { waypoint, along_m } = state(&costs, 3) else { panic!("it is not seen") };
        assert_eq!(waypoint, 3);
        assert!((along_m - 2.9).abs() < 0.15, "{along_m}");
    }
}
