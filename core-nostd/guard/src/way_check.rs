//! The body along the motion that is measured and that is wanted, against everything that was seen around it (FG-REQ-027,
//! FG-REQ-028).

use super::field_selection::STANDING_MPS;
use super::limiter::effective_speed_mps;
use super::supervisor::Supervisor;
use crate::protection::{
    Blind, Cause, CauseRecord, Cell, GuardConfig, REACTION_S, STANDOFF_M, Sight, Stopping, Sweep, fastest_mps,
};
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::sensing::{LidarPacket, Scan};
use floorguard_types::time::Stamp;

/// A way that allows less than this is closed, m/s.
const CREEP_MPS: f32 = 0.02;
/// Of the standoff, what a robot that already brakes may use up: it is held before the rest is gone.
const USED_SHARE: f32 = 0.5;

/// The way of a motion, and how much of it is free.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way<'a> {
    sweep: Sweep<'a>,
    stopping: Stopping,
    /// What the motion needs to stop, with the standoff, metres.
    needed_m: f32,
    /// How far the fastest point of the body may go, metres; not beyond what the motion needs.
    free_m: f32,
}

impl<'a> Way<'a> {
    /// Of a motion, before anything stands in it; `None`: nothing moves. `reaction_s`: from the event to the order.
    fn of(config: &'a GuardConfig, twist: Twist2, reaction_s: f32) -> Option<Self> {
        let stopping = Stopping::from(&config.footprint, twist, (&config.drive, reaction_s));
        let needed_m = stopping.path_m() + STANDOFF_M;
        let sweep = Sweep::along(&config.footprint, twist, needed_m)?;
        Some(Self { sweep, stopping, needed_m, free_m: needed_m })
    }

    /// Something stands at a place of the robot frame.
    fn meet(&mut self, place: Point2) {
        if self.free_m > 0.0 && self.sweep.is_near(place) {
            self.free_m = self.sweep.free_m(place, self.free_m);
        }
    }

    /// Share of the motion's speed from which the robot stands in time.
    fn share(&self) -> f32 {
        self.stopping.share_within(self.free_m - STANDOFF_M)
    }
}

impl Supervisor {
    /// What a lidar packet says of the surroundings. Call it with each packet after [`Self::on_lidar_packet`]: no stop waits
    /// for it. Nothing is decided; the next tick uses it.
    pub fn remember_packet(&mut self, packet: &LidarPacket) {
        let reach_m = self.config.thresholds.memory_reach_m;
        self.memory.take_packet(packet, (&self.rays, &self.packet_table), reach_m);
        self.contents.see_packet(packet, (&self.rays, &self.packet_table), self.memory.pose());
    }

    /// More firings of the same packet, as many as [`Thresholds::memory_firings`](crate::Thresholds::memory_firings) says: for a
    /// computer that has the time. Call it after [`Self::remember_packet`] (FG-REQ-066).
    pub fn remember_more(&mut self, packet: &LidarPacket) {
        self.memory.take_more(packet, (&self.rays, &self.packet_table), &self.config.thresholds);
    }

    /// The same for a scan, after [`Self::on_scan`]. A scan of another geometry than the configured one says nothing.
    pub fn remember_scan(&mut self, scan: &Scan) {
        if self.scan_table.fits(scan) {
            self.memory.take_scan(scan, &self.scan_table, self.config.thresholds.memory_reach_m);
            self.contents.see_scan(scan, self.memory.pose());
        }
    }

    /// The same for a scan of the second safety scanner, after [`Self::on_rear_scan`].
    pub fn remember_rear_scan(&mut self, scan: &Scan) {
        let reach_m = self.config.thresholds.memory_reach_m;
        for rear in self.rear.iter_mut().filter(|rear| rear.table.fits(scan)) {
            rear.remember(scan, (&mut self.memory, reach_m));
        }
    }

    /// Looks along the wanted motion, and along what the robot does meanwhile.
    pub(super) fn judge_way(&mut self, now: Stamp) {
        let pose = self.memory.pose_at(now);
        self.memory.mark_ends();
        self.memory.forget_inside(&self.config.footprint, (pose, self.body));
        let wanted = self.possible(self.state.wanted);
        let measured = self.state.motion.wheels_until_standstill(&self.config);
        let moves = effective_speed_mps(measured, &self.config.drive) > STANDING_MPS;
        // The steering goes from the one curve to the other.
        let between = Twist2 {
            linear_mps: 0.5 * (wanted.linear_mps + measured.linear_mps),
            angular_radps: 0.5 * (wanted.angular_radps + measured.angular_radps),
        };
        let while_moving = |twist: Twist2, reaction_s: f32| {
            if moves { Way::of(&self.config, twist, reaction_s) } else { None }
        };
        let mut ways = [
            Way::of(&self.config, wanted, REACTION_S),
            while_moving(between, REACTION_S),
            // What it does already must end before the body touches anything: no reaction is waited for.
            while_moving(measured, 0.0),
        ];
        if ways.iter().any(Option::is_some) {
            self.meet_all(pose, &mut ways);
        }
        if self.memory.is_incomplete(now) {
            self.state.machine.raise(CauseRecord::new(Cause::WayClosed, now));
        }
        let [ahead, path, braking] = ways;
        if let Some(way) = braking.filter(|way| way.free_m < way.needed_m - USED_SHARE * STANDOFF_M) {
            let record = CauseRecord::new(Cause::WayClosed, now);
            self.state.machine.raise(record.metres(way.free_m, way.needed_m));
        }
        let shares = [ahead, path].into_iter().flatten().map(|way| (way.share(), way));
        let nearest = shares.reduce(|a, b| if b.0 < a.0 { b } else { a });
        let wanted_mps = effective_speed_mps(wanted, &self.config.drive);
        if let Some((share, way)) = nearest.filter(|(share, _)| *share < 1.0 && wanted_mps > 0.0) {
            let allowed_mps = share * wanted_mps;
            let cause = if allowed_mps < CREEP_MPS { Cause::WayClosed } else { Cause::WayNarrow };
            // Limits hold for the fastest point of the body.
            let fastest_mps = fastest_mps(&self.config.footprint, wanted);
            let record = CauseRecord::new(cause, now).limited_to(share * fastest_mps.max(wanted_mps));
            self.state.machine.raise(record.metres(way.free_m, way.needed_m));
        }
    }

    /// Everything that stands around, against all ways at once. Where the body stands nothing is hidden. A second scanner looks where the
    /// first one does not.
    fn meet_all(&self, pose: Pose2, ways: &mut [Option<Way<'_>>; 3]) {
        let (sin, cos) = libm::sincosf(pose.heading_rad);
        let rays = (&self.rays, self.config.thresholds.memory_firings > 1);
        self.memory.for_each_obstacle(rays, |cell: Cell, sight: Sight| {
            let place = cell.middle();
            let (dx, dy) = (place.x_m - pose.x_m, place.y_m - pose.y_m);
            let in_robot = Point2::new(cos * dx + sin * dy, cos * dy - sin * dx);
            if sight == Sight::Met || self.body.distance_m(in_robot) > 0.0 {
                ways.iter_mut().flatten().for_each(|way| way.meet(in_robot));
            }
        });
        let scanner = Blind::of(&self.scan_table).filter(|_| self.config.rear_scanner.is_none());
        let Some(blind) = scanner else { return };
        self.memory.for_each_never_seen(&blind, (pose, &self.body), |place| {
            ways.iter_mut().flatten().for_each(|way| way.meet(place));
        });
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
