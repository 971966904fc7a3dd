//! The dynamic window approach (Fox et al. 1997) as published in ROS `dwa_local_planner`.
//!
//! Constant velocities within the window are simulated, judged by critics, and the cheapest is taken. In addition to the
//! published planner a velocity must be admissible by Fox: the robot can stop before the end of its trajectory meets
//! something, which a horizon longer than the braking time makes true for every trajectory that is not discarded.

use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::motion::{Footprint, PermittedMotion};
use floorguard_types::number::{nearest_f32, saturating_u32, saturating_usize};

use super::arrive::Arrival;
use super::contract::{LocalCommand, LocalPlanner, LocalSituation, LocalVerdict};
use super::dwa_config::DwaConfig;
use super::dwa_critics::{DwaScore, Oscillation};
use super::dwa_window::{samples, window};
use super::step_field::{StepCell, StepField};
use crate::costmap::{Placement, outline_cost};

/// Poses of a trajectory at most.
const STEPS_MAX: u32 = 400;
/// Footprints of different sizes: from 1 to 1 + `scaling_max`.
const SCALES: usize = 5;

/// Storage of the two fields, one a cell of the costmap each.
pub struct DwaScratch<'a> {
    /// Steps to the path.
    pub path: &'a mut [StepCell],
    /// Steps to the local goal.
    pub goal: &'a mut [StepCell],
}

/// The planner.
pub struct Dwa<'a> {
    config: DwaConfig,
    footprints: [Footprint; SCALES],
    scratch: DwaScratch<'a>,
    oscillation: Oscillation,
}

/// The two fields of a situation.
struct Fields<'f> {
    path: StepField<'f>,
    goal: StepField<'f>,
    uses_nose: bool,
}

impl<'a> Dwa<'a> {
    /// A planner for an outline.
    #[must_use]
    pub fn new(config: DwaConfig, footprint: &Footprint, scratch: DwaScratch<'a>) -> Self {
        let footprints = core::array::from_fn(|scale| {
            let by = 1.0 + config.scaling_max * nearest_f32(scale) / nearest_f32(SCALES - 1);
            let corners = footprint.corners_in_base().iter();
            let grown: heapless::Vec<Point2, 16> =
                corners.map(|corner| Point2::new(by * corner.x_m, by * corner.y_m)).collect();
            Footprint::new(&grown).unwrap_or_else(|_| footprint.clone())
        });
        Self { config, footprints, scratch, oscillation: Oscillation::default() }
    }

    /// The outline at a speed: grown linearly above the scaling speed. Of five sizes the next larger one.
    fn footprint(footprints: &[Footprint; SCALES], config: &DwaConfig, speed_mps: f32) -> usize {
        let over = libm::fabsf(speed_mps) - config.scaling_speed_mps;
        let share = over / (config.speed_max_mps - config.scaling_speed_mps).max(1.0e-3);
        let last = footprints.len().saturating_sub(1);
        saturating_usize(libm::ceilf(share.clamp(0.0, 1.0) * nearest_f32(last))).min(last)
    }
}

/// Seeds both fields from the part of the path within the costmap; `None`: none of it is within.
fn fields<'f, P>(
    situation: &LocalSituation<'_, P>,
    config: &DwaConfig,
    scratch: &'f mut DwaScratch<'_>,
) -> Option<Fields<'f>> {
    let costmap = situation.costmap;
    let mut path = StepField::new(costmap, scratch.path)?;
    let mut goal = StepField::new(costmap, scratch.goal)?;
    let (mut last, mut last_place) = (None, None);
    let mut before: Option<Point2> = None;
    for at in situation.path {
        let place = at.place_in_map();
        // Published: the path is first filled up to one point a cell.
        let from = before.replace(place).unwrap_or(place);
        let gaps = saturating_usize(from.distance(place) * costmap.geometry().cells_per_metre()).min(1_000);
        for gap in 1..=gaps.max(1) {
            let t = nearest_f32(gap) / nearest_f32(gaps.max(1));
            let point =
                Point2::new(from.x_m + t * (place.x_m - from.x_m), from.y_m + t * (place.y_m - from.y_m));
            match costmap.geometry().cell_at(point) {
                Some(cell) => {
                    path.seed(cell);
                    (last, last_place) = (Some(cell), Some(point));
                }
                None if last.is_some() => break,
                None => {}
            }
        }
    }
    goal.seed(last?);
    path.spread(costmap);
    goal.spread(costmap);
    let here = Point2::new(situation.pose_in_map.x_m, situation.pose_in_map.y_m);
    let uses_nose =
        situation.path.last().is_some_and(|end| end.place_in_map().distance(here) > config.forward_point_m)
            && last_place.is_some();
    Some(Fields { path, goal, uses_nose })
}

/// Scores a velocity; `None`: discarded.
fn score<P>(
    situation: &LocalSituation<'_, P>,
    (config, footprint): (&DwaConfig, &Footprint),
    fields: &Fields<'_>,
    twist: Twist2,
) -> Option<DwaScore> {
    let costmap = situation.costmap;
    let (obstacle, last) = simulate(situation, (config, footprint), twist)?;
    let steps = |field: &StepField<'_>, point: Point2| {
        let cell = costmap.geometry().cell_at(point)?;
        field.steps(cell).map(f32::from)
    };
    let end = Point2::new(last.x_m, last.y_m);
    let nose = Point2::new(
        last.x_m + config.forward_point_m * last.cos,
        last.y_m + config.forward_point_m * last.sin,
    );
    let (alignment, goal_front) =
        if fields.uses_nose { (steps(&fields.path, nose)?, steps(&fields.goal, nose)?) } else { (0.0, 0.0) };
    Some(DwaScore {
        obstacle: f32::from(obstacle),
        path: steps(&fields.path, end)?,
        goal: steps(&fields.goal, end)?,
        alignment,
        goal_front,
        twirling: libm::fabsf(twist.angular_radps),
    })
}

/// The highest cost along a constant velocity and the last pose; `None`: it touches something. Euler steps with the heading
/// at the beginning of the step, as published.
fn simulate<P>(
    situation: &LocalSituation<'_, P>,
    (config, footprint): (&DwaConfig, &Footprint),
    twist: Twist2,
) -> Option<(u8, Placement)> {
    let path_m = libm::fabsf(twist.linear_mps) * config.horizon_s;
    let turn_rad = libm::fabsf(twist.angular_radps) * config.horizon_s;
    let steps = libm::ceilf((path_m / config.granularity_m).max(turn_rad / config.angular_granularity_rad));
    let steps = saturating_u32(steps).clamp(1, STEPS_MAX);
    let step_s = config.horizon_s / nearest_f32(steps);
    let start = situation.pose_in_map;
    let (sin, cos) = libm::sincosf(start.heading_rad);
    let (turn_sin, turn_cos) = libm::sincosf(twist.angular_radps * step_s);
    let step_m = twist.linear_mps * step_s;
    let mut at = Placement { x_m: start.x_m, y_m: start.y_m, sin, cos };
    let mut worst = 0_u8;
    for _ in 0..steps {
        worst = worst.max(outline_cost(situation.costmap, footprint, at).ok()?);
        at = Placement {
            x_m: at.x_m + step_m * at.cos,
            y_m: at.y_m + step_m * at.sin,
            sin: at.sin * turn_cos + at.cos * turn_sin,
            cos: at.cos * turn_cos - at.sin * turn_sin,
        };
    }
    // The centre must not be where no heading is free.
    let end = situation.costmap.cost_at(Point2::new(at.x_m, at.y_m));
    (end < crate::costmap::Costs::INSCRIBED).then_some((worst.max(end), at))
}

impl<P: PermittedMotion> LocalPlanner<P> for Dwa<'_> {
    fn command(&mut self, situation: &LocalSituation<'_, P>) -> LocalCommand {
        let config = self.config;
        let Some(goal) = situation.path.last() else { return LocalCommand::stand(LocalVerdict::NoPath) };
        let arrival = Arrival {
            within_m: config.goal_within_m,
            within_rad: config.goal_within_rad,
            turn_min_radps: config.turn_min_radps.min(0.2),
            turn_max_radps: config.turn_max_radps,
        };
        if let Some(command) = arrival.command(situation.pose_in_map, goal) {
            return command;
        }
        let here = Point2::new(situation.pose_in_map.x_m, situation.pose_in_map.y_m);
        // Slow down so that the robot can stop at the goal.
        let left_m = goal.place_in_map().distance(here);
        let end_mps = libm::sqrtf(2.0 * left_m * config.acceleration_mps2).max(config.translation_min_mps);
        let limit_mps = situation.speed_limit_mps.min(end_mps);
        let Some(fields) = fields(situation, &config, &mut self.scratch) else {
            return LocalCommand::stand(LocalVerdict::NoPath);
        };
        let twist = situation.twist;
        let [speeds, rates] = window(&config, twist.linear_mps, twist.angular_radps, limit_mps);
        let mut best: Option<(f32, Twist2)> = None;
        for linear_mps in samples(speeds) {
            let scale = Self::footprint(&self.footprints, &config, linear_mps);
            let Some(footprint) = self.footprints.get(scale) else { continue };
            for angular_radps in samples(rates) {
                let twist = Twist2 { linear_mps, angular_radps };
                let is_slow = libm::fabsf(linear_mps) < config.translation_min_mps
                    && libm::fabsf(angular_radps) < config.turn_min_radps;
                if is_slow || self.oscillation.forbids(twist) {
                    continue;
                }
                let Some(score) = score(situation, (&config, footprint), &fields, twist) else { continue };
                let total = score.total(&config, situation.costmap.geometry().resolution_m());
                if best.is_none_or(|(least, _)| total < least) {
                    best = Some((total, twist));
                }
            }
        }
        let Some((_, twist)) = best else { return LocalCommand::stand(LocalVerdict::Blocked) };
        self.oscillation.note(&config, twist, situation.pose_in_map);
        LocalCommand { twist, verdict: LocalVerdict::Driving }
    }
}

#[cfg(test)]
#[path = "dwa_tests.rs"]
mod tests;
