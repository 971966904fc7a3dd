//! The decision itself: from the state, after each input, to what is permitted.

use super::field_selection::{Demand, STANDING_MPS};
use super::limiter::{body_ratio, effective_speed_mps, is_straight, lets_leave, limited};
use super::machine::Verdict;
use super::reset_answer::ResetProgress;
use super::supervisor::Supervisor;
use crate::protection::{Action, Cause, CauseRecord, Decision, FaultKind, Health, Source, Unit};
use floorguard_types::geometry::Twist2;
use floorguard_types::number::{nearest_f32, saturating_u64};
use floorguard_types::time::Stamp;

/// Acceleration counts over at most this long between two decisions, seconds: a late tick is no licence to jump.
const STEP_MAX_S: f32 = 0.1;

impl Supervisor {
    /// Health, start-up, motion, verdict, fields, command; then the state is copied.
    pub(super) fn decide(&mut self, now: Stamp) -> Decision {
        let all_healthy = self.judge_sources(now);
        self.judge_start(all_healthy, now);
        self.judge_motion(now);
        let standing = self.state.motion.wheels.linear_mps.abs() < STANDING_MPS;
        let reset = ResetProgress::of(&self.state.machine);
        let verdict = self.state.machine.settle(all_healthy && standing, now);
        self.note_reset(&reset, standing, now);
        let desired = self.desired(&verdict);
        let demand =
            Demand { wanted: desired, permitted: self.state.permitted, measured: self.state.motion.wheels };
        let activation_us = self.config.thresholds.field_activation_us;
        self.state.selection.update(&self.config.fields, &demand, (activation_us, now));
        let Permitted { twist: permitted, fastest_mps, limit_mps: speed_limit_mps, escaping } =
            self.permit(&verdict, now);
        self.state.permitted = permitted;
        let response_us = saturating_u64(self.config.drive.response_s * 1.0e6);
        let braking = (self.config.drive.braking_mps2, response_us);
        self.state.checks.follow(fastest_mps, braking, now);
        self.state.checks.is_held = verdict.action == Action::Category2 && permitted == Twist2::ZERO;
        self.state.decided_at = self.state.decided_at.max(now);
        self.copy.follow(&self.state);
        Decision {
            stamp: now,
            permitted,
            action: verdict.action,
            speed_limit_mps,
            state: verdict.state,
            primary_cause: verdict.primary,
            holding_cause: verdict.holding,
            torque_off: verdict.action == Action::Category0
                || (verdict.action == Action::Category1 && standing),
            escaping,
            field_set: self.state.selection.active,
        }
    }

    /// Every failing source raises its own cause (FG-REQ-013); `true` when all that are required are healthy.
    fn judge_sources(&mut self, now: Stamp) -> bool {
        let mut all_healthy = true;
        let watched = self.config.sources.iter().zip(&self.state.monitors);
        for (source, (rules, monitor)) in Source::ALL.into_iter().zip(watched) {
            let health = monitor.health(rules, now);
            all_healthy &= health == Health::Healthy || !rules.fitted || !rules.required_at_start;
            // Before the start the start-up check holds the robot, and power that comes up is no loss.
            if health == Health::Healthy || !self.state.started {
                continue;
            }
            let (cause, limit_us) = match monitor.demand(rules, now) {
                Action::None => continue,
                Action::Limit => (Cause::SourceLate(source), rules.limit_after_us),
                _ => (Cause::SourceLost(source), rules.stop_after_us.unwrap_or(u64::MAX)),
            };
            let age_us = monitor.age_us(now);
            let mut record = CauseRecord::new(cause, now).aged(age_us).limited_to(rules.limit_mps);
            if health == Health::Stale {
                record = record.measured(
                    nearest_f32(age_us) * 1.0e-6,
                    nearest_f32(limit_us) * 1.0e-6,
                    Unit::Seconds,
                );
            }
            if let Some(FaultKind::Device(code)) = monitor.fault {
                record = record.measured(f32::from(code), 0.0, Unit::Code);
            }
            record.health = health;
            record.ahead_us = u64::from(monitor.ahead_us);
            self.state.machine.raise(record);
        }
        all_healthy
    }

    /// Nothing moves before every required source was healthy at the same time (FG-REQ-012).
    fn judge_start(&mut self, all_healthy: bool, now: Stamp) {
        if self.state.started {
            return;
        }
        if !all_healthy {
            self.state.machine.raise(CauseRecord::new(Cause::StartUp, now));
        }
        self.state.started = !self.state.machine.holds(Cause::StartUp);
    }

    fn judge_motion(&mut self, now: Stamp) {
        if !self.state.started {
            return;
        }
        let motion = self.state.motion;
        for record in self.state.checks.check(&motion, &self.config, now).into_iter().flatten() {
            self.state.machine.raise(record);
        }
    }

    /// The wanted command as far as the causes allow its speed: nothing larger needs a larger field.
    pub(super) fn desired(&self, verdict: &Verdict) -> Twist2 {
        let limit_mps = verdict.limit_mps.min(self.config.drive.speed_mps);
        // While stopped, the direction still tells which field the robot would need: a crawl in that direction.
        let limit_mps = limit_mps.max(self.config.thresholds.escape_speed_mps);
        let wanted = self.state.wanted;
        let share = (limit_mps / wanted.linear_mps.abs().max(1.0e-3)).min(1.0);
        Twist2 { linear_mps: wanted.linear_mps * share, angular_radps: wanted.angular_radps * share }
    }

    /// The permitted command, and what stands behind it. The causes limit the fastest point of the body (FG-REQ-056),
    /// field and drive the speed that is commanded.
    fn permit(&self, verdict: &Verdict, now: Stamp) -> Permitted {
        let wanted = self.state.wanted;
        let backward = wanted.linear_mps < 0.0;
        let clear_ahead = self.state.is_clear(backward, now);
        let stops = verdict.action.stops();
        let may_leave = || {
            self.state.machine.held().all(|held| lets_leave(held.cause, held.action, backward, clear_ahead))
        };
        let escaping = stops && is_straight(wanted) && may_leave();
        let demanded_mps = match (stops, escaping) {
            (false, _) => verdict.limit_mps,
            (true, true) => self.config.thresholds.escape_speed_mps,
            (true, false) => 0.0,
        };
        let cap_mps = self.state.selection.cap_mps(&self.config.fields, wanted, now);
        let limit_mps = demanded_mps.min(cap_mps).min(self.config.drive.speed_mps);
        let step_s = now.seconds_since(self.state.decided_at).clamp(0.0, STEP_MAX_S);
        let drive = &self.config.drive;
        let ratio = body_ratio(wanted, (self.state.wanted_fastest_mps, drive));
        let commanded_mps = (demanded_mps / ratio).min(cap_mps).min(drive.speed_mps);
        let twist = limited(wanted, commanded_mps, drive, (self.state.permitted, step_s));
        Permitted { twist, fastest_mps: effective_speed_mps(twist, drive) * ratio, limit_mps, escaping }
    }
}

/// What the robot may do.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Permitted {
    twist: Twist2,
    /// Of the fastest point of the body, m/s.
    fastest_mps: f32,
    /// The limit behind it, m/s.
    limit_mps: f32,
    /// It leaves an obstacle although a stop is in force.
    escaping: bool,
}
