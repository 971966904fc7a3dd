//! Which frontier to drive to, when to give one up, and when nothing is left.

use floorguard_types::geometry::Point2;
use floorguard_types::number::nearest_f32;

use super::frontier::{Frontier, FrontierSearch};
use super::goal_watch::GoalWatch;

/// How frontiers are compared: `potential_scale · distance − gain_scale · size`, both in metres; smaller is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrontierCost {
    /// Weight of the distance.
    pub potential_scale: f32,
    /// Weight of the size.
    pub gain_scale: f32,
}

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExploreConfig {
    /// How frontiers are compared.
    pub cost: FrontierCost,
    /// Smaller ones are left, metres.
    pub size_min_m: f32,
    /// A frontier is given up when the robot came no nearer to it for so long, seconds.
    pub progress_timeout_s: f32,
    /// A goal within this distance of one that was given up is given up too, metres.
    pub given_up_m: f32,
    /// Another frontier must be better than the present one by this much, metres of distance.
    pub hysteresis_m: f32,
}

impl ExploreConfig {
    /// As the launch file of `explore_lite` ships: 3.0 and 1.0, 0.75 m, 30 s; our own hysteresis against turning to and fro.
    pub const PUBLISHED: Self = Self {
        cost: FrontierCost { potential_scale: 3.0, gain_scale: 1.0 },
        size_min_m: 0.75,
        progress_timeout_s: 30.0,
        given_up_m: 0.25,
        hysteresis_m: 1.0,
    };
}

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exploration {
    /// Drive there.
    Go(Frontier),
    /// Nothing that can be reached is unknown. A map that changes later may give frontiers again.
    Finished,
    /// What is left was given up: this many frontiers.
    GivenUp(usize),
    /// The robot does not know where it stands.
    Lost,
}

/// Chooses frontiers one after the other.
#[derive(Clone, Debug)]
pub struct Explorer {
    config: ExploreConfig,
    watch: GoalWatch,
}

impl Explorer {
    /// At the beginning.
    #[must_use]
    pub const fn new(config: ExploreConfig) -> Self {
        Self { config, watch: GoalWatch::new() }
    }

    /// The planner found no path to the present goal.
    pub fn goal_is_unreachable(&mut self) {
        self.watch.give_up();
    }

    /// Everything that was given up may be tried again: the map has changed much.
    pub fn try_again(&mut self) {
        self.watch.try_again();
    }

    /// What to do with today's frontiers; `distance_m(frontier)` is the way to one, `None`: it cannot be reached.
    /// `passed_s` since the last call.
    pub fn decide(
        &mut self,
        robot_in_map: Point2,
        found: &FrontierSearch,
        distance_m: impl Fn(&Frontier) -> Option<f32>,
        passed_s: f32,
    ) -> Exploration {
        if found.is_lost || found.is_out_of_room {
            return Exploration::Lost;
        }
        if let Some(goal) = self.watch.goal_in_map() {
            self.watch.progress(robot_in_map.distance(goal), (passed_s, self.config.progress_timeout_s));
        }
        let mut left_out = 0_usize;
        let mut best: Option<(f32, Frontier)> = None;
        for frontier in &found.frontiers {
            let is_given_up = self.watch.is_given_up(frontier.goal_in_map, self.config.given_up_m);
            let path_m = distance_m(frontier).filter(|_| !is_given_up);
            let Some(path_m) = path_m else {
                left_out = left_out.saturating_add(1);
                continue;
            };
            let cost = self.cost(frontier, path_m);
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, *frontier));
            }
        }
        match best {
            Some((_, frontier)) => {
                let left_m = robot_in_map.distance(frontier.goal_in_map);
                self.watch.turn_to(frontier.goal_in_map, (left_m, self.config.given_up_m));
                Exploration::Go(frontier)
            }
            None if left_out > 0 => Exploration::GivenUp(left_out),
            None => Exploration::Finished,
        }
    }

    /// The present goal is favoured by the hysteresis.
    fn cost(&self, frontier: &Frontier, path_m: f32) -> f32 {
        let config = &self.config;
        let is_present = self.watch.is_at(frontier.goal_in_map, config.hysteresis_m);
        let bonus_m = if is_present { config.hysteresis_m } else { 0.0 };
        config.cost.potential_scale * (path_m - bonus_m)
            - config.cost.gain_scale * nearest_f32(frontier.cells) * 0.05
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frontier(x_m: f32, cells: u32) -> Frontier {
        let place = Point2::new(x_m, 0.0);
        Frontier { cells, centroid_in_map: place, goal_in_map: place, nearest_m: x_m.abs() }
    }

    fn found(frontiers: &[Frontier]) -> FrontierSearch {
        FrontierSearch { frontiers: frontiers.iter().copied().collect(), ..FrontierSearch::default() }
    }

    fn went_to(exploration: Exploration) -> f32 {
        let Exploration::Go(frontier) = exploration else { panic!("{exploration:?}") };
        frontier.goal_in_map.x_m
    }

    #[test]
    fn goes_to_near_frontier_without_oscillation() {
        let mut explorer = Explorer::new(ExploreConfig::PUBLISHED);
        let both = found(&[frontier(4.0, 20), frontier(-4.5, 20)]);
        let path = |x_m: f32| move |frontier: &Frontier| Some((frontier.goal_in_map.x_m - x_m).abs());
        assert_eq!(went_to(explorer.decide(Point2::new(0.0, 0.0), &both, path(0.0), 1.0)), 4.0);
        // The other one is nearer by less than the hysteresis now.
        assert_eq!(went_to(explorer.decide(Point2::new(-0.5, 0.0), &both, path(-0.5), 1.0)), 4.0);
        assert_eq!(went_to(explorer.decide(Point2::new(-2.0, 0.0), &both, path(-2.0), 1.0)), -4.5);
    }

    #[test]
    fn gives_up_without_progress_and_says_so() {
        let mut explorer = Explorer::new(ExploreConfig::PUBLISHED);
        let only = found(&[frontier(4.0, 20)]);
        let path = |frontier: &Frontier| Some(frontier.goal_in_map.x_m);
        let here = Point2::new(0.0, 0.0);
        for _ in 0..30 {
            assert_eq!(went_to(explorer.decide(here, &only, path, 1.0)), 4.0);
        }
        assert_eq!(explorer.decide(here, &only, path, 1.0), Exploration::GivenUp(1));
        assert_eq!(explorer.decide(here, &found(&[]), path, 1.0), Exploration::Finished);
        explorer.try_again();
        assert_eq!(went_to(explorer.decide(here, &only, path, 1.0)), 4.0);
        explorer.goal_is_unreachable();
        assert_eq!(explorer.decide(here, &only, path, 1.0), Exploration::GivenUp(1));
        let lost = FrontierSearch { is_lost: true, ..FrontierSearch::default() };
        assert_eq!(explorer.decide(here, &lost, path, 1.0), Exploration::Lost);
    }
}
