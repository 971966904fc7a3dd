//! Runs the belief beside the wheels: where the robot is now, and whether that can be trusted.

use floorguard_cleaning::{ActiveCell, Belief, BeliefConfig, CleanRule, Evidence, PoseDeviation};
use floorguard_localisation::OdometryStep;
use floorguard_mapping::{DirtCell, DirtMap};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

use super::floor::Floor;
use super::uncredited::UncreditedFloor;

/// Particles of the hosted profile.
pub const PARTICLES: usize = 500;
/// Cells that the particles can hold at once.
const ACTIVE_CELLS: usize = 256;
/// Distance and turn after which the belief is updated. 15° instead of the 10° of the published protocol: a mission
/// turns more than it drives, its errors and visits are the same, and a third fewer updates are made.
const UPDATE_M: f32 = 0.1;
const UPDATE_RAD: f32 = 0.262;
/// Below this share of explained beams something is wrong with the pose.
const SUSPECT_BELOW: f32 = 0.6;
/// From this share on, and with the particles together again, it is trusted again.
const TRUSTED_FROM: f32 = 0.75;
const TOGETHER_M: f32 = 0.1;
/// The mean of the particles differs by more than this from where the wheel odometry puts it, metres: a slip or a push.
const LEAP_M: f32 = 0.05;
/// From this share on a cell counts as visited (book, Cleaning: Re-planning).
const SWEPT_SHARE: f32 = 0.8;
/// A step shorter than this is none, metres and radians.
const STANDS: (f32, f32) = (0.01, 0.02);
/// Spread of the copies of a particle at a robot that stands, metres and radians.
const ROUGHENING: PoseDeviation = PoseDeviation { position_m: 0.04, heading_rad: 0.02 };
/// How well an operator shows on a map where the robot stands.
const POINTED_AT: PoseDeviation = PoseDeviation { position_m: 0.5, heading_rad: 0.35 };
/// Doubt of a belief that goes on from one that was trusted, and the least of one that was not.
const GO_ON: PoseDeviation = PoseDeviation { position_m: GO_ON_M, heading_rad: 0.052 };
const GO_ON_M: f32 = 0.05;
/// So far beside the brush of the mean pose the brush may be, metres: the recovery particles and their doubt.
const BRUSH_DOUBT_M: f32 = 0.3;
/// Doubt that is added when something is wrong.
const DOUBT: PoseDeviation = PoseDeviation { position_m: 0.12, heading_rad: 0.1 };

/// The belief of a mission.
pub struct Localiser {
    belief: Belief<Vec<ActiveCell<PARTICLES>>, PARTICLES>,
    uncredited: UncreditedFloor,
    /// The belief about dirt.
    pub map: DirtMap<Vec<DirtCell>>,
    odometry_at_update: Pose2,
    mean_at_update: Pose2,
    hits_since_update: u32,
    is_silent_since_update: bool,
    is_trusted: bool,
    /// The brush is down and turns; otherwise nothing counts as cleaned.
    pub brush_turns: bool,
    /// Updates so far.
    pub updates: u32,
    /// Times that the pose was found wrong.
    pub distrusts: u32,
    /// Times that the belief leapt.
    pub leaps: u32,
    /// Time spent in updates, s of the computer.
    pub busy_s: f64,
}

/// Cells that are to be cleaned, as believed at a moment.
pub struct DirtyCells<'a> {
    map: &'a DirtMap<Vec<DirtCell>>,
    rule: &'a CleanRule,
    grazed: Vec<usize>,
}

impl DirtyCells<'_> {
    /// The map calls the cell dirty, or the brush has only grazed it.
    #[must_use]
    pub fn contains(&self, cell: usize) -> bool {
        self.map.get(cell).is_some_and(|dirt| self.rule.needs_cleaning(dirt))
            || self.grazed.binary_search(&cell).is_ok()
    }
}

impl Localiser {
    /// A belief around the start of the floor (5 cm, 3°).
    pub fn new(floor: &Floor, config: BeliefConfig, map: DirtMap<Vec<DirtCell>>, random: Pcg32) -> Self {
        let mut belief = Belief::new(config, vec![ActiveCell::EMPTY; ACTIVE_CELLS], random);
        belief.place(floor.start, PoseDeviation { position_m: 0.05, heading_rad: 0.052 });
        Self {
            belief,
            uncredited: UncreditedFloor::new(map.values().len()),
            map,
            odometry_at_update: Pose2::default(),
            mean_at_update: floor.start,
            hits_since_update: 0,
            is_silent_since_update: false,
            is_trusted: true,
            brush_turns: true,
            updates: 0,
            distrusts: 0,
            leaps: 0,
            busy_s: 0.0,
        }
    }

    /// Where the robot is believed to be now.
    pub fn pose(&self, odometry: Pose2) -> Pose2 {
        self.mean_at_update.compose(self.odometry_at_update.inverse().compose(odometry))
    }

    /// Begins anew around a pose that somebody gave (5 cm, 3°).
    pub fn relocate(&mut self, pose_in_map: Pose2, odometry: Pose2) {
        self.belief.place(pose_in_map, PoseDeviation { position_m: 0.05, heading_rad: 0.052 });
        (self.mean_at_update, self.odometry_at_update) = (pose_in_map, odometry);
        self.hits_since_update = 0;
        self.is_silent_since_update = false;
    }

    /// Collects what a step brought.
    pub fn collect(&mut self, dirt_hits: u32, is_silent: bool) {
        self.hits_since_update = self.hits_since_update.saturating_add(dirt_hits);
        self.is_silent_since_update |= is_silent;
    }

    /// Enough happened since the last update.
    pub fn is_due(&self, odometry: Pose2) -> bool {
        let step = OdometryStep::between(self.odometry_at_update, odometry);
        let turned = (step.first_turn_rad + step.second_turn_rad).abs();
        step.forward_m.abs() >= UPDATE_M || turned >= UPDATE_RAD
    }

    /// Updates the belief. `scan` are the ends of the beams in the robot's frame; they and the dirt hits are left out
    /// while packets are lost.
    pub fn update(&mut self, floor: &Floor, odometry: Pose2, scan: &[Point2], uses_dirt_sensor: bool) {
        let step = OdometryStep::between(self.odometry_at_update, odometry);
        let is_heard = !self.is_silent_since_update;
        let predicted = self.pose(odometry);
        // While nothing is credited the particles remove nothing, and hits would only confuse them.
        let is_credited =
            self.is_trusted && !self.uncredited.is_around(self.map.geometry(), self.brush(predicted));
        let evidence = Evidence {
            hits_in_base: if is_heard { scan } else { &[] },
            dirt_hits: (uses_dirt_sensor && is_heard && is_credited).then_some(self.hits_since_update),
            brush_is_cleaning: self.is_trusted && self.brush_turns,
        };
        if !self.is_trusted && self.brush_turns {
            self.uncredited.add_around(self.map.geometry(), self.brush(predicted));
        }
        let begin = std::time::Instant::now();
        let report = self.belief.update(step, &evidence, (&floor.surfaces, &mut self.map));
        self.busy_s += begin.elapsed().as_secs_f64();
        self.updates += 1;
        self.odometry_at_update = odometry;
        self.hits_since_update = 0;
        self.is_silent_since_update = false;
        self.judge_health(report.explained_share, step);
        self.judge_leap(predicted);
        self.mean_at_update = self.belief.pose().mean_in_map;
    }

    /// Middle of the brush at a pose, and how far around it the brush may be, metres.
    fn brush(&self, pose_in_map: Pose2) -> (Point2, f32) {
        let brush = self.belief.config().brush;
        let middle = pose_in_map.transform(Point2::new(brush.offset_m, 0.0));
        (middle, 0.5 * brush.width_m + BRUSH_DOUBT_M)
    }

    /// Gives up what the present cells were credited with, and adds doubt of the pose.
    fn distrust(&mut self, doubt: PoseDeviation) {
        let uncredited = &mut self.uncredited;
        self.belief.visit_active(|cell, _, _| uncredited.add(cell));
        self.belief.distrust(&mut self.map, doubt);
    }

    /// A pose that does not explain the scan is not believed, and neither is what was cleaned from it.
    fn judge_health(&mut self, explained_share: Option<f32>, step: OdometryStep) {
        let Some(share) = explained_share else { return };
        // A robot that stands to find itself has its doubt already: as much again at every update would drive the
        // particles apart, and none would leave copies of a few.
        let turned_rad = (step.first_turn_rad + step.second_turn_rad).abs();
        let stands = step.forward_m.abs() < STANDS.0 && turned_rad < STANDS.1 && !self.is_trusted;
        if stands && share < TRUSTED_FROM {
            self.distrust(ROUGHENING);
        } else if share < SUSPECT_BELOW {
            self.distrusts += u32::from(self.is_trusted);
            self.is_trusted = false;
            self.distrust(DOUBT);
        } else if !self.is_trusted {
            self.is_trusted = share >= TRUSTED_FROM && self.belief.pose().position_deviation_m < TOGETHER_M;
        }
    }

    /// A belief that leaps was wrong for a while: what the brush was credited with in that while is given up. Cells that
    /// it left before keep their credit.
    fn judge_leap(&mut self, predicted: Pose2) {
        let mean = self.belief.pose().mean_in_map;
        if self.is_trusted && libm::hypotf(mean.x_m - predicted.x_m, mean.y_m - predicted.y_m) > LEAP_M {
            self.distrust(PoseDeviation::default());
            self.leaps += 1;
        }
    }

    /// What is believed of every cell that is not plainly clean, as the stored map would say it: cells under the brush
    /// are as they were before it came.
    pub fn remembered(&mut self) -> Vec<(u32, DirtCell)> {
        let mut under_brush = Vec::new();
        self.belief.visit_active(|cell, prior, _| under_brush.push((cell, *prior)));
        under_brush.sort_unstable_by_key(|&(cell, _)| cell);
        let stored = |(cell, dirt): (usize, &DirtCell)| {
            let before = under_brush.binary_search_by_key(&cell, |&(held, _)| held).ok();
            let dirt = before.and_then(|i| under_brush.get(i)).map_or(*dirt, |&(_, prior)| prior);
            (dirt != DirtCell::CLEAN).then_some((cell as u32, dirt))
        };
        self.map.values().iter().enumerate().filter_map(stored).collect()
    }

    /// Power came back: the stored cells and the stored pose are what is left.
    pub fn restore(&mut self, (cells, pose_in_map): (&[(u32, DirtCell)], Pose2), odometry: Pose2) {
        self.distrust(PoseDeviation::default());
        self.map.values_mut().fill(DirtCell::CLEAN);
        self.uncredited.clear();
        for &(cell, dirt) in cells {
            if let Some(place) = self.map.get_mut(cell as usize) {
                *place = dirt;
            }
        }
        self.mean_at_update = pose_in_map;
        self.restart(odometry);
    }

    /// Somebody says where the robot stands: to half a metre and twenty degrees it is believed, and the scans decide.
    pub fn place_at(&mut self, pose_in_map: Pose2, odometry: Pose2) {
        self.mean_at_update = pose_in_map;
        self.restart_within(odometry, POINTED_AT);
    }

    /// Goes on where another belief was, as far as that was trusted.
    pub fn go_on_at(&mut self, (pose_in_map, doubt_m): (Pose2, f32), odometry: Pose2, is_trusted: bool) {
        self.mean_at_update = pose_in_map;
        let doubt = PoseDeviation { position_m: doubt_m.max(GO_ON_M), heading_rad: DOUBT.heading_rad };
        self.restart_within(odometry, if is_trusted { GO_ON } else { doubt });
        self.is_trusted = is_trusted;
    }

    /// As after a power cut, with the map and the pose as they are: what the particles held is lost.
    pub fn restart(&mut self, odometry: Pose2) {
        self.restart_within(odometry, DOUBT);
    }

    /// The same, with another doubt: for a robot that was moving.
    pub fn restart_within(&mut self, odometry: Pose2, doubt: PoseDeviation) {
        self.distrust(PoseDeviation::default());
        self.belief.place(self.mean_at_update, doubt);
        self.odometry_at_update = odometry;
        self.hits_since_update = 0;
        self.is_silent_since_update = false;
        self.is_trusted = false;
    }

    /// The pose explains what the scanner sees; without that nothing counts as cleaned.
    pub const fn is_trusted(&self) -> bool {
        self.is_trusted
    }

    /// The most likely particle.
    pub fn best(&self) -> Pose2 {
        self.belief.pose().best_in_map
    }

    /// Deviation of the position, metres.
    pub fn doubt_m(&self) -> f32 {
        self.belief.pose().position_deviation_m
    }

    /// Cells that the particles hold.
    pub fn active_cells(&mut self) -> usize {
        self.belief.active_cells()
    }

    /// The cells that a rule does not call clean now.
    pub fn dirty<'a>(&'a mut self, rule: &'a CleanRule) -> DirtyCells<'a> {
        let grazed = self.grazed(rule);
        DirtyCells { map: &self.map, rule, grazed }
    }

    /// Cells under the brush that were dirty before and are not swept yet, sorted: grazed in passing, and still to be
    /// visited.
    fn grazed(&mut self, rule: &CleanRule) -> Vec<usize> {
        let mut cells = Vec::new();
        self.belief.visit_active(|cell, prior, swept| {
            if swept < SWEPT_SHARE && rule.needs_cleaning(prior) {
                cells.push(cell);
            }
        });
        cells.sort_unstable();
        cells
    }

    /// Lets all cells fall back into the map.
    pub fn settle(&mut self) {
        self.belief.settle(&mut self.map);
    }
}

#[cfg(test)]
#[path = "localiser_tests.rs"]
mod tests;
