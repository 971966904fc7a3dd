//! Backing out: along the way it came, or straight back where it came from nowhere or the guard lets it go no other way.

use floorguard_navigation::costmap::footprint_cost;
use floorguard_types::geometry::Pose2;
use floorguard_types::motion::{Gear, Waypoint};

use super::drive::Navigator;

/// The robot backs out so far, metres.
const BACK_M: f32 = 1.0;
/// From waypoint to waypoint straight back, metres.
const STEP_M: f32 = 0.1;
/// The way it came has this many waypoints at most.
const WAY_MAX: usize = 64;
/// Held for so long while it backs out along the way it came, the robot goes straight back, seconds. Before what stands in its field
/// the guard lets it do nothing else: no bend, and no turn to where the way begins.
const HELD_S: f32 = 2.0;

impl Navigator {
    /// The way to back out: the one that it came, otherwise straight back.
    pub(super) fn begin_backing(&mut self, pose: Pose2) {
        let mut way = vec![Waypoint::default(); WAY_MAX];
        let count = self.trail.way_back(pose, BACK_M, &mut way);
        way.truncate(count);
        self.back = if count > 1 { way } else { self.straight_back(pose) };
        self.steering.restart();
    }

    /// The guard refuses the way it came: straight back instead, where nothing stands.
    pub(super) fn straighten_backing(&mut self, pose: Pose2) {
        let is_straight = self.back.first().zip(self.back.last()).is_some_and(|(first, last)| {
            let aside_m = first.pose_in_map.inverse().compose(last.pose_in_map).y_m.abs();
            aside_m < 0.5 * STEP_M
        });
        if self.back.is_empty() || is_straight || self.held_s < HELD_S {
            return;
        }
        let straight = self.straight_back(pose);
        if !straight.is_empty() {
            self.back = straight;
            self.steering.restart();
        }
    }

    /// As far straight back as the body touches nothing; empty: not a step.
    fn straight_back(&self, pose: Pose2) -> Vec<Waypoint> {
        let Some(costmap) = self.maps.window() else { return Vec::new() };
        let at = |step: u8| pose.compose(Pose2::new(-STEP_M * f32::from(step), 0.0, 0.0));
        let is_free =
            |step: &u8| *step == 0 || footprint_cost(costmap, &self.model.outline, at(*step)).is_ok();
        let steps = 0..=(BACK_M / STEP_M) as u8;
        let way = steps.take_while(is_free).map(|step| Waypoint { pose_in_map: at(step), gear: Gear::Back });
        let way: Vec<Waypoint> = way.collect();
        if way.len() > 1 { way } else { Vec::new() }
    }
}
