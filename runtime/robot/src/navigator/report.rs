//! What a drive tells of itself, about five times a second and whenever something changes.

use std::sync::Arc;

use floorguard_navigation::costmap::{CostmapView, Costs};
use floorguard_runtime::tasks::MissionMoment;
use floorguard_types::motion::Waypoint;

use super::drive::Navigator;
use super::exploring::Exploring;
use super::progress::{CostmapImage, NavigationPhase, NavigationProgress};
use super::touring::Tour;

/// Progress is made known this often, seconds.
const PROGRESS_S: f32 = 0.2;
/// The costmap around the robot is drawn this often, seconds.
const COSTMAP_S: f32 = 1.0;

impl Navigator {
    /// Makes the progress known, if it is time or something changed.
    pub(super) fn report(&mut self, moment: &MissionMoment<'_>, now_s: f32) {
        if now_s >= self.next_costmap_s {
            self.next_costmap_s = now_s + COSTMAP_S;
            self.costmap = self.maps.window().map(|costmap| Arc::new(picture(costmap)));
        }
        let state = Some((self.phase, self.standing.is_some() || moment.is_paused));
        if now_s >= self.next_report_s || self.reported != state {
            self.next_report_s = now_s + PROGRESS_S;
            self.reported = state;
            self.watch.publish(Arc::new(self.progress(moment)));
        }
    }

    fn progress(&self, moment: &MissionMoment<'_>) -> NavigationProgress {
        let has_path = self.course.gear().is_some();
        let left_m = has_path.then(|| self.course.left_m());
        NavigationProgress {
            stamp: moment.now,
            phase: self.phase,
            words: self.words(left_m),
            is_paused: moment.is_paused,
            standing: self.standing,
            odometry_in_map: self.senses.odometry_in_map(),
            pose_in_map: self.senses.pose(),
            is_trusted: self.senses.is_trusted(),
            goal_number: self.goal_number,
            goal_in_map: self.plan.goal_pose(),
            path: self.course.rest().iter().map(Waypoint::place_in_map).collect(),
            left_m,
            distance_m: self.senses.distance_m,
            plans: self.plans,
            measures: self.measures.clone(),
            exploration: self.exploring.as_ref().map(|exploring| exploring.progress),
            tour: self.tour.as_ref().map(|tour| tour.progress),
            costmap: self.costmap.clone(),
        }
    }

    fn words(&self, left_m: Option<f32>) -> String {
        let odometry = self.senses.motion().pose_in_odometry;
        let docks = self.docking.as_ref().and_then(|docking| docking.words(odometry));
        if let Some(words) = docks.filter(|_| self.standing.is_none() || self.phase.is_over()) {
            return words;
        }
        match (self.phase, self.failure, &self.standing) {
            (NavigationPhase::Explored, ..) => {
                self.exploring.as_ref().map(Exploring::words).unwrap_or_default()
            }
            (NavigationPhase::Waiting, ..) => "waits for an order".to_owned(),
            (NavigationPhase::Reached, ..) => {
                self.tour.as_ref().map_or_else(|| "the goal is reached".to_owned(), Tour::words)
            }
            (NavigationPhase::Unreachable, Some(failure), _) => format!("{failure}, by the map alone"),
            (_, _, Some(standing)) => standing.to_string(),
            _ if self.exploring.is_some() => {
                format!("drives to where it sees more, {:.1} m left", left_m.unwrap_or(0.0))
            }
            _ => format!("drives to the goal, {:.1} m left", left_m.unwrap_or(0.0)),
        }
    }
}

fn picture(costmap: CostmapView<'_>) -> CostmapImage {
    let percent = |cost: &u8| match *cost {
        Costs::UNKNOWN => -1,
        Costs::LETHAL => 100,
        Costs::INSCRIBED => 99,
        // As ROS draws a costmap: 1 to 98 between.
        other => (u16::from(other) * 98 / 252) as i8,
    };
    CostmapImage { geometry: *costmap.geometry(), cells: costmap.costs().iter().map(percent).collect() }
}
