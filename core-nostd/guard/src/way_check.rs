//! The body along the motion that is measured and that is wanted, against everything that was seen around it (FG-REQ-027,
//! FG-REQ-028).

use super::field_selection::STANDING_MPS;
use super::limiter::effective_speed_mps;
use super::supervisor::Supervisor;
use crate::protection::{Cause, CauseRecord, Cell, LocalMemory, REACTION_S, STANDOFF_M, Stopping, Sweep};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::sensing::{LidarPacket, Scan};
use floorguard_types::time::Stamp;

/// A way that allows less than this is closed, m/s.
const CREEP_MPS: f32 = 0.02;
/// Of the standoff, what a robot that already brakes may use up: it is held before the rest is gone.
const USED_SHARE: f32 = 0.5;

/// What the way of a motion allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// How far the fastest point of the body may go, metres; not beyond what the motion needs.
    pub free_m: f32,
    /// What it needs to stop, with the standoff, metres.
    pub needed_m: f32,
    /// Share of the motion's speed from which it stands in time.
    pub share: f32,
}

impl Way {
    const OPEN: Self = Self { free_m: f32::INFINITY, needed_m: 0.0, share: 1.0 };
}

impl Supervisor {
    /// What a lidar packet says of the surroundings. Call it with each packet after [`Self::on_lidar_packet`]: no stop waits
    /// for it. Nothing is decided; the next tick uses it.
    pub fn remember_packet(&mut self, packet: &LidarPacket) {
        self.memory.take_packet(packet, (&self.rays, &self.packet_table));
    }

    /// The same for a scan, after [`Self::on_scan`]. A scan of another geometry than the configured one says nothing.
    pub fn remember_scan(&mut self, scan: &Scan) {
        if self.scan_table.fits(scan) {
            self.memory.take_scan(scan, &self.scan_table);
        }
    }

    /// Looks along the wanted motion, and along what the robot does meanwhile.
    pub(super) fn judge_way(&mut self, now: Stamp) {
        let pose = self.memory.pose_at(now);
        self.memory.forget_inside(&self.config.footprint, (pose, self.body));
        let wanted = self.possible(self.state.wanted);
        let measured = self.state.motion.wheels;
        let moves = effective_speed_mps(measured, &self.config.drive) > STANDING_MPS;
        let ahead = self.way_of(wanted, pose, REACTION_S);
        let mut share = ahead.share;
        let mut nearest = ahead;
        if moves {
            // The steering goes from the one curve to the other.
            let between = Twist2 {
                linear_mps: 0.5 * (wanted.linear_mps + measured.linear_mps),
                angular_radps: 0.5 * (wanted.angular_radps + measured.angular_radps),
            };
            let path = self.way_of(between, pose, REACTION_S);
            share = share.min(path.share);
            nearest = if path.share < nearest.share { path } else { nearest };
        }
        let wanted_mps = effective_speed_mps(wanted, &self.config.drive);
        let allowed_mps = share * wanted_mps;
        self.judge_braking(measured, (pose, moves), now);
        if share < 1.0 && wanted_mps > 0.0 {
            let cause = if allowed_mps < CREEP_MPS { Cause::WayClosed } else { Cause::WayNarrow };
            let record = CauseRecord::new(cause, now).limited_to(allowed_mps);
            self.state.machine.raise(record.metres(nearest.free_m, nearest.needed_m));
        }
    }

    /// What the robot does already must end before the body touches anything: no reaction is waited for.
    fn judge_braking(&mut self, measured: Twist2, (pose, moves): (Pose2, bool), now: Stamp) {
        if !moves {
            return;
        }
        let path = self.way_of(measured, pose, 0.0);
        if path.free_m < path.needed_m - USED_SHARE * STANDOFF_M {
            let record = CauseRecord::new(Cause::WayClosed, now);
            self.state.machine.raise(record.metres(path.free_m, path.needed_m));
        }
    }

    /// How far a motion may go.
    fn way_of(&self, twist: Twist2, pose: Pose2, reaction_s: f32) -> Way {
        let outline = &self.config.footprint;
        let stopping = Stopping::from(outline, twist, (&self.config.drive, reaction_s));
        let needed_m = stopping.path_m() + STANDOFF_M;
        let Some(sweep) = Sweep::along(outline, twist, needed_m) else { return Way::OPEN };
        let free_m = free_in(&self.memory, pose, (&sweep, needed_m));
        Way { free_m, needed_m, share: stopping.share_within(free_m - STANDOFF_M) }
    }

    /// The motion as far as the drive can follow it.
    fn possible(&self, wanted: Twist2) -> Twist2 {
        let drive = &self.config.drive;
        let speed_share = drive.speed_mps / effective_speed_mps(wanted, drive).max(1.0e-6);
        let turn_share = drive.turn_radps / wanted.angular_radps.abs().max(1.0e-6);
        let share = speed_share.min(turn_share).min(1.0);
        Twist2 { linear_mps: wanted.linear_mps * share, angular_radps: wanted.angular_radps * share }
    }
}

/// How far a sweep is free of all that stands around, metres.
fn free_in(memory: &LocalMemory, pose: Pose2, (sweep, needed_m): (&Sweep<'_>, f32)) -> f32 {
    let (sin, cos) = libm::sincosf(pose.heading_rad);
    let mut free_m = needed_m;
    memory.for_each_obstacle(|cell: Cell| {
        let place = cell.middle();
        let (dx, dy) = (place.x_m - pose.x_m, place.y_m - pose.y_m);
        let in_robot = Point2::new(cos * dx + sin * dy, cos * dy - sin * dx);
        if sweep.is_near(in_robot) {
            free_m = sweep.free_m(in_robot, free_m);
        }
    });
    free_m
}
