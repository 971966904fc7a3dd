//! The requested velocity: ahead by a local planner, on the spot and backwards by the path follower.

use floorguard_navigation::costmap::{CostmapView, footprint_cost};
use floorguard_navigation::local::{
    Dwa, DwaScratch, LocalCommand, LocalPlanner, LocalSituation, LocalVerdict, Mppi, MppiSample, StepCell,
};
use floorguard_navigation::path::{FollowLimits, FollowState, PathFollower};
use floorguard_types::geometry::{Pose2, Twist2};
use floorguard_types::motion::{Footprint, Gear, MovingPerson, Waypoint};

use super::goals::WayLimits;
use super::guard_model::GuardModel;
use super::model::Model;
use super::plan::NavigationSettings;

/// Samples of ours.
pub(super) const SAMPLES: usize = 500;
/// A follower looks this far along its motion for obstacles, seconds.
const LOOK_S: [f32; 3] = [0.4, 0.8, 1.2];

/// Which planner drives ahead.
enum Local {
    Ours(Box<Mppi<Vec<MppiSample>>>),
    Dwa(Box<Dwa<'static>>),
}

/// What steering knows at a moment.
pub(super) struct SteeringMoment<'a> {
    pub(super) pose_in_map: Pose2,
    pub(super) twist: Twist2,
    pub(super) costmap: CostmapView<'a>,
    pub(super) people: &'a [MovingPerson],
    pub(super) guard: &'a GuardModel,
}

/// Local planner and follower.
pub(super) struct Steering {
    local: Local,
    follower: Option<PathFollower>,
    limits: FollowLimits,
    outline: Footprint,
    speed_mps: f32,
    /// What was asked for on this way.
    way: WayLimits,
}

impl Steering {
    pub(super) fn new(model: &Model, settings: &NavigationSettings, (cells, seed): (usize, u64)) -> Self {
        let local = if settings.uses_dwa {
            // Two fields for as long as the robot runs.
            let scratch = DwaScratch {
                path: vec![StepCell::default(); cells].leak(),
                goal: vec![StepCell::default(); cells].leak(),
            };
            Local::Dwa(Box::new(Dwa::new(model.dwa(), &model.outline, scratch)))
        } else {
            let samples = vec![MppiSample::default(); SAMPLES];
            Local::Ours(Box::new(Mppi::new(model.mppi(), model.outline.clone(), samples, seed)))
        };
        let limits = FollowLimits {
            speed_mps: model.drive.speed_max_mps,
            reverse_mps: model.drive.reverse_max_mps.max(0.05),
            turn_radps: model.arrival.turn_max_radps,
            ..FollowLimits::DEFAULT
        };
        let speed_mps = model.drive.speed_max_mps;
        Self {
            local,
            follower: None,
            limits,
            outline: model.outline.clone(),
            speed_mps,
            way: WayLimits::NONE,
        }
    }

    /// On the way from now on it plans no faster; what the model says stays the most.
    pub(super) const fn limit(&mut self, way: WayLimits) {
        self.way = way;
    }

    /// Another path is followed from now on.
    pub(super) fn restart(&mut self) {
        self.follower = None;
        if let Local::Ours(planner) = &mut self.local {
            planner.restart();
        }
    }

    /// Ours expects people by itself; the published planner knows them as hills of cost.
    pub(super) const fn needs_people_in_costmap(&self) -> bool {
        matches!(self.local, Local::Dwa(_))
    }

    /// Ahead along a piece of path.
    pub(super) fn ahead(&mut self, moment: &SteeringMoment<'_>, piece: &[Waypoint]) -> LocalCommand {
        self.follower = None;
        let situation = LocalSituation {
            pose_in_map: moment.pose_in_map,
            twist: moment.twist,
            costmap: moment.costmap,
            path: piece,
            people: moment.people,
            guard: moment.guard,
            speed_limit_mps: self.speed_mps.min(self.way.speed_mps),
        };
        match &mut self.local {
            Local::Ours(planner) => planner.command(&situation),
            Local::Dwa(planner) => planner.command(&situation),
        }
    }

    /// On the spot or backwards along a whole piece of path.
    pub(super) fn follow(&mut self, moment: &SteeringMoment<'_>, piece: &[Waypoint]) -> LocalCommand {
        let follower = self.follower.get_or_insert_with(|| PathFollower::new(piece));
        match follower.follow(piece, moment.pose_in_map, &self.limits) {
            FollowState::Drive(twist) if self.is_free(moment, twist) => {
                LocalCommand { twist, verdict: LocalVerdict::Driving }
            }
            FollowState::Drive(_) => LocalCommand::stand(LocalVerdict::Blocked),
            FollowState::Arrived => {
                self.follower = None;
                LocalCommand::stand(LocalVerdict::Arrived)
            }
            FollowState::Lost => {
                self.follower = None;
                LocalCommand::stand(LocalVerdict::NoPath)
            }
        }
    }

    /// The next second of a motion touches nothing, or less and less of what the robot touches already.
    fn is_free(&self, moment: &SteeringMoment<'_>, twist: Twist2) -> bool {
        let touches = |pose: Pose2| footprint_cost(moment.costmap, &self.outline, pose).is_err();
        if touches(moment.pose_in_map) {
            return true;
        }
        !LOOK_S.into_iter().any(|time_s| touches(moment.pose_in_map.after(twist, time_s)))
    }
}

/// A piece that the follower drives.
pub(super) const fn is_followed(gear: Gear) -> bool {
    matches!(gear, Gear::Spin | Gear::Back)
}
