//! Ours: the next view point is the first one of a short way through all of them, instead of the one that is best by itself. A
//! small frontier beside the way is looked at in passing, and not at the end from the other side of the building.

use floorguard_types::geometry::Point2;

use super::goal_watch::GoalWatch;
use super::view_points::{ViewPoint, ViewPoints};
use super::visit_order::{Ways, visit_order};

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TourExploreConfig {
    /// A view point is given up when the robot came no nearer to it for so long, seconds.
    pub progress_timeout_s: f32,
    /// A view point this near to one that was given up is given up too, metres.
    pub given_up_m: f32,
    /// A way that begins elsewhere must be shorter by this much, metres.
    pub hysteresis_m: f32,
    /// A view point this near to the present one is the same, metres.
    pub same_m: f32,
}

impl TourExploreConfig {
    /// For a robot of walking pace in a building.
    pub const DEFAULT: Self =
        Self { progress_timeout_s: 30.0, given_up_m: 0.5, hysteresis_m: 2.0, same_m: 1.0 };
}

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TourExploration {
    /// Drive there.
    Go(ViewPoint),
    /// Nothing that can be reached is unknown. A map that changes later may give frontiers again.
    Finished,
    /// What is left was given up, or no way leads there: so many frontiers.
    GivenUp(usize),
}

/// Chooses view points one after the other.
#[derive(Clone, Debug)]
pub struct TourExplorer {
    config: TourExploreConfig,
    watch: GoalWatch,
}

impl TourExplorer {
    /// At the beginning.
    #[must_use]
    pub const fn new(config: TourExploreConfig) -> Self {
        Self { config, watch: GoalWatch::new() }
    }

    /// The planner found no path to the present goal.
    pub fn goal_is_unreachable(&mut self) {
        self.watch.give_up();
    }

    /// Everything that was given up may be tried again.
    pub fn try_again(&mut self) {
        self.watch.try_again();
    }

    /// These are the view points now; `passed_s` since the last call. Those that were given up are taken out, and what is left is
    /// to be ordered by [`Self::choose`].
    pub fn leave_out_given_up(&mut self, found: &mut ViewPoints, passed_s: f32) {
        let Self { config, watch } = self;
        let present = found.points.iter().find(|point| watch.is_at(point.place_in_map, config.same_m));
        if let Some(left_m) = present.map(|point| point.way_m) {
            watch.progress(left_m, (passed_s, config.progress_timeout_s));
        }
        found.points.retain(|point| !watch.is_given_up(point.place_in_map, config.given_up_m));
    }

    /// What to do: `points` are all that is left, `ways` those between the robot and them, and `left_out` frontiers were given
    /// up or have no way.
    pub fn choose(&mut self, points: &[ViewPoint], ways: &Ways, left_out: usize) -> TourExploration {
        let best = visit_order(ways, None);
        let first = best.places.get(1).and_then(|place| points.get(place.wrapping_sub(1)));
        let Some(first) = first else {
            return if left_out > 0 { TourExploration::GivenUp(left_out) } else { TourExploration::Finished };
        };
        let config = self.config;
        let present = self.watch.goal_in_map().and_then(|goal| nearest(points, goal, config.same_m));
        let kept = present.and_then(|at| {
            let onward = visit_order(ways, Some(at.saturating_add(1)));
            let point = points.get(at)?;
            (onward.length_m <= best.length_m + config.hysteresis_m).then_some(point)
        });
        let point = kept.unwrap_or(first);
        self.watch.turn_to(point.place_in_map, (point.way_m, config.same_m));
        TourExploration::Go(*point)
    }
}

/// The view point that is nearest to a place, if it is near.
fn nearest(points: &[ViewPoint], place_in_map: Point2, within_m: f32) -> Option<usize> {
    let off_m = |point: &ViewPoint| point.place_in_map.distance(place_in_map);
    let near = points.iter().enumerate().filter(|(_, point)| off_m(point) <= within_m);
    near.min_by(|a, b| off_m(a.1).total_cmp(&off_m(b.1))).map(|(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::Frontier;
    use std::vec::Vec;

    /// Along a line, the robot at `x_m`.
    fn decide(explorer: &mut TourExplorer, x_m: f32, places: &[f32]) -> TourExploration {
        let point = |&at: &f32| ViewPoint {
            frontier: Frontier::default(),
            place_in_map: Point2::new(at, 0.0),
            way_m: (at - x_m).abs(),
        };
        let mut found = ViewPoints { points: places.iter().map(point).collect(), ..ViewPoints::default() };
        explorer.leave_out_given_up(&mut found, 1.0);
        let left_out = places.len() - found.points.len();
        let line: Vec<f32> =
            std::iter::once(x_m).chain(found.points.iter().map(|point| point.place_in_map.x_m)).collect();
        let mut ways = Ways::new(line.len());
        for (from, a) in line.iter().enumerate() {
            for (to, b) in line.iter().enumerate() {
                ways.set((from, to), (a - b).abs());
            }
        }
        explorer.choose(&found.points, &ways, left_out)
    }

    fn went_to(exploration: TourExploration) -> f32 {
        let TourExploration::Go(point) = exploration else { panic!("{exploration:?}") };
        point.place_in_map.x_m
    }

    /// The nearest is 2 m ahead, but the short end is better done first: 1.5 + 1.5 + 9 against 9 + 9 + 2.5 m.
    #[test]
    fn short_end_comes_first_and_is_kept() {
        let mut explorer = TourExplorer::new(TourExploreConfig::DEFAULT);
        assert_eq!(went_to(decide(&mut explorer, 0.0, &[2.0, 9.0, -2.5])), -2.5);
        // A new place makes the other end nearly as good: it goes on.
        assert_eq!(went_to(decide(&mut explorer, -0.5, &[3.0, -2.5])), -2.5);
        assert_eq!(went_to(decide(&mut explorer, -2.5, &[3.0])), 3.0);
        assert_eq!(decide(&mut explorer, 3.0, &[]), TourExploration::Finished);
    }

    #[test]
    fn places_without_progress_are_given_up() {
        let mut explorer = TourExplorer::new(TourExploreConfig::DEFAULT);
        for _ in 0..30 {
            assert_eq!(went_to(decide(&mut explorer, 0.0, &[4.0])), 4.0);
        }
        assert_eq!(decide(&mut explorer, 0.0, &[4.0]), TourExploration::GivenUp(1));
        explorer.try_again();
        assert_eq!(went_to(decide(&mut explorer, 0.0, &[4.0])), 4.0);
        explorer.goal_is_unreachable();
        assert_eq!(decide(&mut explorer, 0.0, &[4.0]), TourExploration::GivenUp(1));
    }
}
