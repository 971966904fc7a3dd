//! The controller: samples, weights, the command.

use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::motion::{Footprint, PermittedMotion};
use floorguard_types::number::{nearest_f32, saturating_usize};
use floorguard_types::random::Pcg32;

use super::config::{MPPI_STEPS, MppiConfig};
use super::forecast::Forecast;
use super::noise::deviations;
use super::path_left::PathLeft;
use super::rollout::{Outcome, Stage};
use crate::local::{LocalCommand, LocalPlanner, LocalSituation, LocalVerdict};

/// Samples that are no deviations: the plan as it is, braking, full speed, turns, backing out.
const FIXED_SAMPLES: usize = 6;

/// One sample: requested velocities, and what they cost.
#[derive(Clone, Copy, Debug)]
pub struct MppiSample {
    requests: [Twist2; MPPI_STEPS],
    cost_s: f32,
    is_free: bool,
}

impl Default for MppiSample {
    fn default() -> Self {
        Self { requests: [Twist2::ZERO; MPPI_STEPS], cost_s: f32::INFINITY, is_free: false }
    }
}

impl MppiSample {
    /// What it costs, seconds.
    #[must_use]
    pub const fn cost_s(&self) -> f32 {
        self.cost_s
    }

    /// The requested velocities, one a step.
    #[must_use]
    pub const fn requests(&self) -> &[Twist2; MPPI_STEPS] {
        &self.requests
    }
}

/// The controller; `S` stores the samples, as many as are to be tried. The same seed and situations give the same commands.
#[derive(Clone, Debug)]
pub struct Mppi<S> {
    config: MppiConfig,
    footprint: Footprint,
    samples: S,
    plan: [Twist2; MPPI_STEPS],
    random: Pcg32,
    /// How much of a step has passed since the plan was shifted, seconds.
    since_shift_s: f32,
}

impl<S: AsRef<[MppiSample]> + AsMut<[MppiSample]>> Mppi<S> {
    /// A controller that stands.
    #[must_use]
    pub const fn new(config: MppiConfig, footprint: Footprint, samples: S, seed: u64) -> Self {
        let plan = [Twist2::ZERO; MPPI_STEPS];
        Self { config, footprint, samples, plan, random: Pcg32::new(seed, 0x4d50), since_shift_s: 0.0 }
    }

    /// The samples of the last command, for a picture.
    #[must_use]
    pub fn samples(&self) -> &[MppiSample] {
        self.samples.as_ref()
    }

    /// The velocities that are planned.
    #[must_use]
    pub const fn plan(&self) -> &[Twist2; MPPI_STEPS] {
        &self.plan
    }

    /// Forgets the plan: after a new goal, or when others drove.
    pub const fn restart(&mut self) {
        self.plan = [Twist2::ZERO; MPPI_STEPS];
        self.since_shift_s = 0.0;
    }

    /// The plan moves on with time.
    fn shift(&mut self) {
        self.since_shift_s += self.config.period_s;
        let steps = saturating_usize(self.since_shift_s / self.config.step_s).min(MPPI_STEPS);
        self.since_shift_s -= nearest_f32(steps) * self.config.step_s;
        let last = self.plan.last().copied().unwrap_or(Twist2::ZERO);
        for to in 0..MPPI_STEPS {
            let value = self.plan.get(to.saturating_add(steps)).copied().unwrap_or(last);
            if let Some(place) = self.plan.get_mut(to) {
                *place = value;
            }
        }
    }

    /// Tries everything.
    fn try_samples<P: PermittedMotion>(&mut self, stage: &Stage<'_, P>) {
        let config = self.config;
        let drive = &config.drive;
        let hold = |linear_mps: f32, angular_radps: f32| [Twist2 { linear_mps, angular_radps }; MPPI_STEPS];
        let fixed: [_; FIXED_SAMPLES] = [
            self.plan,
            hold(0.0, 0.0),
            hold(drive.speed_max_mps, 0.0),
            hold(0.0, 0.6 * drive.turn_max_radps),
            hold(0.0, -0.6 * drive.turn_max_radps),
            hold(-drive.reverse_max_mps, 0.0),
        ];
        let (plan, random) = (&self.plan, &mut self.random);
        for (index, sample) in self.samples.as_mut().iter_mut().enumerate() {
            sample.requests = match fixed.get(index) {
                Some(requests) => *requests,
                None => deviate(plan, &config, random),
            };
            let Outcome { cost_s, is_free } = stage.play(&sample.requests);
            sample.cost_s = if cost_s.is_finite() { cost_s } else { f32::MAX };
            sample.is_free = is_free;
        }
    }

    /// The mean of all samples by weight, if it does better than the best one; else that.
    fn choose<P: PermittedMotion>(&self, stage: &Stage<'_, P>) -> Option<MppiSample> {
        let samples = self.samples.as_ref();
        let best = samples.iter().min_by(|a, b| a.cost_s.total_cmp(&b.cost_s))?;
        let mut mean = [Twist2::ZERO; MPPI_STEPS];
        let mut sum = 0.0_f32;
        for sample in samples {
            let worse = (sample.cost_s - best.cost_s) / self.config.temperature_s;
            if worse > 12.0 {
                continue;
            }
            let weight = libm::expf(-worse);
            sum += weight;
            for (mean, request) in mean.iter_mut().zip(&sample.requests) {
                mean.linear_mps += weight * request.linear_mps;
                mean.angular_radps += weight * request.angular_radps;
            }
        }
        for mean in &mut mean {
            // The best sample has weight 1.
            mean.linear_mps /= sum.max(1.0);
            mean.angular_radps /= sum.max(1.0);
        }
        let Outcome { cost_s, is_free } = stage.play(&mean);
        let is_better = is_free && cost_s <= best.cost_s;
        Some(if is_better { MppiSample { requests: mean, cost_s, is_free } } else { *best })
    }
}

/// The plan with smooth deviations, within what the drive can be asked for. Every fourth sample deviates from standing at half
/// speed instead of from the plan: it finds what the plan has no idea of.
fn deviate(plan: &[Twist2; MPPI_STEPS], config: &MppiConfig, random: &mut Pcg32) -> [Twist2; MPPI_STEPS] {
    let deviations = deviations(random);
    let drive = &config.drive;
    let is_afresh = random.below(4) == 0;
    let wide = if is_afresh { 1.5 } else { 1.0 };
    let middle = Twist2 { linear_mps: 0.5 * drive.speed_max_mps, angular_radps: 0.0 };
    let mut requests = *plan;
    for (request, by) in requests.iter_mut().zip(&deviations) {
        let from = if is_afresh { middle } else { *request };
        let linear_mps = from.linear_mps + wide * config.speed_noise_mps * by.linear_mps;
        let angular_radps = from.angular_radps + wide * config.turn_noise_radps * by.angular_radps;
        *request = Twist2 {
            linear_mps: linear_mps.clamp(-drive.reverse_max_mps, drive.speed_max_mps),
            angular_radps: angular_radps.clamp(-drive.turn_max_radps, drive.turn_max_radps),
        };
    }
    requests
}

impl<S: AsRef<[MppiSample]> + AsMut<[MppiSample]>, P: PermittedMotion> LocalPlanner<P> for Mppi<S> {
    fn command(&mut self, situation: &LocalSituation<'_, P>) -> LocalCommand {
        let Some(goal) = situation.path.last() else { return LocalCommand::stand(LocalVerdict::NoPath) };
        let pose = situation.pose_in_map;
        let here = Point2::new(pose.x_m, pose.y_m);
        if situation.costmap.geometry().cell_at(here).is_none() || !situation.twist.is_finite() {
            return LocalCommand::stand(LocalVerdict::NoPath);
        }
        if let Some(command) = self.config.arrival.command(pose, goal) {
            self.restart();
            return command;
        }
        let Some(path) = PathLeft::new(situation.path, here) else {
            return LocalCommand::stand(LocalVerdict::NoPath);
        };
        let config = self.config;
        let footprint = self.footprint.clone();
        let stage = Stage {
            config: &config,
            footprint: &footprint,
            costmap: situation.costmap,
            guard: situation.guard,
            path,
            people: Forecast::new(situation.people, here, (config.step_s, config.people_acceleration_mps2)),
            pose,
            twist: situation.twist,
            speed_limit_mps: situation.speed_limit_mps.max(0.0),
        };
        self.shift();
        self.try_samples(&stage);
        let Some(chosen) = self.choose(&stage).filter(|chosen| chosen.is_free) else {
            self.restart();
            return LocalCommand::stand(LocalVerdict::Blocked);
        };
        self.plan = chosen.requests;
        let request = chosen.requests.first().copied().unwrap_or(Twist2::ZERO);
        let limit_mps = stage.speed_limit_mps;
        let twist = Twist2 { linear_mps: request.linear_mps.clamp(-limit_mps, limit_mps), ..request };
        LocalCommand { twist, verdict: LocalVerdict::Driving }
    }
}

#[cfg(test)]
#[path = "planner_tests.rs"]
mod tests;
